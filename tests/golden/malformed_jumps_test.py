"""Malformed [[jumps]] and comparisons of discrete states: refused with exit code 2, their line and a message that helps."""

import tool

GOOD = """[model]
name = "counter"
[parameters]
e = 0.5
[states]
y = 1
v = 0
n = 0
[dynamics]
y = "v"
v = "-9.81 + if(n == 2, 1, 0)"
n = 0
[simulate]
until = 1
"""


def jump(*lines):
    """GOOD with one jump: its table begins at line 15, its first key is in line 16."""
    return GOOD + "[[jumps]]\n" + "".join(line + "\n" for line in lines)


def rate(text):
    """GOOD with another right-hand side of v, in line 11."""
    lines = GOOD.splitlines()
    lines[10] = f"v = {text!r}"
    return "\n".join(lines) + "\n"


SET = "set = { v = '-e*v' }"

# name: (content, line, expected parts of the message…)
FILES = {
    # what triggers
    "no trigger": (jump(SET), 15, "no `when`", "every = 0.5", "at = [1, 2.5]"),
    "bare guard": (jump("when = 'y'", SET), 16, "expected a condition, found the expression 'y'", 'direction = "down"'),
    "direction of a condition": (jump("when = 'y < 0'", "direction = 'down'", SET), 16, "`direction` with the condition",
                                 "remove `direction`"),
    "direction of a named condition": (jump("when = 'low'", "direction = 'down'", SET) + "[definitions]\nlow = 'y < 0'\n",
                                       16, "`direction` with the condition 'low'"),
    "direction misspelt": (jump("when = 'y'", "direction = 'dwn'", SET), 17, '"dwn"', "'down'"),
    "direction a number": (jump("when = 'y'", "direction = -1", SET), 17, '"down"', "the number -1"),
    "two triggers": (jump("when = 'y < 0'", "at = [1]", SET), 15, "`when` and `at`", "a jump for each"),
    "condition of an unknown name": (jump("when = 'z < 0'", SET), 16, "unknown name 'z'"),
    "condition unfinished": (jump("when = 'y < '", SET), 16, "found the end of the expression"),
    "condition chained": (jump("when = '0 < y < 1'", SET), 16, "0<y and y<1"),
    "condition true": (jump("when = true", SET), 16, "an expression in quotes", "found"),
    "assignment for a comparison": (jump("when = 'n = 2'", SET), 16, "=="),
    "equality of what moves": (jump("when = 'y == 0'", SET), 16, "'y' moves", ">="),
    "equality of time": (jump("when = 't != 1'", SET), 16, "'t' moves"),
    "equality in the dynamics": (rate("if(y == 2, 1, 0)"), 11, "'y' moves", "dynamics 0"),
    # times
    "every 0": (jump("every = 0", SET), 16, "is 0", "positive"),
    "every negative": (jump("every = '-e'", SET), 16, "is -0.5", "positive"),
    "every of a state": (jump("every = 'y'", SET), 16, "must be a constant"),
    "every not finite": (jump("every = inf", SET), 16, "a finite number"),
    "every a list": (jump("every = [1, 2]", SET), 16, "a number or an expression"),
    "at a number": (jump("at = 1", SET), 16, "expected a list of times"),
    "at empty": (jump("at = []", SET), 16, "is empty"),
    "at descends": (jump("at = [1, 3, 2]", SET), 16, "do not ascend: 2 after 3"),
    "at twice": (jump("at = [1, 1]", SET), 16, "do not ascend"),
    "at not a number": (jump("at = ['0/0']", SET), 16, "not a finite number"),
    "at a condition": (jump("at = ['t > 1']", SET), 16, "found the condition"),
    "at_start of times": (jump("every = 1", "at_start = true", SET), 17, "`at_start` belongs to"),
    "direction of times": (jump("every = 1", "direction = 'up'", SET), 17, "`direction` belongs to"),
    "persistent of times": (jump("every = 1", "persistent = false", SET), 17, "`persistent` belongs to"),
    # what is set
    "no set": (jump("when = 'y < 0'"), 15, "no `set`", "set = {"),
    "set empty": (jump("when = 'y < 0'", "set = {}"), 17, "`set` is empty"),
    "set a text": (jump("when = 'y < 0'", "set = 'v = -v'"), 17, "expected a table of states"),
    "set a list": (jump("when = 'y < 0'", "set = ['v']"), 17, "expected a table of states"),
    "set twice": (jump("when = 'y < 0'", "set = { v = 1, v = 2 }"), 17, "not valid TOML"),
    "set an unknown state": (jump("when = 'y < 0'", "set = { vv = 1 }"), 17, "'vv'", "did you mean 'v'"),
    "set a parameter": (jump("when = 'y < 0'", "set = { e = 1 }"), 17, "'e', which is a parameter", "with dynamics 0"),
    "set to a condition": (jump("when = 'y < 0'", "set = { n = 'y < 1' }"), 17, "found the condition 'y<1'", "if("),
    "set to an unknown name": (jump("when = 'y < 0'", "set = { v = '-ee*v' }"), 17, "unknown name 'ee'"),
    "set to true": (jump("when = 'y < 0'", "set = { n = true }"), 17, "an expression in quotes"),
    # how it is executed
    "key misspelt": (jump("when = 'y < 0'", SET, "prioity = 1"), 18, "did you mean 'priority'"),
    "foreign key": (jump("when = 'y < 0'", SET, "stop = true"), 18, "unknown key 'stop'"),
    "at_start a text": (jump("when = 'y < 0'", SET, "at_start = 'true'"), 18, "expected true or false"),
    "persistent a number": (jump("when = 'y < 0'", SET, "persistent = 0"), 18, "expected true or false"),
    "values misspelt": (jump("when = 'y < 0'", SET, "values = 'exection'"), 18, "'execution'"),
    "delay negative": (jump("when = 'y < 0'", SET, "delay = -1"), 18, "is -1", "0 or positive"),
    "delay infinite": (jump("when = 'y < 0'", SET, "delay = '1/0'"), 18, "is inf"),
    "delay true": (jump("when = 'y < 0'", SET, "delay = true"), 18, "an expression in quotes"),
    "priority a condition": (jump("when = 'y < 0'", SET, "priority = 'y > 1'"), 18, "found the condition"),
    "name twice": (jump("name = 'a'", "when = 'y < 0'", SET) + "[[jumps]]\nname = 'a'\nevery = 1\n" + SET + "\n", 19,
                   "'a' is already a jump"),
    "name with a blank": (jump("name = 'a b'", "when = 'y < 0'", SET), 15, "'a b' cannot name a jump"),
    "name in an expression": (jump("name = 'hit'", "when = 'y < 0'", "set = { v = 'hit' }"), 18, "'hit' is a jump"),
    "a table": (GOOD + "[jumps]\nwhen = 'y < 0'\n", 15, "[[jumps]]"),
    "misspelt": (GOOD + "[[jump]]\nwhen = 'y < 0'\n", 15, "did you mean 'jumps'"),
    # discrete states
    "modes that overlap in a value": (GOOD + "[[modes]]\nwhen = 'n <= 1'\ndynamics = { v = 1 }\n[[modes]]\nwhen = 'n >= 1'\n"
                                      "dynamics = { v = 2 }\n", 19, "overlaps"),
    "modes that leave a value out": (GOOD + "[[modes]]\nwhen = 'n < 1'\ndynamics = { v = 1 }\n[[modes]]\nwhen = 'n > 1'\n"
                                     "dynamics = { v = 2 }\n", 19, "uncovered"),
}


class MalformedJumps(tool.ToolTest):
    def test_the_model_they_are_made_from_is_good(self):
        out, _ = self.run_tool("check", self.write("good.toml", jump("when = 'y < 0'", SET)), code=0)
        self.assertIn("jump1: when y < 0 becomes true; sets v: v becomes -e*v", out)
        self.assertIn("n = 0", out)

    def test_all(self):
        for number, (name, (content, line, *expected)) in enumerate(FILES.items()):
            with self.subTest(name):
                file = self.write(f"m{number}.toml", content)
                out, err = self.run_tool("simulate", file.name, "--out", "r.json", code=2)
                self.assertEqual(out, "")
                first = [text for text in err.splitlines() if "error: " in text][0]
                self.assertTrue(first.startswith(f"m{number}.toml:{line}:"), err)
                for part in expected:
                    self.assertIn(part, err)
                self.assertFalse((self.folder / "r.json").exists())


if __name__ == "__main__":
    tool.main()
