"""Contacts and hysteresis where time stands still: the method fesd, and saltus optimize. Event-driven runs are the truth."""

import json
import math

import tool

HEAD = "[model]\nname = 'm'\n"

BALL = HEAD + """[states]
x = 0
z = 1
vx = 4
vz = 0
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
potential = "10*z"
[[contacts]]
name = "ground"
gap = "z"
tangent = { x = 1 }
friction = 0.3
[simulate]
until = 2
output = { times = [0.25, 1.0] }
"""

# A sloped, curved gap, and a mass matrix that is neither diagonal nor constant.
BOWL = HEAD + """[states]
x = 1
z = 2
vx = 0.3
vz = 0
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
mass = [["3 + x^2/10", "0.5"], ["0.5", 2]]
potential = "20*z"
coriolis = "auto"
[[contacts]]
name = "bowl"
gap = "z - x^2/4"
restitution = 0.7
[simulate]
until = 1.2
"""

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


class TimeFreezing(tool.ToolTest):
    def simulated(self, model, method, *more):
        file = self.write("m.toml", model)
        self.run_tool("simulate", file, "--method", method, "--quiet", "--out", "r.json", *more, code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    def assert_agree(self, model, delta, *more):
        event, frozen = self.simulated(model, "event"), self.simulated(model, "fesd", *more)
        self.assertEqual(event["states"], frozen["states"])
        self.assertEqual(frozen["final"]["t"], event["final"]["t"])
        for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
            self.assertAlmostEqual(expected, found, delta=delta)
        self.assertEqual([e["kind"] for e in event["events"]], [e["kind"] for e in frozen["events"]])
        self.assertEqual([e["surfaces"] for e in event["events"]], [e["surfaces"] for e in frozen["events"]])
        for expected, found in zip(event["events"], frozen["events"]):
            self.assertAlmostEqual(expected["t"], found["t"], delta=delta)
            for a, b in zip(expected["x_after"], found["x_after"]):
                self.assertAlmostEqual(a, b, delta=delta)
        return event, frozen

    def test_ball_lands_slides_and_stops(self):
        event, frozen = self.assert_agree(BALL, 1e-8)
        self.assertAlmostEqual(frozen["events"][0]["impulse"][0][0], math.sqrt(20), delta=1e-9)
        self.assertAlmostEqual(frozen["events"][1]["t"], math.sqrt(0.2) + (4 - 0.3 * math.sqrt(20)) / 3, delta=1e-9)
        self.assertEqual(frozen["events"][1]["contact_modes_after"], ["stick"])
        self.assertAlmostEqual(frozen["final"]["outputs"][1], 10.0, delta=1e-9)  # force(ground)
        rows = frozen["trajectory"]
        for t, x in ((0.25, 1.0), (1.0, None)):
            self.assertIn(t, rows["t"])
            row = rows["t"].index(t)
            expected = event["trajectory"]["x"][event["trajectory"]["t"].index(t)]
            for a, b in zip(expected, rows["x"][row]):
                self.assertAlmostEqual(a, b, delta=1e-8)
        # Time goes on, and has two rows where it stood still.
        self.assertEqual(rows["t"], sorted(rows["t"]))
        self.assertEqual(rows["t"].count(frozen["events"][0]["t"]), 2)

    def test_restitution_holds_with_any_mass_and_gap(self):
        _, frozen = self.assert_agree(BOWL, 1e-8, "--set", "simulate.fesd.stages=4")
        hit = frozen["events"][0]
        normal = lambda x: x[3] - x[0] / 2 * x[2]
        self.assertAlmostEqual(normal(hit["x_after"]), -0.7 * normal(hit["x"]), delta=1e-9)

    def test_automaton_of_nested_thresholds(self):
        _, frozen = self.assert_agree(RELAYS, 1e-8)
        self.assertEqual([e["name"] for e in frozen["events"]], 3 * ["first", "second", "third"])

    def test_bad_input(self):
        for change, line in (
            (("[simulate]", "[time_freezing]\na_n = 0\n[simulate]"), "a_n is 0"),
            (("[simulate]", "[time_freezing]\nstiffness = -1\n[simulate]"), "stiffness is -1"),
            (("[simulate]", "[time_freezing]\ntransfer = 0\n[simulate]"), "transfer is 0"),
            (("[simulate]", "[time_freezing]\nstabilisation = -1\n[simulate]"), "stabilisation is -1"),
            (("[simulate]", "[time_freezing]\nclock = 'x'\n[simulate]"), "`clock` beside [[contacts]]"),
            (("vz = 0\n", "vz = 0\nclock = 0\n"), "a state with the name 'clock' beside [[contacts]]"),
        ):
            file = self.write("bad.toml", BALL.replace(*change))
            _, err = self.run_tool("simulate", file, "--method", "fesd", code=2)
            self.assertIn(line, " ".join(err.split()))
        file = self.write("bad.toml", BALL.replace("friction = 0.3", "friction = 0.3\nrestitution = 0.5"))
        _, err = self.run_tool("simulate", file, "--method", "fesd", code=2)
        self.assertIn("has friction and restitution", err)
        self.run_tool("simulate", file, "--quiet", code=0)


if __name__ == "__main__":
    tool.main()
