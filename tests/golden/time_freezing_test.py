"""Contacts where time stands still: the method fesd. Event-driven runs are the truth."""

import json
import math

import contacts_test
import tool

HEAD = "[model]\nname = 'm'\n"

BALL = contacts_test.BALL.replace("\"mu\"", "0.3") + "output = { times = [0.25, 1.0], events = true }\n"

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

# A body at a wall that it bounces off, and on the ground where it stays.
MIXED = HEAD + """[states]
x = 0.8
y = 0.5
vx = -1.5
vy = -1
[mechanics]
positions = ["x", "y"]
velocities = ["vx", "vy"]
mass = [[2, 0.5], [0.5, 1]]
force = { vx = -1, vy = -2 }
[[contacts]]
name = "wall"
gap = "x"
restitution = 0.5
[[contacts]]
name = "ground"
gap = "y"
[simulate]
until = 0.9
"""

RESTING = MIXED.replace("x = 0.8", "x = 0").replace("y = 0.5", "y = 0").replace("vx = -1.5", "vx = 0")
RESTING = RESTING.replace("vy = -1\n", "vy = 0\n").replace("restitution = 0.5\n", "")

# A block slides to rest while a heater switches.
HEATED = HEAD + """[states]
z = 0
v = 0
y = 0
w = 2
T = 15
[dynamics]
T = "if(on > 0.5, 8, -5)"
[[hysteresis]]
name = "on"
input = "T"
on = 14.5
off = 16
[mechanics]
positions = ["z", "y"]
velocities = ["v", "w"]
force = { v = -9.81 }
[[contacts]]
name = "ground"
gap = "z"
tangent = { y = 1 }
friction = 0.3
[simulate]
until = 1
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


class FrozenTest(tool.ToolTest):
    def simulated(self, model, method, *more):
        file = self.write("m.toml", model) if "\n" in model else model
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
        found = set()
        for rows in ("auto", "steps", "{ points = 2 }", "{ every = 0.01 }"):
            self.run_tool("simulate", "falling-rod", "--method", "fesd", "--set", f"simulate.output={rows}", "--set",
                          "simulate.max_steps=70", "--quiet", "--out", "r.events.csv", "--out", "r.json", code=3)
            final = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["final"]
            found.add((json.dumps(final), (self.folder / "r.events.csv").read_text(encoding="utf-8")))
        self.assertEqual(len(found), 1)
        self.run_tool("report", "r.json", code=0)

    def test_a_rod_is_thrown_up(self):
        self.assert_agree("painleve-rod", 1e-8)

    def test_several_contacts_in_stewarts_form(self):
        # Held while one with restitution closes and masses couple them; both at rest from the start; a corner; one at
        # rest beside a hysteresis.
        for model in (MIXED, RESTING, "inelastic-corner", HEATED):
            event, frozen = self.assert_agree(model, 1e-8, "--set", "simulate.fesd.reformulation=stewart")
            self.assertEqual(*([e["unique"] for e in run["events"]] for run in (event, frozen)))

    def test_where_time_stands_still_there_are_no_forces(self):
        for output in ("auto", "{ every = 0.001 }"):
            self.run_tool("simulate", "falling-rod", "--method", "fesd", "--set", f"simulate.output={output}", "--quiet",
                          "--out", "r.json", code=0)
            result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
            forces = [k for k, name in enumerate(result["outputs"]) if name.startswith(("force", "friction"))]
            self.assertEqual(len(forces), 4)
            self.assertLess(max(abs(row[k]) for row in result["trajectory"]["outputs"] for k in forces), 1e6, output)

    def test_forces_in_the_form_of_stewart_are_those_of_regions(self):
        """Thrown up a slope with friction 0.4 a block turns: m g cos(0.6), 0.4 of it against the slip on either way."""
        block = HEAD + """[states]
