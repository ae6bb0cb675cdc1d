"""Hysteresis where time stands still: the method fesd, and saltus optimize. Event-driven runs are the truth."""

import json

import time_freezing_test
import tool

HEAD = time_freezing_test.HEAD

RELAYS = HEAD + """[states]
v = 0
y = 0
[dynamics]
v = "1 - 2*third"
y = "first + 10*second - 3*third"
[[hysteresis]]
name = "first"
input = "v"
on = 1
off = 0.5
[[hysteresis]]
name = "second"
input = "v"
on = 2
off = 0.25
[[hysteresis]]
name = "third"
input = "v"
on = 3
off = 0.1
[simulate]
until = 9
"""

# A room whose heating is compared; without it its rate is 10 heating - (x - 15)/2, written as a factor.
ROOM = HEAD + """[states]
x = 15
y = 0
[dynamics]
x = "RATE"
y = "x - 15"
[[hysteresis]]
name = "heating"
input = "x"
on = 18
off = 20
initial = 1
[simulate]
until = 3
"""

ROOMS = {
    "a factor": "10*heating - 0.5*(x - 15)",
    "greater": "if(heating > 0.5, 10 - 0.5*(x - 15), -0.5*(x - 15))",
    "greater than 0": "if(heating > 0, 10, 0) - 0.5*(x - 15)",
    "less": "if(heating < 0.3, 0, 10) - 0.5*(x - 15)",
    "equal": "if(heating == 1, 10, 0) - 0.5*(x - 15)",
    "not equal": "if(heating != 0, 10, 0) - 0.5*(x - 15)",
    "sign": "5 + 5*sign(heating - 0.5) - 0.5*(x - 15)",
    "step": "10*step(2*heating - 1) - 0.5*(x - 15)",
    "max": "20*max(heating - 0.5, 0) - 0.5*(x - 15)",
    "abs": "20*abs(0.5 - heating) * heating - 0.5*(x - 15)",
    "and": "if(heating > 0.5 and x > 10, 10, 0) - 0.5*(x - 15)",
    "or": "if(heating > 0.5 or x > 100, 10, 0) - 0.5*(x - 15)",
    "a limit": "if(x < 19 + 2*heating - y/100, 10*heating, 0) - 0.5*(x - 15)",
    "another limit": "if(x < 18.5 + 2.5*heating, 10*heating, -1) - 0.5*(x - 15)",
    "nested": "if(x < if(heating == 1, 21, 18.5), 10*heating, -1) - 0.5*(x - 15)",
}
# Motions of their own, and a surface for every value of the hysteresis.
OTHER_ROOMS = {"a limit", "another limit", "nested"}

# Two of them with thresholds of their own; their regions have sums of both as indicators.
PAIR = HEAD + """[states]
y = 0
[dynamics]
y = "{rate}"
[[hysteresis]]
name = "first"
input = "{input}"
on = {first[0]}
off = {first[1]}
[[hysteresis]]
name = "second"
input = "y"
on = {second[0]}
off = {second[1]}
[simulate]
until = 6
"""


# What rises, or falls, to a threshold that is chosen, and back.
EDGE = HEAD + """[parameters]
edge = {{ initial = 1.3, lower = 1, upper = 2, free = true }}
[states]
x = {start}
[dynamics]
x = "{rate}"
[[hysteresis]]
name = "down"
input = "x"
on = "edge"
off = {off}
[optimize]
horizon = 3
control_intervals = 3
terminal_cost = "(x - {aim})^2"
"""


