"""Malformed model files: every one is refused with exit code 2, its line, and a message that helps."""

import tool

GOOD = """[model]
name = "good"
[parameters]
mu = 0.8
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-x - mu*sign(v)"
[simulate]
until = 1
"""


def with_line(line, text, base=GOOD):
    """GOOD with one of its lines (counted from 1) replaced."""
    lines = base.splitlines()
    lines[line - 1] = text
    return "\n".join(lines) + "\n"


def after(text):
    """GOOD with more lines behind it: they begin at line 13."""
    return GOOD + text


# name: (content, line or None, expected parts of the message…)
FILES = {
    # no text, or not the text it seems
    "empty": ("", None, "the file is empty"),
    "blank": ("\n \t\n", None, "the file is empty"),
    "binary": (b"\x7fELF\x00\x01\x02", None, "this is no text file", "byte 4 is 0"),
    "byte order mark": (b"\xef\xbb\xbf" + GOOD.encode(), None, "byte order mark"),
    "utf-16": (GOOD.encode("utf-16"), None, "UTF-16"),
    "latin-1": (GOOD.encode() + b"# \xe9t\xe9\n", 13, "not valid TOML"),
    # not TOML
    "unclosed string": (with_line(9, 'x = "v'), 9, "not valid TOML"),
    "unclosed table": (with_line(5, "[states"), 5, "not valid TOML"),
    "no value": (with_line(6, "x ="), 6, "not valid TOML"),
    "bare expression": (with_line(9, "x = -v"), 9, "expressions stand in quotes"),
    "bare function": (with_line(9, "x = sin(t)"), 9, "expressions stand in quotes"),
    "key twice": (with_line(7, "x = 0"), 7, "not valid TOML"),
    "table twice": (after("[states]\ny = 1\n"), 13, "not valid TOML"),
    # unknown names
    "unknown table": (with_line(3, "[parameter]"), 3, "unknown table [parameter]", "did you mean 'parameters'"),
    "unknown array": (after("[[evnts]]\nwhen = 'x'\n"), 13, "did you mean 'events'"),
    "key outside": ("until = 3\n" + GOOD, 1, "unknown key 'until' outside of all tables"),
    "key of model": (with_line(2, 'nam = "good"'), 2, "unknown key 'nam'", "did you mean 'name'"),
    "key of simulate": (with_line(12, "untill = 1"), 12, "unknown option simulate.untill", "'simulate.until'"),
    "key of event options": (after("[simulate.event]\nintegrater = 'dopri5'\n"), 14, "simulate.event.integrator"),
    "option in the wrong table": (after("integrator = 'dopri5'\n"), 13, "did you mean 'simulate.event.integrator'"),
    "unknown option table": (after("[simulate.evnt]\nx = 1\n"), 13, "simulate.evnt"),
    "key of state": (with_line(6, "x = { inital = 1 }"), 6, "unknown key 'inital'", "did you mean 'initial'"),
    "key of control": (after("[controls]\nu = { free = true }\n"), 14, "unknown key 'free'"),
    "key of event": (after("[[events]]\nwhen = 'x'\ndirecton = 'up'\n"), 15, "did you mean 'direction'"),
    "unknown name": (with_line(10, 'v = "-x - nu*sign(v)"'), 10, "nu", "did you mean 'mu'"),
    "unknown function": (with_line(10, 'v = "-x - mu*sgn(v)"'), 10, "sgn", "sign"),
    # missing
    "no model": ("[states]\nx = 1\n[dynamics]\nx = '1'\n", 1, "no table [model]"),
    "no name": ("[states]\nx = 1\n[model]\ndescription = 'd'\n", 3, "the model has no name"),
    "empty name": (with_line(2, "name = ''"), 2, "the model's name is empty"),
    "no initial": (with_line(6, "x = { lower = 0 }"), 6, "'x' has no initial value"),
    "no dynamics of a state": (with_line(9, ""), 6, "x"),
    "event without when": (after("[[events]]\nname = 'e'\n"), 13, "this event has no `when`"),
    "no end time": (with_line(12, "rtol = 1e-6"), None, "no end time", "--until"),
    # wrong types
    "name a number": (with_line(2, "name = 3"), 2, "expected a name in quotes, found the number 3"),
    "state a boolean": (with_line(6, "x = true"), 6, "expected a number or an expression in quotes, found true"),
    "state a date": (with_line(6, "x = 2020-01-01"), 6, "found a date"),
    "parameter a list": (with_line(4, "mu = [1, 2]"), 4, "expected a number or an expression in quotes, found a list"),
    "parameter nan": (with_line(4, "mu = nan"), 4, "expected a finite number"),
    "states a number": ("states = 3\n[model]\nname = 'm'\n", 1, "expected the table [states], found the number 3"),
    "dynamics a table": (with_line(9, "x = { a = 1 }"), 9, "found a table"),
    "events a table": (after("[events]\nwhen = 'x'\n"), 13, "tables that begin with [[events]]"),
    "stop a word": (after("[[events]]\nwhen = 'x'\nstop = 'yes'\n"), 15, "expected true or false"),
    "free a number": (with_line(6, "x = { initial = 1, free = 1 }"), 6, "expected true or false"),
    # wrong values
    "inclusion": (with_line(2, "name = 'm'\ninclusion = 'filipov'"), 3, "did you mean 'filippov'"),
    "direction": (after("[[events]]\nwhen = 'x'\ndirection = 'upward'\n"), 15, "found the string \"upward\""),
    "until infinite": (with_line(12, "until = inf"), 12, "until: expected a finite number, found inf"),
    "until equals from": (with_line(12, "until = 1\nfrom = 1.0"), 12, "until (1) is not after from (1)"),
    "until before from": (with_line(12, "until = -1"), 12, "until (-1) is not after from (0)"),
    "key without end": (after(".".join(["a"] * 20000) + " = 1\n"), None, "a key has more than 32 parts"),
    "brackets without end": (after("x = " + "[" * 10000), 13, "not valid TOML"),
    "number without end": (with_line(6, "x = 1e999"), 6, "not valid TOML"),
    "rtol zero": (after("rtol = 0\n"), 13, "rtol: expected a finite number > 0, found 0"),
    "rtol negative": (after("rtol = -1e-3\n"), 13, "found -0.001"),
    "atol nan": (after("atol = nan\n"), 13, "atol: expected a finite number >= 0"),
    "rtol a word": (after("rtol = 'small'\n"), 13, "found \"small\""),
    "max_steps half": (after("max_steps = 0.5\n"), 13, "a whole number >= 1"),
    "max_events zero": (after("max_events = 0\n"), 13, "a whole number >= 1"),
    "max_step negative": (after("event.max_step = -1\n"), 13, "a finite number > 0 or \"none\""),
    "points": (after("output = { points = 1 }\n"), 13, "a whole number from 2"),
    "every": (after("output = { every = 0 }\n"), 13, "every: expected a finite number > 0"),
    "times unsorted": (after("output = { times = [0, 2, 1] }\n"), 13, "found 1 at place 3, after 2"),
    "times of words": (after("output = { times = [0, 'b'] }\n"), 13, "expected a number, found the string \"b\""),
    "times outside": (after("output = { times = [0, 7] }\n"), 13, "output time 7 lies outside"),
    "two outputs": (after("output = { points = 3, every = 1 }\n"), 13, "expected one of every, points and times"),
    "no output": (after("output = {}\n"), 13, "found none"),
    "output a word": (after("output = 'all'\n"), 13, "output: expected \"steps\""),
    "output unknown": (after("output = { evry = 1 }\n"), 13, "did you mean 'simulate.output.every'"),
    "initial mode": (after("initial_mode = { v = 2 }\n"), 13, "expected -1, 0 or 1, found 2"),
    "initial mode unknown": (after("initial_mode = { w = 1 }\n"), 13, "unknown switching function 'w'", "known: v"),
    "initial mode a number": (after("initial_mode = 1\n"), 13, "expected the table [simulate.initial_mode]"),
    "integrator": (after("event.integrator = 'dopri'\n"), 13, "did you mean 'dopri5'"),
    "input unknown": (after("inputs = { w = 'sin(t)' }\n"), 13, "w"),
    # expressions
    "expression empty": (with_line(9, 'x = ""'), 9, "empty expression"),
    "expression cut": (with_line(9, 'x = "v +"'), 9, "expect"),
    "expression parenthesis": (with_line(10, 'v = "-x - (mu"'), 10, "("),
    "expression of another language": (with_line(9, 'x = "v**2"'), 9, "^"),
    "expression on its second line": (with_line(9, "x = '''v +\n  w'''"), 10, "w"),
    "reserved name": (with_line(4, "pi = 3"), 4, "pi"),
    "name of two things": (with_line(4, "x = 0.8"), None, "x"),
    "name with a blank": (with_line(4, '"m u" = 0.8'), 4, "m u"),
    "cycle": (after("[definitions]\na = 'b'\nb = 'a'\n"), None, "a"),
    # modes
    "mode without dynamics": (after("[[modes]]\nwhen = 'x > 0'\n"), 13, "no `dynamics`", "absent get 0"),
    "mode without region": (after("[[modes]]\ndynamics = { x = 1 }\n"), 13, "no `when`", "otherwise"),
    "mode of a number": (after("[[modes]]\nwhen = 'x'\ndynamics = { x = 1 }\n"), 14, "expected a condition"),
    "mode misspelt": (after("[[modes]]\nwen = 'x > 0'\n"), 14, "did you mean 'when'"),
    "mode of another state": (after("[[modes]]\nwhen = 'x > 0'\ndynamics = { y = 1 }\n"), 15, "'y'", "x"),
    "modes uncovered": (after("[[modes]]\nwhen = 'x > 1'\ndynamics = { x = 1 }\n"), 14, "x-1 < 0", "uncovered"),
    "modes overlap": (after("[[modes]]\nwhen = 'x > 1'\ndynamics = { x = 1 }\n[[modes]]\nwhen = 'x > 0'\n"
                            "dynamics = { x = 2 }\n"), 17, "overlaps", "x-1 > 0"),
    "modes is a table": (after("[modes]\nwhen = 'x > 0'\n"), 13, "[[modes]]"),
    # later versions
    "indicators": (after("[[modes]]\nindicator = 'x'\ndynamics = { x = 1 }\n"), 13, "run by a later version"),
    "tables": (after("[tables.road]\nx = [0, 1]\n"), 13, "[tables]", "a later one brings it"),
    "mechanics": (after("[mechanics]\npositions = ['x']\n"), 13, "[mechanics]", "a later one brings it"),
    "contacts": (after("[[contacts]]\nname = 'c'\n"), 13, "[[contacts]]", "a later one brings it"),
    "optimize": (after("[optimize]\nhorizon = 1\n"), 13, "[optimize]", "a later one brings it"),
    "sensitivity": (after("[sensitivity]\nx = 1\n"), 13, "[sensitivity]", "a later one brings it"),
    "fesd": (after("[simulate.fesd]\nsteps = 1\n"), 13, "[simulate.fesd]", "a later one brings it"),
    "timestepping": (after("[simulate.timestepping]\nsteps = 1\n"), 13, "[simulate.timestepping]", "a later one"),
    "smoothed": (after("[simulate.smoothed]\nepsilon = -1\n"), 14, "epsilon", "expected a finite number > 0"),
    "smoothed key": (after("[simulate.smoothed]\nepsilom = 1\n"), 14, "did you mean 'simulate.smoothed.epsilon'?"),
    "method": (after("method = 'fesd'\n"), 13, "method \"fesd\" is not available", "a later one brings it"),
    "integrator": (after("event.integrator = 'radau'\n"), 13, "radau", "did you mean 'radau5'?"),
    "native": (after("native = 'never'\n"), 13, "native", 'expected "auto" or "on" or "off"'),
    "selection": (after("event.selection = 'scaled'\n"), 13, "selection", "a later one brings it"),
    "branches": (after("event.branches = 'all'\n"), 13, "branches", "a later one brings it"),
    "input from a file": (after("inputs.u = { file = 'u.csv' }\n"), 13, "from a file", "a later one brings it"),
    "free state": (with_line(6, "x = { initial = 1, free = true }"), 6, "free = true", "a later one brings it"),
    "free parameter": (with_line(4, "mu = { initial = 1, free = true }"), 4, "free = true", "a later one brings it"),
}


class MalformedModels(tool.ToolTest):
    def test_the_model_they_are_made_from_is_good(self):
        self.run_tool("simulate", self.write("good.toml", GOOD), "--quiet", code=0)

    def test_all(self):
        for number, (name, (content, line, *expected)) in enumerate(FILES.items()):
            with self.subTest(name):
                file = self.write(f"m{number}.toml", content)
                out, err = self.run_tool("simulate", file.name, "--out", "r.json", code=2)
                self.assertEqual(out, "")
                first = [text for text in err.splitlines() if "error: " in text][0]
                self.assertTrue(first.startswith(f"m{number}.toml:{'' if line is None else f'{line}:'}"), err)
                for part in expected:
                    self.assertIn(part, err)
                self.assertFalse((self.folder / "r.json").exists())


if __name__ == "__main__":
    tool.main()
