"""Tables, floor and sampled inputs; choices and whole parts in what jumps set; jumps at one time."""

import tool

MODEL = """[model]
name = "piecewise"
[states]
x = 0
[controls]
u = 0
[dynamics]
x = "road(x) + floor(4*t) + mod(t, 0.3) + u"
[tables.road]
x = [0, 1, 2, 3]
y = [0, 0.5, 0, 0.25]
kind = "linear"
[simulate]
until = 1
inputs = { u = { file = "u.csv" } }
"""


class PiecewiseFunctions(tool.ToolTest):
    def test_check_lists_them_with_their_breaks(self):
        self.write("u.csv", "0,1\n0.5,2\n0.7,3\n")
        path = self.write("piecewise.toml", MODEL)
        text, _ = self.run_tool("check", path, code=0)
        self.assertIn("piecewise functions (4)\n", text)
        self.assertIn("  road(x): kinks at 4 breaks\n", text)
        self.assertIn("  floor(4*t): jumps at whole numbers of its argument\n", text)
        self.assertRegex(text, r"  mod\(t,0\.3\).*: jumps at whole numbers of its argument\n")
        self.assertIn("  u: jumps at 2 breaks\n", text)
        text, _ = self.run_tool("check", "stick-slip", code=0)
        self.assertNotIn("piecewise", text)


JUMPS = """[model]
name = "instants"
[states]
x = 0
{states}
{definitions}
[dynamics]
x = "{rate}"
{dynamics}
[[jumps]]
{trigger}
set = {{ {set} }}
[simulate]
until = {until}
"""

STEPPED = """[model]
name = "stepped"
[states]
x = 0
u = 0
w = 0
side = 0
[controls]
r = 0
[dynamics]
x = "min(6*r, 3)"
u = 0
w = 0
side = 0
[[jumps]]
every = 0.5
set = {{ u = "min(6*r, 3)", w = "if(6*r > 3, 3, 6*r)", side = "sign(6*r - 3)" }}
[simulate]
until = 1.5
inputs = {{ r = "{reference}" }}
"""

# At the instant x and t are 1: right-hand sides and their values.
AT_ONE = {
    "if(E >= 1, 1, 0)": 1,
    "if(E > 1, 1, 0)": 0,
    "min(6*if(E >= 1, 1, 0), 2)": 2,
    "min(6*if(E >= 1, 1, 0), 4)": 4,
    "abs(if(E >= 1, 6, 0) - 5)": 1,
    "max(if(E < 1, 6, 0), 2)": 2,
    "min(max(6*(if(E < 1, 0, 1) - 0.25), -3), 3)": 3,
    "sign(6*if(E > 1, 1, 0) - 3)": -1,
    "step(if(E >= 1, 2, 0) - 2)": 0.5,
    "if(if(E >= 1, 6, 0) > 2, if(E > 1, 5, 7), 9)": 7,
    "min(6*step(E - 1), 4)": 3,
    "min(6*sign(E - 1), 4)": 0,
    "floor(E)": 1,
    "-floor(-E)": 1,
    "mod(E, 1)": 0,
    "floor(E + 0.5)": 1,
    "floor(if(E >= 1, 2.5, 0))": 2,
    "min(6*floor(E), 2)": 2,
    "if(floor(E) >= 1, 3, 4)": 3,
    "if(mod(E, 0.5) < 0.25, 3, 4)": 3,
    "if(min(E, 5) >= 1, 3, 4)": 3,
    "if(max(E, 0.5) > 1, 3, 4)": 4,
}
TRIGGERS = {'when = "x > 1"': "x", 'when = "x - 1"\ndirection = "up"': "x", "at = [1]": "t", "every = 1": "t"}
METHODS = [("--method", "smoothed")] + [
    ("--set", f"simulate.event.integrator={one}") for one in ("dopri5", "dop853", "radau5", "taylor")]