x = 0
z = 0
vx = "-3*cos(0.6)"
vz = "3*sin(0.6)"
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
potential = "9.81*z"
[[contacts]]
name = "slope"
gap = "z*cos(0.6) + x*sin(0.6)"
tangent = { x = "cos(0.6)", z = "-sin(0.6)" }
friction = 0.4
[simulate]
until = 1.2
"""
        force = 9.81 * math.cos(0.6)
        for form in ("stewart", "step"):
            frozen = self.simulated(block, "fesd", "--set", f"simulate.fesd.reformulation={form}")
            (turn,) = frozen["events"]
            columns = [frozen["outputs"].index(name) for name in ("force(slope)", "friction(slope)")]
            for t, row in zip(frozen["trajectory"]["t"], frozen["trajectory"]["outputs"]):
                if t == turn["t"]:
                    continue
                self.assertAlmostEqual(row[columns[0]], force, delta=1e-9)
                self.assertAlmostEqual(row[columns[1]], 0.4 * force * (1 if t < turn["t"] else -1), delta=1e-9)

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

    def test_what_is_unique_beside_a_contact_at_rest(self):
        # A relay slides from 0.1 on, until its field turns at 0.5: then it leaves to either side.
        relay = LANDING[:LANDING.index("[controls]")] + "r = 0.1\n[dynamics]\nr = 'if(t < 0.5, -1, 1)*sign(r)'\n"
        relay += LANDING[LANDING.index("[mechanics]"):LANDING.index("[optimize]")].replace("u - 9.81", "-9.81")
        relay = relay.replace("z = 0.5", "z = 0") + "[simulate]\nuntil = 0.6\n"
        for form in ("step", "stewart"):
            frozen = self.simulated(relay, "fesd", "--set", f"simulate.fesd.reformulation={form}")
            self.assertEqual([e["surfaces"] for e in frozen["events"]], [["r"], ["0.5-t"]])
            self.assertEqual([e["unique"] for e in frozen["events"]], [True, False])
            self.assertEqual([len(e["alternatives"]) for e in frozen["events"]], [0, 2])
            for event, t in zip(frozen["events"], (0.1, 0.5)):
                self.assertAlmostEqual(event["t"], t, delta=1e-9)

    def test_an_impact_ends_whatever_force_and_steps_are(self):
        landing = LANDING[:LANDING.index("[optimize]")] + "[simulate]\nuntil = 0.6\n"
        for force in tool.some((1, 9.81, 100), 1):
            for steps in (10, 20, 40, 100):
                model = landing.replace("a_n = 20", f"a_n = {force}").replace("u - 9.81", "-9.81")
                frozen = self.simulated(model, "fesd", "--set", f"simulate.fesd.steps={steps}")
                self.assertAlmostEqual(frozen["events"][0]["t"], math.sqrt(1 / 9.81), delta=1e-9)
                self.assertEqual([e["kind"] for e in frozen["events"]], ["impact"])
                self.assertEqual(frozen["final"]["contact_modes"], ["closed"])

    def test_impulses_of_a_rod(self):
        # Its gaps are curved, and stand still at zero where their ends slip, stick and turn.
        for steps in tool.some((100, 300), 1):
            options = ("--set", "simulate.fesd.stages=3", "--set", f"simulate.fesd.steps={steps}")
            found = []
            for method, more in (("event", ()), ("fesd", options)):
                self.run_tool("simulate", "falling-rod", "--method", method, "--until", "0.49", "--quiet", "--out",
                              "r.json", *more, code=0)
                events = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["events"]
                self.assertEqual([e["kind"] for e in events], ["impact", "slip", "impact"])
                found.append([normal for e in events[::2] for normal, _ in e["impulse"]])
            for expected, impulse in zip(*found):
                self.assertAlmostEqual(expected, impulse, delta=1e-7)

    def test_restitution_holds_with_any_mass_and_gap(self):
        _, frozen = self.assert_agree(BOWL, 1e-8, "--set", "simulate.fesd.stages=3")
        hit = frozen["events"][0]
        normal = lambda x: x[3] - x[0] / 2 * x[2]
        self.assertAlmostEqual(normal(hit["x_after"]), -0.7 * normal(hit["x"]), delta=1e-9)

    def test_bounces_are_exact(self):
        """Flights are parabolas, and so are depths: two stages have no error, whatever force and restitution are."""
        for restitution in tool.some((0.1, 0.6, 1.0), 1):
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
        for stages, steps in tool.some(((2, 100), (3, 50), (3, 400), (4, 100), (4, 200), (5, 60)), 2):
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

    def test_numbers_are_looked_at_whatever_the_method_is(self):
        for number, key in (("a_n = 'x'", "a_n"), ("speed = { lower = 'x', upper = 2 }", "speed.lower"),
                            ("speed = { lower = 1, upper = 'x' }", "speed.upper")):
            file = self.write("bad.toml", BALL.replace("[simulate]", f"[time_freezing]\n{number}\n[simulate]"))
            for command in ("check", "simulate"):
                self.assertIn(f"{key} must be a constant, found 'x'", self.run_tool(command, file, code=2)[1])

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
            (("[simulate]", "[time_freezing]\na_n = 'x'\n[simulate]"), "a_n must be a constant, found 'x'"),
            (("[simulate]", "[[hysteresis]]\nname = 'h'\ninput = 'x'\non = 2\noff = 1\n[time_freezing]\nstabilisation = 'h'\n"
              "[simulate]"), "stabilisation must be a constant, found 'h'"),
            (("[simulate]", "[time_freezing]\nclock = 'x'\n[simulate]"), "`clock` beside [[contacts]]"),
            (('gap = "z"', 'gap = "z - 0.1*t"'), "the gap of 'ground' depends on t, and time stands still"),
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


if __name__ == "__main__":
    tool.main()
