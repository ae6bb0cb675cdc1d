"""Malformed [[hysteresis]]: refused with exit code 2, its line and a message that helps."""

import json

import tool

GOOD = """[model]
name = "car"
[states]
v = 0
[dynamics]
v = "1 + 2*turbo"
[simulate]
until = 20
"""


def hysteresis(*lines):
    """GOOD with one hysteresis: its table begins at line 9, its first key is in line 10."""
    return GOOD + "[[hysteresis]]\n" + "".join(line + "\n" for line in lines)


ALL = ("name = 'turbo'", "input = 'v'", "on = 15", "off = 10")

# name: (content, line, expected parts of the message…)
FILES = {
    "no name": (hysteresis(*ALL[1:]), 9, "no `name`"),
    "no input": (hysteresis(ALL[0], *ALL[2:]), 10, "no `input`"),
    "no threshold": (hysteresis(*ALL[:3]), 10, "no `off`"),
    "equal thresholds": (hysteresis(*ALL[:3], "off = 15"), 13, "are both 15", "two different thresholds"),
    "key misspelt": (hysteresis(*ALL, "inital = 1"), 14, "did you mean 'initial'"),
    "initial value": (hysteresis(*ALL, "initial = 2"), 14, "begins with 2", "0 or 1"),
    "input of time": (hysteresis(ALL[0], "input = 'v + t'", *ALL[2:]), 11, "depends on t"),
    "threshold of a state": (hysteresis(*ALL[:2], "on = 'v'", "off = 1"), 12, "`on` of the hysteresis 'turbo' depends on a state"),
    "name of a state": (hysteresis("name = 'v'", *ALL[1:]), 10, "'v' is already a state"),
    "a table": (GOOD + "[hysteresis]\nname = 'turbo'\n", 9, "[[hysteresis]]"),
    "dynamics": (hysteresis(*ALL).replace("v = \"1", "turbo = '0'\nv = \"1"), 6, "'turbo', which is a hysteresis"),
    "set by a jump": (hysteresis(*ALL) + "[[jumps]]\nevery = 1\nset = { turbo = 1 }\n", 16, "'turbo', which is a hysteresis"),
}


class MalformedHysteresis(tool.ToolTest):
    def test_the_model_they_are_made_from_is_good(self):
        file = self.write("good.toml", hysteresis(*ALL))
        out, _ = self.run_tool("simulate", file, code=0)
        self.assertIn("turbo", out)
        out, _ = self.run_tool("check", file, code=0)
        self.assertIn("turbo = 0", out)

    def test_beyond_a_threshold_at_the_start(self):
        file = self.write("beyond.toml", hysteresis(*ALL))
        _, err = self.run_tool("simulate", file, "--set", "v=16", "--out", "r.json", code=0)
        self.assertIn("beyond its thresholds", err)
        self.assertEqual(json.loads((self.folder / "r.json").read_text())["trajectory"]["x"][0], [16.0, 1.0])

    def test_a_number_that_is_called_value_is_one_mistake(self):
        """[outputs] calls it so; what is missing then is not told, too."""
        thresholds = '[parameters]\nhigh = { value = 15, unit = "m/s" }\nlow = { value = 10 }\n'
        file = self.write("value.toml", hysteresis(*ALL[:2], "on = 'high'", "off = 'low'") + thresholds)
        for command in ("simulate", "check"):
            out, err = self.run_tool(command, file, code=2)
            self.assertIn("unknown key 'value'", err + out)
            self.assertIn("did you mean 'initial'?", err + out)
            self.assertNotIn("both 0", err + out)
            self.assertNotIn("no initial value", err + out)
        self.assertEqual((out + err).count("error:"), 2)
        typo = '[parameters]\nhigh = { inital = 15 }\nlow = { initial = 10 }\n'
        file = self.write("typo.toml", hysteresis(*ALL[:2], "on = 'high'", "off = 'low'") + typo)
        out, err = self.run_tool("check", file, code=2)
        self.assertEqual((out + err).count("error:"), 1)

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


if __name__ == "__main__":
    tool.main()