class FrozenHysteresis(time_freezing_test.FrozenTest):
    def test_automaton_of_nested_thresholds(self):
        _, frozen = self.assert_agree(RELAYS, 1e-8)
        self.assertEqual([e["name"] for e in frozen["events"]], 3 * ["first", "second", "third"])

    def test_a_hysteresis_is_compared(self):
        exact = self.simulated(ROOM.replace("RATE", ROOMS["a factor"]), "event")["final"]["x"]
        self.assertAlmostEqual(exact[0], 19.0778725174, delta=1e-7)
        for what, rate in tool.some(ROOMS.items(), 4):
            with self.subTest(what):
                model = ROOM.replace("RATE", rate)
                if what in OTHER_ROOMS:
                    event, frozen = (self.simulated(model, method) for method in ("event", "fesd"))
                    jumps = lambda run: [e["t"] for e in run["events"] if e["kind"] == "jump"]
                    for a, b in zip(jumps(event) + event["final"]["x"], jumps(frozen) + frozen["final"]["x"], strict=True):
                        self.assertAlmostEqual(a, b, delta=1e-5)
                    continue
                event, frozen = self.assert_agree(model, 1e-5)
                for a, b in zip(exact, event["final"]["x"]):
                    self.assertAlmostEqual(a, b, delta=1e-6)

    def test_a_surface_with_a_number_is_shown(self):
        _, frozen = self.assert_agree(ROOM.replace("RATE", "12*heating - if(x > 17.5, 2, 0) - 0.5*(x - 15)"), 1e-5)
        self.assertEqual(frozen["events"][0]["surfaces"], ["x-17.5"])

    def test_regions_of_two(self):
        product = " + ({})*first*second"
        for rate, wire, first, second in tool.some((
            ("-1.18 + 3.36*first - 1.25*second" + product.format(0.57), "0.5*y + 1", (0.1, 0.3), (1.9, -2.0)),
            ("1.535 - 4.07*first + 1.22*second" + product.format(-0.706), "-2*y", (1.4, 4.0), (-1.8, -1.0)),
            ("0.471 - 1.943*first - 1.873*second" + product.format(-0.813), "y", (2.0, -1.3), (-0.3, -0.5)),
        ), 1):
            with self.subTest(rate=rate):
                model = PAIR.format(rate=rate, input=wire, first=first, second=second)
                for form in ("step", "stewart"):
                    self.assert_agree(model, 1e-7, "--set", f"simulate.fesd.reformulation={form}")

    def test_modes_of_an_automaton(self):
        modes = RELAYS.replace("[dynamics]\n", "", 1).replace('v = "1 - 2*third"\ny = "first + 10*second - 3*third"\n', """
[[modes]]
when = "third == 1"
dynamics = { v = -1, y = "first + 10*second - 3" }
[[modes]]
when = "otherwise"
dynamics = { v = 1, y = "if(first + second >= 2, 11, if(first + second == 1, first + 10*second, 0))" }
""")
        expected, frozen = self.assert_agree(RELAYS, 1e-8)[0], self.assert_agree(modes, 1e-8)[1]
        for a, b in zip(expected["final"]["x"], frozen["final"]["x"]):
            self.assertAlmostEqual(a, b, delta=1e-8)

    def test_hysteresis_of_a_car_is_optimised(self):
        text = (tool.SOURCE / "models/optima/turbo-hysteresis.toml").read_text(encoding="utf-8")
        self.run_tool("optimize", self.write("m.toml", text), "--quiet", "--out", "r.json", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertAlmostEqual(result["objective"], 10.2292578, delta=1e-5)
        self.assertEqual(result["states"], ["q", "v", "turbo"])
        self.assertEqual([e["name"] for e in result["events"]], ["turbo", "turbo"])
        self.assertAlmostEqual(result["events"][0]["t"], 3.0, delta=1e-7)
        self.assertLess(result["verification"]["interval_defect"], 1e-9)
        # Compared, the turbo is the same factor.
        compared = self.optimised(text.replace("u*(1 + 2*turbo)", "u*if(turbo == 1 and q > -1, 3, 1)"))
        self.assertAlmostEqual(compared["objective"], 10.2292578, delta=1e-5)
        # Results are in physical time, without the clock, and can be started from all the same.
        file = self.write("m.toml", text)
        _, err = self.run_tool("optimize", file, "--quiet", "--start", "r.json", "--time-limit", "0.01", code=3)
        self.assertIn("time", err)

    def test_a_threshold_is_optimised(self):
        # With on = c the input is 2 c - 3 at the end, and 2 c where it falls first: 0.4 and 3.4 at c = 1.7.
        for name, start, rate, off, aim in (("rising", 0, "1 - 2*down", -5, 0.4), ("falling", 3, "2*down - 1", 5, 3.4)):
            with self.subTest(name):
                result = self.optimised(EDGE.format(start=start, rate=rate, off=off, aim=aim))
                self.assertAlmostEqual(result["parameters"]["edge"], 1.7, delta=1e-8)
                self.assertLess(result["objective"], 1e-15)
                self.assertLess(result["verification"]["interval_defect"], 1e-9)
                self.assertEqual([e["name"] for e in result["events"]], ["down"])

    def test_a_threshold_is_optimised_to_its_bound(self):
        # The turbo is best switched on as early as it may be.
        text = (tool.SOURCE / "models/optima/turbo-hysteresis.toml").read_text(encoding="utf-8")
        free = "[parameters]\nup = { initial = 15, lower = 12, upper = 20, free = true }\n[states]"
        result = self.optimised(text.replace("[states]", free, 1).replace("on = 15", "on = \"up\""))
        self.assertAlmostEqual(result["parameters"]["up"], 12, delta=1e-7)
        self.assertAlmostEqual(result["objective"], 10.0084705, delta=1e-5)
        self.assertLess(result["verification"]["interval_defect"], 1e-9)

    @tool.not_sanitized
    def test_a_finer_grid_starts_from_the_coarser_one(self):
        for intervals, optimum in ((10, 10.2292578), (20, 10.1530809), (40, 10.1408047), (80, 10.1346350)):
            words = ["--intervals", str(intervals), "--set", f"time_freezing.transfer={intervals / 10}"]
            if intervals > 10:
                words += ["--start", "r.json", "--set", "optimize.mpcc.sigma_initial=1e-3"]
            self.run_tool("optimize", "turbo-hysteresis", *words, "--quiet", "--out", "r.json", code=0)
            result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            self.assertAlmostEqual(result["objective"], optimum, delta=1e-6)
            self.assertLess(result["verification"]["interval_defect"], 1e-9)


if __name__ == "__main__":
    tool.main()
