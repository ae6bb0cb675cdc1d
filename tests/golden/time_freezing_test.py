"""Contacts and hysteresis where time stands still: the method fesd, and saltus optimize. Event-driven runs are the truth."""

import json
import math
import tomllib

import contacts_test
import tool

HEAD = "[model]\nname = 'm'\n"

BALL = contacts_test.BALL.replace("\"mu\"", "0.3") + "output = { times = [0.25, 1.0] }\n"

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

# A ball lands and stays where it is; what it is pushed with costs.
LANDING = HEAD + """[states]
z = 0.5
v = 0
[controls]
u = { lower = -5, upper = 5 }
[mechanics]
positions = ["z"]
velocities = ["v"]
force = { v = "u - 9.81" }
draw = [{ point = [0, "z + 0.1"], radius = 0.1 }]
[[contacts]]
name = "ground"
gap = "z"
[time_freezing]
a_n = 20
[optimize]
horizon = 0.6
control_intervals = 2
elements = 3
running_cost = "(u - 1)^2"
"""

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

QUARTER = math.pi / 4
# Of an independent code, but for the ninth digit of M33 (by hand).
MONOPED = (
    ({}, [-0.192912, -0.0548, 0, 0, 0.053976192, 0.01964, 0.00868, 0, -61.85205, 0, 0]),
    ({"q_z": 0.3, "phi_h": -QUARTER, "phi_k": 2 * QUARTER, "v_x": 1, "v_z": -1, "w_h": 2, "w_k": -3},
     [-0.1364093834, -0.0387494516, -0.0589104802, 0.0387494516, 0.032056192, 0.00868, 0.00868,
      0.3518902754, -62.2814391787, 0.5450318103, -0.4239721203]),
)


class FrozenTest(tool.ToolTest):
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

    def optimised(self, text):
        self.run_tool("optimize", self.write("m.toml", text), "--quiet", "--out", "r.json", code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))


