"""Contacts in saltus optimize: impacts, held gaps, closed loops. Event-driven runs are the truth."""

import json
import math
import tomllib

import time_freezing_test
import tool
from time_freezing_test import BALL, HEAD, LANDING

# A ball is pushed over a hump, on which it stays.
HUMP = HEAD + """[states]
x = -1
z = -0.25
vx = 0
vz = 0
[controls]
u = { lower = -20, upper = 20 }
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
force = { vx = "u", vz = -9.81 }
[[contacts]]
name = "hump"
gap = "z + x^2/4"
[time_freezing]
a_n = 20
[optimize]
horizon = 2
control_intervals = 5
elements = 2
running_cost = "u^2"
terminal_constraints = ["x == 1"]
"""

# Horizon, control intervals and objective where impacts stay at nodes.
WALLS = ((1, 8, 4.017), (1, 10, 5.401), (1, 15, 5.371), (2, 10, 2.183), (2, 20, 6.283))

QUARTER = math.pi / 4
# Of an independent code, but for the ninth digit of M33 (by hand).
MONOPED = (
    ({}, [-0.192912, -0.0548, 0, 0, 0.053976192, 0.01964, 0.00868, 0, -61.85205, 0, 0]),
    ({"q_z": 0.3, "phi_h": -QUARTER, "phi_k": 2 * QUARTER, "v_x": 1, "v_z": -1, "w_h": 2, "w_k": -3},
     [-0.1364093834, -0.0387494516, -0.0589104802, 0.0387494516, 0.032056192, 0.00868, 0.00868,
      0.3518902754, -62.2814391787, 0.5450318103, -0.4239721203]),
)

# A ball is pushed over ground that is nearly smooth, to a point above it.
PUSHED = """[model]
name = "pushed"
[states]
x = 0.0
z = 0.62
vx = 0.0
vz = 0.0
[controls]
ux = { lower = -19.28, upper = 19.28 }
uz = { lower = -19.28, upper = 19.28 }
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
potential = "9.81*z"
force = { vx = "-0.1*vx + ux", vz = "-0.1*vz + uz" }
[[contacts]]
name = "ground"
gap = "z"
tangent = { x = 1 }
friction = 0.05
[time_freezing]
a_n = 20
speed = { lower = 0.5, upper = 20 }
[optimize]
horizon = 2.65
control_intervals = 7
elements = 3
stages = 2
running_cost = "0.91*(ux^2 + uz^2)"
terminal_cost = "42.4*vx^2 + 24.83*vz^2"
terminal_constraints = ["x == 1.25", "z == 0.18"]
"""