class JumpInstants(tool.ResultTest):
    def jumps(self, trigger, values, *arguments, rate="1", until=1.5, definitions=""):
        names = [f"is{k}" for k in range(len(values))]
        text = JUMPS.format(trigger=trigger, until=until, rate=rate, definitions=definitions,
                            states="\n".join(f"{name} = -7" for name in names),
                            dynamics="\n".join(f"{name} = 0" for name in names),
                            set=", ".join(f'{name} = "{value}"' for name, value in zip(names, values)))
        result = self.result(text, *arguments)
        return [event["x_after"][1:] for event in result["events"] if event["kind"] == "jump"], result

    def test_values_are_those_of_the_instant(self):
        for arguments in tool.some(METHODS, 2):
            for trigger, at in TRIGGERS.items():
                jumps, _ = self.jumps(trigger, [value.replace("E", at) for value in AT_ONE], *arguments)
                for written, expected, found in zip(AT_ONE, AT_ONE.values(), jumps[0]):
                    with self.subTest(method=arguments[1], trigger=trigger, set=written):
                        self.assertAlmostEqual(found, expected, 9)

    def test_comparisons_in_set_are_no_surfaces(self):
        _, result = self.jumps("every = 0.5", ["if(x > 0.7, min(x, 1), 0)", "floor(4*x)"])
        self.assertEqual([event["kind"] for event in result["events"]], ["jump"] * 3)
        self.assertEqual(result["switching_functions"], [])

    def test_whole_parts_of_what_was_located(self):
        """x is 1 to the last digits of a large time only."""
        for arguments in METHODS[1:]:
            with self.subTest(arguments=arguments):
                rate = "400*cos(400*(t - 999.5))"
                jumps, _ = self.jumps('when = "x > 0.5"', ["floor(2*x)", "if(x >= 0.5, 1, 0)", "if(x > 0.5, 1, 0)"],
                                      "--set", "simulate.from=999.5", *arguments, rate=rate, until=999.8)
                self.assertGreater(len(jumps), 15)
                self.assertEqual({tuple(jump) for jump in jumps}, {(1, 1, 0)})

    def test_samples_of_a_ramp(self):
        jumps, _ = self.jumps("every = 0.1", ["floor(10*x)", "mod(x, 0.2)", "floor(x/0.3)"], until=3)
        self.assertEqual([jump[0] for jump in jumps], list(range(1, 31)))
        self.assertEqual([jump[2] for jump in jumps], [k // 3 for k in range(1, 31)])

    def test_a_sampled_controller_follows_a_step_at_once(self):
        jumps, _ = self.jumps("every = 0.5", ["min(max(6*(if(t < 1, 0, 1) - 0*x), -3), 3)"])
        self.assertEqual(jumps, [[0], [3], [3]])

    def test_also_by_an_input(self):
        for reference in ("if(t < 1, 0, 1)", "step(t - 0.99)", "floor(t)"):
            text = STEPPED.format(reference=reference)
            for method in ("event", "smoothed"):
                with self.subTest(reference=reference, method=method):
                    events = self.result(text, "--method", method)["events"]
                    jumps = [event["x_after"][1:] for event in events if event["kind"] == "jump"]
                    self.assertEqual(jumps, [[0, 0, -1], [3, 3, 1], [3, 3, 1]])

    def test_what_is_slid_on_is_equal_and_its_selection_known(self):
        jumps, _ = self.jumps("every = 0.75", ["sign(x - r)", "if(x >= r, 1, 0)", "if(x > r, 1, 0)"],
                              rate="0.2 - sign(x - r)", until=0.9,
                              definitions='[definitions]\nr = "if(t < 1, -0.2, 0.1)"')
        for found, expected in zip(jumps[0], (0.2, 1, 0)):
            self.assertAlmostEqual(found, expected, 9)


    def test_where_a_slope_is_infinite(self):
        """A root at 0 has no rounding that its slope tells."""
        sets = {"a": ("if(sqrt(x^2 + z^2) < 1, 1, 2)", 1), "b": ("if(1 - x^0.5 > 0, 1, 2)", 1),
                "c": ("max(1 - hypot(x, z), 0)", 1), "d": ("floor(sqrt(x^2 + z^2)) + 7", 7)}
        text = ('[model]\nname = "roots"\n[parameters]\nu = 0\n[states]\nx = 0\nz = 0\n'
                + "".join(f"{name} = 5\n" for name in sets) + '[dynamics]\nx = "u"\nz = "0*x"\n'
                + "".join(f"{name} = 0\n" for name in sets) + "[[jumps]]\nevery = 1\nset = { "
                + ", ".join(f'{name} = "{value}"' for name, (value, _) in sets.items()) + " }\n[simulate]\nuntil = 1.5\n")
        self.assertEqual(self.result(text)["final"]["x"][2:], [right for _, right in sets.values()])


class JumpsAtOneTime(tool.ResultTest):
    DOSES = """[model]
name = "doses"
[states]
A = 0
[dynamics]
A = 0
[[jumps]]
name = "regular"
at = [0, 12]
set = {{ A = "A + 100" }}
[[jumps]]
name = "loading"
{trigger}
{values}
set = {{ A = "A + 50" }}
[simulate]
until = 13
"""

    def test_what_is_lost_is_said(self):
        for values, final, warned in (("", 150, True), ('values = "trigger"', 150, False),
                                      ('values = "execution"', 250, False)):
            text = self.DOSES.format(values=values, trigger="at = [12]")
            with self.subTest(values=values):
                self.assertEqual(self.result(text)["trajectory"]["x"][-1], [final])
                said = self.run_tool("check", self.write("m.toml", text), code=0)
                self.assertEqual("what 'regular' sets A to is lost" in "".join(said), warned)

    def test_only_where_times_meet(self):
        for trigger, warned in (("every = 3", True), ("every = 5", False), ("at = [11, 13]", False)):
            with self.subTest(trigger=trigger):
                text = self.DOSES.format(values="", trigger=trigger)
                said = self.run_tool("check", self.write("m.toml", text), code=0)
                self.assertEqual("is lost" in "".join(said), warned)


if __name__ == "__main__":
    tool.main()