class TimeFreezing(FrozenTest):
    def test_events_do_not_depend_on_rows_at_their_times(self):
        # The ball meets its box at t = 0.5, but for a rounding.
        found = []
        for rows in ("auto", "{ every = 0.01 }"):
            self.run_tool("simulate", "ball-in-box", "--method", "fesd", "--set", "simulate.max_steps=60", "--set",
                          f"simulate.output={rows}", "--quiet", "--out", "r.json", code=3)
            result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            times = [event["t"] for event in result["events"]]
            found.append(times)
            self.assertEqual([result["trajectory"]["t"].count(t) for t in times], [2] * len(times))
        self.assertAlmostEqual(found[0][0], 0.5, delta=1e-9)
        self.assertEqual(*found)

    def test_events_of_runs_that_fail_do_not_depend_on_the_rows(self):
        for model in ("falling-rod", "painleve-rod"):
            found = set()
            for rows in ("auto", "steps", "{ points = 2 }", "{ every = 0.01 }"):
                self.run_tool("simulate", model, "--method", "fesd", "--set", f"simulate.output={rows}", "--quiet",
                              "--out", "r.events.csv", "--out", "r.json", code=3)
                final = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["final"]
                found.add((json.dumps(final), (self.folder / "r.events.csv").read_text(encoding="utf-8")))
            with self.subTest(model=model):
                self.assertEqual(len(found), 1)
                self.run_tool("report", "r.json", code=0)

    def test_where_time_stands_still_there_are_no_forces(self):
        for output in ("auto", "{ every = 0.001 }"):
            self.run_tool("simulate", "falling-rod", "--method", "fesd", "--set", f"simulate.output={output}", "--quiet",
                          "--out", "r.json", code=3)
            result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            forces = [k for k, name in enumerate(result["outputs"]) if name.startswith(("force", "friction"))]
            self.assertEqual(len(forces), 4)
            self.assertLess(max(abs(row[k]) for row in result["trajectory"]["outputs"] for k in forces), 1e6, output)

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

    def test_an_impact_ends_whatever_force_and_steps_are(self):
        landing = LANDING[:LANDING.index("[optimize]")] + "[simulate]\nuntil = 0.6\n"
        for force in (1, 9.81, 100):
            for steps in (10, 20, 40, 100):
                model = landing.replace("a_n = 20", f"a_n = {force}").replace("u - 9.81", "-9.81")
                frozen = self.simulated(model, "fesd", "--set", f"simulate.fesd.steps={steps}")
                self.assertAlmostEqual(frozen["events"][0]["t"], math.sqrt(1 / 9.81), delta=1e-9)
                self.assertEqual([e["kind"] for e in frozen["events"]], ["impact"])
                self.assertEqual(frozen["final"]["contact_modes"], ["closed"])

    def test_restitution_holds_with_any_mass_and_gap(self):
        _, frozen = self.assert_agree(BOWL, 1e-8, "--set", "simulate.fesd.stages=3")
        hit = frozen["events"][0]
        normal = lambda x: x[3] - x[0] / 2 * x[2]
        self.assertAlmostEqual(normal(hit["x_after"]), -0.7 * normal(hit["x"]), delta=1e-9)

    def test_bounces_are_exact(self):
        """Flights are parabolas, and so are depths: two stages have no error, whatever force and restitution are."""
        for restitution in (0.1, 0.6, 1.0):
            for force in (20, 100):
                event, frozen = self.assert_agree(HEAD + f"""[states]
z = 1
v = 0
[mechanics]
positions = ["z"]
velocities = ["v"]
mass = [[2]]
potential = "20*z"
[[contacts]]
name = "ground"
gap = "z"
restitution = {restitution}
[time_freezing]
a_n = {force}
[simulate]
until = 0.53
""", 1e-9)
                hit = frozen["events"][0]
                self.assertAlmostEqual(hit["x_after"][1], restitution * math.sqrt(20), delta=1e-9)
                self.assertAlmostEqual(hit["impulse"][0][0], 2 * (1 + restitution) * math.sqrt(20), delta=1e-8)

    def test_a_force_along_the_ground_pushes_whatever_holds_the_gap(self):
        """Of the gap and its rate one equation holds two selections at rest: none may leave its bounds, nor time its way."""
        model = HEAD + """[states]
x = 0.03
z = 0.1
vx = 1
vz = -1.71
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
force = { vx = "2.75*sin(2.1*t)", vz = -9.81 }
[[contacts]]
name = "ground"
gap = "z - 0.1"
restitution = 0.5
[simulate]
until = 2
"""
        part = 2.75 / 2.1
        for stages, steps in ((2, 100), (3, 50), (3, 400), (4, 100), (4, 200), (5, 60)):
            with self.subTest(stages=stages, steps=steps):
                frozen = self.simulated(model, "fesd", "--set", f"simulate.fesd.stages={stages}",
                                        "--set", f"simulate.fesd.steps={steps}")
                self.assertEqual(frozen["final"]["t"], 2)
                self.assertAlmostEqual(frozen["final"]["x"][0], 2.03 + part * (2 - math.sin(4.2) / 2.1), delta=1e-6)
                self.assertAlmostEqual(frozen["final"]["x"][2], 1 + part * (1 - math.cos(4.2)), delta=1e-6)

    def test_bounces_end_at_rest(self):
        ball = (tool.SOURCE / "models/elastic-ball.toml").read_text(encoding="utf-8").replace("e = 0.9", "e = 0.5")
        frozen = self.simulated(ball, "fesd", "--until", "4")
        self.assertEqual(frozen["status"]["termination"], "completed")
        self.assertGreater(len([e for e in frozen["events"] if e["kind"] == "impact"]), 10)
        self.assertAlmostEqual(frozen["events"][-1]["t"], math.sqrt(0.2) * 3, delta=1e-4)
        self.assertEqual(frozen["final"]["contact_modes"], ["closed"])
        for value in frozen["final"]["x"]:
            self.assertAlmostEqual(value, 0.0, delta=1e-12)
        outputs = dict(zip(frozen["outputs"], frozen["final"]["outputs"]))
        self.assertAlmostEqual(outputs["force(ground)"], 10.0, delta=1e-9)

    def test_the_key_of_earlier_versions_is_read(self):
        for name, setting in (("a.csv", "simulate.method=fesd"), ("b.csv", "time_freezing.stiffness=20")):
            self.run_tool("simulate", "elastic-ball", "--method", "fesd", "--out", name, "--set", setting, code=0)
        self.assertEqual((self.folder / "a.csv").read_bytes(), (self.folder / "b.csv").read_bytes())

    def test_bad_input(self):
        for change, line in (
            (("[simulate]", "[time_freezing]\na_n = 0\n[simulate]"), "a_n is 0"),
            (("[simulate]", "[time_freezing]\nstiffness = -1\n[simulate]"), "stiffness is -1"),
            (("[simulate]", "[time_freezing]\ntransfer = 0\n[simulate]"), "transfer is 0"),
            (("[simulate]", "[time_freezing]\npenetration = 0\n[simulate]"), "penetration is 0"),
            (("[simulate]", "[time_freezing]\nstabilisation = -1\n[simulate]"), "stabilisation is -1"),
            (("[simulate]", "[time_freezing]\nstabilisation = { initial = -1 }\n[simulate]"), "initial is -1"),
            (("[simulate]", "[time_freezing]\nstabilisation = { initial = 1, final = -1 }\n[simulate]"), "final is -1"),
            (("[simulate]", "[time_freezing]\nstabilisation = { final = 1 }\n[simulate]"), "no `initial`"),
            (("[simulate]", "[time_freezing]\nstabilisation = { initial = 1, fnal = 0 }\n[simulate]"), "'final'"),
            (("[simulate]", "[time_freezing]\nclock = 'x'\n[simulate]"), "`clock` beside [[contacts]]"),
            (('gap = "z"', 'gap = "z - 0.1*t"'), "the gap of 'ground' depends on t, and time stands still"),
            (("vz = 0\n", "vz = 0\nclock = 0\n"), "a state with the name 'clock' beside [[contacts]]"),
            (("[parameters]\n", "[parameters]\nclock = 1\n"), "a parameter with the name 'clock' beside [[contacts]]"),
            (("[simulate]", "[tables.clock]\nx = [0, 1]\ny = [0, 1]\n[simulate]"),
             "a table with the name 'clock' beside [[contacts]]"),
        ):
            file = self.write("bad.toml", BALL.replace(*change))
            _, err = self.run_tool("simulate", file, "--method", "fesd", code=2)
            self.assertIn(line, " ".join(err.split()))
            self.assertLessEqual(err.count("in [time_freezing]"), 1)
        file = self.write("bad.toml", BALL.replace("friction = 0.3", "friction = 0.3\nrestitution = 0.5"))
        _, err = self.run_tool("simulate", file, "--method", "fesd", code=2)
        self.assertIn("has friction and restitution", err)
        line = 1 + BALL.splitlines().index('name = "ground"')
        self.assertIn(f"bad.toml:{line}:", err)
        self.run_tool("simulate", file, "--quiet", code=0)

    def test_monoped_has_its_masses_and_forces(self):
        text = (tool.SOURCE / "examples/contacts/monoped.toml").read_text(encoding="utf-8")
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

    def test_an_impact_at_the_end_of_an_interval_is_moved_or_told(self):
        """A body that falls brakes by friction, best without control: two elements have no room for that."""
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
        out, err = self.run_tool("optimize", self.write("m.toml", braked), "--out", "r.json", code=0)
        self.assertIn("impacts at t = 0.375 lie at ends of control intervals", err)
        self.assertIn("Impacts at t = 0.375 lie at ends of control intervals", " ".join(out.split()))
        impact = next(e for e in json.loads((self.folder / "r.json").read_text())["events"] if e["kind"] == "impact")
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
        for horizon, intervals, at_nodes in ((1, 8, 4.017), (1, 10, 5.401), (1, 15, 5.371), (2, 10, 2.183), (2, 20, 6.283)):
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
                  .replace("friction = 0.3", "friction = 0.2").replace("until = 2\noutput = { times = [0.25, 1.0] }", "until = 4"))
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

    def test_a_solution_is_followed_to_another_problem(self):
        landing = LANDING.replace("intervals = 2", "intervals = 4")
        self.optimised(landing)
        near = self.write("near.toml", landing.replace("u - 1", "u - 0.9"))
        self.run_tool("optimize", near, "--start", "r.json", "--set", "optimize.mpcc.first=branch", "--quiet", "--out",
                      "s.json", code=0)
        result = json.loads((self.folder / "s.json").read_text(encoding="utf-8"))
        self.assertEqual(result["homotopy"][0]["message"], "sides of the start")
        self.assertNotIn("relaxed", {step["phase"] for step in result["homotopy"]})

    def test_the_closed_loop_goes_through_an_impact(self):
        result = self.optimised(LANDING.replace("horizon", "closed_loop = true\nhorizon"))
        closed_loop = result["verification"]["closed_loop"]
        self.assertEqual(closed_loop["termination"], "completed")
        self.assertLess(closed_loop["end_state_error"], 1e-3)
        self.assertAlmostEqual(closed_loop["x"][-1][0], 0.0, delta=1e-9)


if __name__ == "__main__":
    tool.main()