class ContactOptima(time_freezing_test.FrozenTest):
    def test_monoped_has_its_masses_and_forces(self):
        text = (tool.SOURCE / "models/optima/monoped.toml").read_text(encoding="utf-8")
        forces = tomllib.loads(text)["mechanics"]["force"]
        outputs = ["M13", "M14", "M23", "M24", "M33", "M34", "M44"]
        table = "".join(f'm_{i} = "{name}"\n' for i, name in enumerate(outputs))
        table += "".join(f'h_{i} = "{force}"\n' for i, force in enumerate(forces.values()))
        text = text[:text.index("[optimize]")].replace("[outputs]\n", "[outputs]\n" + table)
        for state, expected in MONOPED:
            sets = [word for name, value in state.items() for word in ("--set", f"{name}={value}")]
            found = self.simulated(text, "event", "--until", "1e-6", *sets)["trajectory"]["outputs"][0]
            for a, b in zip(found, expected):
                self.assertAlmostEqual(a, b, delta=1e-9)

    def test_a_stabilisation_that_is_followed_down_leaves_the_problem_as_it_is(self):
        plain = self.optimised(LANDING)
        followed = self.optimised(LANDING.replace("a_n = 20", "a_n = 20\nstabilisation = { initial = 3, final = 0 }"))
        self.assertAlmostEqual(plain["objective"], followed["objective"], delta=1e-6)
        self.assertEqual(followed["model"]["parameters"], {})
        iterations = lambda result: [step["iterations"] for step in result["homotopy"]]
        self.assertNotEqual(iterations(plain), iterations(followed))
        for result in (plain, followed):
            self.assertIn(result["events"][0]["kind"], ("impact", "contact"))  # it may land softly
            self.assertEqual(set(result["verification"]["penetration"]), {"solution", "simulation"})
            self.assertLess(result["verification"]["penetration"]["solution"], 1e-3)
            self.assertLess(result["verification"]["penetration"]["simulation"], 1e-9)
            rows, drawn = result["trajectory"]["x"], result["drawing"]["rows"]
            self.assertEqual(drawn, [[0, x[0] + 0.1, 0.1] for x in rows])

    def test_a_collision_is_not_smeared(self):
        """Where the rate of the gap is 0, at the end of a collision, the gap stands whatever its selection is. Time could
        move there, in an element that begins with the collision, and the event engine contradicts."""
        landing = LANDING.replace("z = 0.5", "z = 0.35")
        later = LANDING.replace("intervals = 2", "intervals = 5") + "[optimize.mpcc]\nsteering = 'l1'\n"
        for text in (landing, landing.replace("elements", "reformulation = 'stewart'\nelements"),
                     landing.replace("elements", "stages = 3\nelements"), later):
            result = self.optimised(text)
            self.assertEqual(len([event for event in result["events"] if event["kind"] == "impact"]), 1)
            self.assertLess(result["verification"]["interval_defect"], 1e-12)

    def test_a_curved_gap_is_held(self):
        result = self.optimised(HUMP)
        self.assertLess(result["verification"]["penetration"]["solution"], 1e-9)
        self.assertLess(result["verification"]["interval_defect"], 1e-3)
        # A pendulum upside down, not a ball that falls through the hump.
        self.assertLess(result["verification"]["open_loop"]["amplification"], 1e3)

    @tool.not_sanitized
    def test_an_impact_at_the_end_of_an_interval_is_moved_or_told(self):
        """A body that falls brakes by friction, best without control: two elements have no room for that. The interval of
        the impact gets a third, and the one behind it may, unless no iterations are left for it."""
        fall, _ = BALL.replace("z = 1\nvx = 4", "z = 0.5\nvx = 3").replace("friction = 0.3", "friction = 0.4").split("[simulate]")
        braked = fall.replace("[mechanics]", "[controls]\nf = { lower = -30, upper = 30 }\n[mechanics]").replace(
            'potential = "10*z"', 'potential = "10*z"\nforce = { vz = "f" }') + """[time_freezing]
a_n = 30
[optimize]
horizon = 1
control_intervals = 8
elements = 2
running_cost = "0.01*f^2"
terminal_constraints = ["vx == 0"]
"""
        file = self.write("m.toml", braked)
        relaxed = ("--set", "optimize.mpcc.first=relaxed", "--set", "optimize.mpcc.compared_starts=4")
        _, err = self.run_tool("optimize", file, *relaxed, "--out", "r.json", code=0)
        self.assertRegex(err, r"elements = \[2, 2, 3, [23], 2, 2, 2, 2\]")
        result = json.loads((self.folder / "r.json").read_text())
        self.assertAlmostEqual(result["objective"], 0.0, delta=1e-12)
        messages = [step.get("message") for step in result["homotopy"]]
        iterations = sum(step["iterations"] for step in result["homotopy"][: messages.index("sides of the start")])
        limit = f"optimize.mpcc.iteration_limit={iterations}"
        out, err = self.run_tool("optimize", file, *relaxed, "--set", limit, "--out", "r.json", code=0)
        self.assertIn("impacts at t = 0.375 lie at ends of control intervals", err)
        self.assertIn("impacts at t = 0.375 lie at ends of control intervals", " ".join(out.split()))
        result = json.loads((self.folder / "r.json").read_text())
        self.assertIn("impacts at t = 0.375 lie at ends of control intervals", result["status"]["message"])
        impact = next(e for e in result["events"] if e["kind"] == "impact")
        change = [b - a for a, b in zip(impact["x"][2:], impact["x_after"][2:], strict=True)]
        self.assertAlmostEqual(impact["impulse"][0][0], change[1], delta=1e-9)
        self.assertAlmostEqual(impact["impulse"][0][1], change[0], delta=1e-9)
        out, err = self.run_tool("optimize", self.write("m.toml", braked.replace("elements = 2", "elements = 3")), "--out", "r.json", code=0)
        self.assertNotIn("ends of control intervals", out + err)
        self.assertAlmostEqual(json.loads((self.folder / "r.json").read_text())["objective"], 0.0, delta=1e-12)

    def test_impacts_move_to_where_they_are_best(self):
        """Until it stops at a wall a ball needs no control: 1/3 later it goes half of the way back, at 3/4 / (T - 1/3)^3."""
        wall = HEAD + """[states]
q = 0
v = 3
[controls]
u = { lower = -20, upper = 20 }
[mechanics]
positions = ["q"]
velocities = ["v"]
force = { v = "u" }
[[contacts]]
name = "wall"
gap = "1 - q"
[optimize]
horizon = 1
control_intervals = 10
running_cost = "u^2"
terminal_constraints = ["q == 0.5"]
"""
        for horizon, intervals, at_nodes in tool.some(WALLS, 1):
            result = self.optimised(wall.replace("intervals = 10", f"intervals = {intervals}").replace("horizon = 1", f"horizon = {horizon}"))
            least = 0.75 / (horizon - 1/3) ** 3
            self.assertLess(result["objective"] - least, 0.25 * (at_nodes - least))
            self.assertGreater(result["objective"], 0.97 * least)  # it may touch the wall a little earlier
            self.assertAlmostEqual(result["events"][0]["t"], 1/3, delta=0.02)

    def test_bounces_are_optimised(self):
        """Pushed as little as it takes, a ball bounces to a height and, thrown, to a target behind its bounce."""
        ball = HEAD + """[states]
z = 1
v = 0
[controls]
u = { lower = -10, upper = 10 }
[mechanics]
positions = ["z"]
velocities = ["v"]
force = { v = "u - 9.81" }
[[contacts]]
name = "ground"
gap = "z"
restitution = 0.9
[optimize]
horizon = 0.8
control_intervals = 8
elements = 4
start = "simulated"
running_cost = "u^2"
terminal_constraints = ["z == 0.6"]
[optimize.mpcc]
sigma_initial = 0.01
"""
        up = self.optimised(ball)
        self.assertAlmostEqual(up["objective"], 1.6554153, delta=1e-5)
        thrown = self.optimised(ball.replace("[mechanics]", "f = { lower = -1, upper = 1 }\n[mechanics]").replace(
            "z = 1\n", "z = 1\nx = 0\nw = { initial = 1, lower = 0, upper = 10, free = true }\n").replace(
            '["z"]', '["z", "x"]').replace('["v"]', '["v", "w"]').replace('v = "u - 9.81"', 'v = "-9.81", w = "f"').replace(
            '"u^2"', '"f^2"').replace("u = { lower = -10, upper = 10 }\n", "").replace(
            'constraints = ["z == 0.6"]', 'constraints = ["x == 2"]\nterminal_cost = "(w - 2.5)^2"'))
        self.assertAlmostEqual(thrown["events"][0]["t"], math.sqrt(2 / 9.81), delta=1e-9)
        for result in (up, thrown):
            impact, = result["events"]
            self.assertAlmostEqual(impact["x_after"][result["states"].index("v")],
                                   -0.9 * impact["x"][result["states"].index("v")], delta=1e-9)
            self.assertLess(result["verification"]["interval_defect"], 1e-9)

    def test_a_block_that_bounces_off_a_wall_in_least_time(self):
        """Full thrust to the wall and none behind it take 0.67233; relaxed problems of a free horizon alone give 1.995."""
        bounced = HEAD + """[states]
x = 0
v = 0
[controls]
F = { initial = 10, lower = 0, upper = 20 }
[mechanics]
positions = ["x"]
velocities = ["v"]
force = { v = "F - 0.6*9.81*sign(v)" }
[[contacts]]
name = "wall"
gap = "1 - x"
restitution = 0.8
[optimize]
horizon = { free = true, initial = 1, lower = 0.2, upper = 3 }
control_intervals = 20
minimize_time = true
terminal_constraints = ["x == 0", "v <= -2"]
"""
        for intervals in (11, 20):
            result = self.optimised(bounced.replace("intervals = 20", f"intervals = {intervals}"))
            self.assertGreater(result["horizon"], 0.67233 * (1 - 1e-5))
            self.assertLess(result["horizon"], 0.67233 * 1.015)

    def test_a_load_on_a_tether(self):
        """Controls of an unstable motion have another motion; 25 of them cost 2.5 % more than 50."""
        text = (tool.SOURCE / "models/optima/drone-load.toml").read_text(encoding="utf-8")
        self.assertLess(self.optimised(text)["objective"], 15.106 * 1.03)

    def test_a_body_stopped_by_a_wall_at_the_end(self):
        """A block is pushed into a wall that takes its speed: the impact is the last thing that happens."""
        result = self.optimised(HEAD + """[states]
q = 0
v = 0
[controls]
u = { lower = -2, upper = 2 }
[mechanics]
positions = ["q"]
velocities = ["v"]
force = { v = "u - 0.5*sign(v)" }
[[contacts]]
name = "wall"
gap = "1 - q"
[optimize]
horizon = { free = true, initial = 2, lower = 0.1, upper = 10 }
control_intervals = 4
minimize_time = true
terminal_constraints = ["q == 1", "v == 0"]
""")
        self.assertAlmostEqual(result["horizon"], math.sqrt(2 / 1.5), places=6)
        impact = result["events"][-1]
        self.assertEqual((impact["kind"], impact["surfaces"]), ("impact", ["wall"]))
        self.assertAlmostEqual(impact["impulse"][0][0], 1.5 * result["horizon"], places=6)
        self.assertAlmostEqual(result["final"]["x"][1], 0.0, delta=1e-12)

    def test_controls_that_change_have_two_rows(self):
        result = self.optimised(BALL.split("[simulate]")[0].replace("[mechanics]", "[controls]\nf = { lower = -3, upper = 3 }\n[mechanics]").replace(
            'potential = "10*z"', 'potential = "10*z"\nforce = { vx = "f" }') + """[optimize]
horizon = 0.3
control_intervals = 3
running_cost = "f^2"
terminal_cost = "x^2"
""")
        rows = result["trajectory"]
        for node in (0.1, 0.2):
            here = [i for i, t in enumerate(rows["t"]) if abs(t - node) < 1e-9]
            self.assertEqual(len(here), 2)
            self.assertNotEqual(rows["u"][here[0]], rows["u"][here[1]])

    def test_turns_of_a_slip_and_impulses_are_told(self):
        """A block on a spring with friction turns twice before it sticks, and a ball's impact has its impulse in its row."""
        spring = (BALL.replace("x = 0\nz = 1\nvx = 4", "x = 2\nz = 0\nvx = 0").replace('"10*z"', '"10*z + 2.5*x^2"')
                  .replace("friction = 0.3", "friction = 0.2").replace("until = 2\noutput = { times = [0.25, 1.0], events = true }", "until = 4"))
        self.run_tool("simulate", self.write("s.toml", spring), "--out", "e.json", code=0)
        self.run_tool("simulate", "s.toml", "--method", "fesd", "--out", "f.json", code=0)
        events, frozen = (json.loads((self.folder / f).read_text())["events"] for f in ("e.json", "f.json"))
        self.assertEqual([event["kind"] for event in events], [event["kind"] for event in frozen])
        self.assertEqual([event["kind"] for event in events][-1], "stick")
        self.assertIn("slip", [event["kind"] for event in events])
        for a, b in zip(events, frozen, strict=True):
            self.assertAlmostEqual(a["t"], b["t"], delta=1e-4)
        self.run_tool("simulate", self.write("b.toml", BALL), "--method", "fesd", "--out", "b.json", code=0)
        ball = json.loads((self.folder / "b.json").read_text())
        impact = next(event for event in ball["events"] if event["kind"] == "impact")
        column = ball["outputs"].index("impulse(ground)")
        told = [row[column] for row in ball["trajectory"]["outputs"] if row[column] != 0.0]
        self.assertEqual(told, [impact["impulse"][0][0]])

    @tool.not_sanitized
    def test_bodies_are_only_so_deep_in_each_other(self):
        """Gaps that nothing corrects drift: the ball cannot stay on the hump, and sinks as far as it may."""
        depths = []
        for limit, names in (("inf", {"x == 1"}), ("1e-5", {"gap(hump)", "x == 1"})):
            text = HUMP.replace("a_n", f"correction = 0\npenetration = {limit}\na_n")
            self.run_tool("optimize", self.write("m.toml", text), "--quiet", "--out", "r.json", code=3)
            result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            self.assertEqual({multiplier["name"] for multiplier in result["multipliers"]}, names)
            depths.append(result["verification"]["penetration"]["solution"])
        self.assertGreater(depths[0], 1e-4)
        self.assertLess(depths[1], 1.1e-5)

    @tool.not_sanitized
    def test_a_certified_point_is_not_lost_for_one_that_is_not_solved(self):
        """A removal leads to the same objective, but for 1e-9 of it, with multipliers that are not solved."""
        result = self.optimised(PUSHED + '[optimize.mpcc]\nfirst = "relaxed"\ncompared_starts = 4\n')
        self.assertTrue(result["certificate"]["b_stationary"])
        self.assertLess(result["objective"], 69)

    def test_a_solution_is_followed_to_another_problem(self):
        landing = LANDING.replace("intervals = 2", "intervals = 4")
        self.optimised(landing)
        near = self.write("near.toml", landing.replace("u - 1", "u - 0.9"))
        self.run_tool("optimize", near, "--start", "r.json", "--set", "optimize.mpcc.first=branch", "--quiet", "--out",
                      "s.json", code=0)
        result = json.loads((self.folder / "s.json").read_text(encoding="utf-8"))
        self.assertEqual(result["homotopy"][0]["message"], "sides of the start")
        self.assertNotIn("relaxed", {step["phase"] for step in result["homotopy"]})

    def test_what_a_bounce_needs_is_in_the_message(self):
        bouncing = LANDING.replace('gap = "z"', 'gap = "z"\nrestitution = 0.8')
        _, err = self.run_tool("optimize", self.write("m.toml", bouncing), "--set", "optimize.mpcc.iteration_limit=20", code=3)
        self.assertIn("a contact with restitution needs elements = 4 or more", err)
        _, err = self.run_tool("optimize", self.write("m.toml", bouncing), "--set", "optimize.mpcc.iteration_limit=20", "--set",
                               "optimize.elements=4", "--set", "optimize.start=simulated", code=3)
        self.assertNotIn("needs elements", err)

    def test_the_closed_loop_goes_through_an_impact(self):
        result = self.optimised(LANDING)
        self.assertEqual(result["outputs"], ["gap(ground)", "force(ground)", "impulse(ground)", "energy"])
        rests = [row for row in result["trajectory"]["outputs"] if row[1] > 0.0]
        self.assertTrue(rests)
        self.assertLess(max(abs(row[0]) for row in rests), 1e-12)
        for row in result["trajectory"]["outputs"]:
            self.assertAlmostEqual(row[0] * row[1], 0.0, delta=1e-12)
        closed_loop = result["verification"]["closed_loop"]
        self.assertEqual(closed_loop["termination"], "completed")
        self.assertLess(closed_loop["end_state_error"], 1e-3)
        self.assertAlmostEqual(closed_loop["x"][-1][0], 0.0, delta=1e-9)


if __name__ == "__main__":
    tool.main()
