"""[mechanics] and [[contacts]] from outside: closed forms, the members of the result, and malformed models."""

import json
import math
import pathlib

import tool

BALL = """[model]
name = "ball"
[parameters]
mu = 0.3
[states]
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
friction = "mu"
[simulate]
until = 2
"""

SPACE = """[model]
name = "ball in space"
[states]
x = 0
y = 0
z = 1
vx = 3
vy = 4
vz = 0
[mechanics]
positions = ["x", "y", "z"]
velocities = ["vx", "vy", "vz"]
potential = "10*z"
[[contacts]]
name = "ground"
gap = "z"
tangents = [{ x = 1 }, { y = 1 }]
friction = 0.3
[simulate]
until = 3
"""

PENDULUM = """[model]
name = "double pendulum"
[states]
a = 0.5
b = -0.3
va = 1
vb = -2
[definitions]
c = "cos(a - b)"
[mechanics]
positions = ["a", "b"]
velocities = ["va", "vb"]
mass = [[2, "c"], ["c", 1]]
coriolis = "auto"
potential = "-19.62*cos(a) - 9.81*cos(b)"
[simulate]
until = 2
rtol = 1e-11
atol = 1e-12
"""

# A ball in a corner of two planes; it loses 72 % of its speed at every passage.
CORNER = """[model]
name = "corner"
[parameters]
s = 0
[states]
x = "0.1 + s"
z = "1 + s"
vx = 0
vz = 0
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
potential = "9.81*z"
[[contacts]]
name = "right"
gap = "0.8*(z - s) - 0.6*(x - s)"
[[contacts]]
name = "left"
gap = "0.8*(z - s) + 0.6*(x - s)"
[simulate]
until = 2
max_events = 200
"""

# A box with friction and restitution at its corners, thrown.
BOX = """[model]
name = "box"
[states]
x = 0
z = 2
th = 0.3
vx = 2
vz = 0
w = -3
[mechanics]
positions = ["x", "z", "th"]
velocities = ["vx", "vz", "w"]
mass = [[1, 0, 0], [0, 1, 0], [0, 0, "1/6"]]
potential = "9.81*z"
[simulate]
until = 5
max_events = 2000
""" + "".join(f"""[[contacts]]
name = "{name}"
gap = "z + 0.5*({side}*sin(th) + {height}*cos(th))"
tangent = {{ x = 1, th = "-0.5*({side}*sin(th) + {height}*cos(th))" }}
friction = 0.5
restitution = 0.3
""" for name, side, height in (("a", 1, 1), ("b", -1, 1), ("c", 1, -1), ("d", -1, -1)))

# name: (old, new, line, expected parts of the message…)
MALFORMED = {
    "unknown position": ('["x", "z"]', '["x", "y"]', 11, "found 'y'"),
    "velocity without its position": ('positions = ["x", "z"]', 'positions = ["z"]', 12, "the velocity 'vz' has no position"),
    "position without its velocity": ('velocities = ["vx", "vz"]', 'velocities = ["vx"]', 11,
                                      "the position 'z' has no velocity"),
    "listed twice": ('velocities = ["vx", "vz"]', 'velocities = ["vx", "x"]', 12, "'x' is listed twice"),
    "no positions": ('positions = ["x", "z"]\n', "", 10, "no `positions`"),
    "mass of wrong size": ('potential = "10*z"', 'mass = [[1, 0]]', 13, "1 rows, and there are 2 velocities"),
    "mass with a short row": ('potential = "10*z"', 'mass = [[1, 0], [1]]', 13, "row 2 of the mass matrix has 1 entries"),
    "mass not symmetric": ('potential = "10*z"', 'mass = [[1, 0.5], [0.4, 1]]', 13, "not symmetric", "0.4", "0.5"),
    "mass not symmetric later": ('potential = "10*z"', 'mass = [[1, "x"], [0, 1]]', 13, "not symmetric", "near the start"),
    "mass singular": ('potential = "10*z"', 'mass = [[1, 1], [1, 1]]', 13, "not positive definite", "row 2 ('vz')"),
    "mass of a velocity": ('potential = "10*z"', 'mass = [["1 + vx^2", 0], [0, 1]]', 13, "depends on 'vx'"),
    "potential of time": ('"10*z"', '"10*z*t"', 13, "depends on 't'"),
    "force on a position": ('potential = "10*z"', 'force = { x = 1 }', 13, "a force on 'x'", "'vx'"),
    "coriolis misspelt": ('potential = "10*z"', 'coriolis = "automatic"', 13, '"auto"'),
    "key misspelt": ('potential = "10*z"', 'potentail = "10*z"', 13, "did you mean 'potential'"),
    "drawn disc without radius": ('potential = "10*z"', 'draw = [{ point = ["x", "z"] }]', 13, "a line or a disc"),
    "drawn line with a radius": ('potential = "10*z"', 'draw = [{ line = [["x", "z"], [0, 0]], radius = 1 }]', 13,
                                 "a line or a disc"),
    "drawn line of one point": ('potential = "10*z"', 'draw = [{ line = [["x", "z"]] }]', 13, "a line or a disc"),
    "drawn line and point": ('potential = "10*z"', 'draw = [{ line = [["x", "z"], [0, 0]], point = [0, 0] }]', 13,
                             "a line or a disc"),
    "drawn in space": ('potential = "10*z"', 'draw = [{ point = ["x", 0, "z"], radius = 1 }]', 13, "two coordinates"),
    "drawn at a number": ('potential = "10*z"', 'draw = [{ point = 3, radius = 1 }]', 13, "a point of the plane"),
    "drawn line of names": ('potential = "10*z"', 'draw = [{ line = ["x", "z"] }]', 13, "a point of the plane"),
    "drawn key misspelt": ('potential = "10*z"', 'draw = [{ pint = ["x", "z"], radius = 1 }]', 13, "did you mean 'point'"),
    "drawn with a velocity": ('potential = "10*z"', 'draw = [{ point = ["vx", "z"], radius = 1 }]', 13,
                              "what is drawn depends on 'vx'"),
    "drawn with time": ('potential = "10*z"', 'draw = [{ point = ["x", "z"], radius = "1 + t" }]', 13,
                        "the radius of what is drawn depends on 't'"),
    "drawn with a name unknown": ('potential = "10*z"', 'draw = [{ point = ["x", "y"], radius = 1 }]', 13, "'y'", "in draw"),
    "drawn disc too small": ('potential = "10*z"', 'draw = [{ point = ["x", "z"], radius = "z - 1" }]', 13,
                             "the radius of a disc that is drawn is 0 at the start"),
    "drawn by no list": ('potential = "10*z"', 'draw = { point = ["x", "z"], radius = 1 }', 13, "a list of"),
    "dynamics of a position": ("[mechanics]", "[dynamics]\nx = 'vx'\n[mechanics]", 11, "'x' is a position of [mechanics]"),
    "dynamics of a velocity": ("[mechanics]", "[dynamics]\nvz = '-10'\n[mechanics]", 11, "'vz' is a velocity of [mechanics]"),
    "gap without positions": ('gap = "z"', 'gap = "mu"', 16, "no position in it"),
    "gap of a velocity": ('gap = "z"', 'gap = "z + vz"', 16, "depends on 'vz'"),
    "gap negative": ('gap = "z"', 'gap = "z - 2"', 16, "is -1 at the start"),
    "no gap": ('gap = "z"\n', "", 15, "no `gap`"),
    "no name": ('name = "ground"\n', "", 14, "no `name`"),
    "tangent over velocities": ("{ x = 1 }", "{ vx = 1 }", 17, "no position", "the position whose rate this velocity is"),
    "tangent of a velocity": ("{ x = 1 }", '{ x = "1 + vx" }', 17, "the tangent of 'ground' depends on 'vx'"),
    "jump where the gap closes": ("[simulate]", '[[jumps]]\nname = "b"\nwhen = "z < 0"\nset = { vz = "-vz" }\n[simulate]', 21,
                                  "where the gap of the contact 'ground' closes", "leave one of them out"),
    "jump where a multiple of the gap closes": ("[simulate]", '[[jumps]]\nname = "b"\nwhen = "0.2 - 2*z > 0.2 and vz < 0"\n'
                                                'set = { vz = "-vz" }\n[simulate]', 21,
                                                "where the gap of the contact 'ground' closes"),
    "friction without tangent": ("tangent = { x = 1 }\n", "", 17, "friction and no `tangent`"),
    "three tangents": ("tangent = { x = 1 }", "tangents = [{ x = 1 }, { x = 1 }, { z = 1 }]", 17, "has 3 tangents"),
    "tangent beside tangents": ("tangent = { x = 1 }", "tangent = { x = 1 }\ntangents = [{ x = 1 }]", 18,
                                "`tangent` and `tangents` beside each other"),
    "gap in an expression": ("[simulate]", "[outputs]\ny = 'gap(ground)'\n[simulate]", 20, "contacts by themselves"),
    "tangents in one direction": ("tangent = { x = 1 }", "tangents = [{ x = 1 }, { x = 2 }]", 17, "have one direction"),
    "tangents whose plane has the normal": ("tangent = { x = 1 }", "tangents = [{ x = 1 }, { x = 1, z = 1 }]", 17,
                                            "the plane of the tangents of 'ground' has the direction in which its gap opens"),
    "friction negative": ('friction = "mu"', "friction = -1", 18, "friction of 'ground' is -1"),
    "friction of a state": ('friction = "mu"', 'friction = "1 + vx"', 18, "the friction of 'ground' depends on 'vx'"),
    "friction negative at the start": ('friction = "mu"', 'friction = "-z"', 18, "friction of 'ground' is -1 at the start"),
    "restitution": ('friction = "mu"', "restitution = 1.5", 18, "restitution of 'ground' is 1.5", "[0, 1]"),
    "name twice": ("[simulate]", '[[contacts]]\nname = "ground"\ngap = "z"\n[simulate]', 20, "already a contact"),
    "contact key misspelt": ('friction = "mu"', 'fricton = "mu"', 18, "did you mean 'friction'"),
    "contacts without mechanics": ('[mechanics]\npositions = ["x", "z"]\nvelocities = ["vx", "vz"]\npotential = "10*z"\n',
                                   "[dynamics]\nx = 'vx'\nz = 'vz'\nvx = 0\nvz = -10\n", 16, "without [mechanics]"),
}


class Contacts(tool.ResultTest):
    def test_the_energy_has_a_column_unless_its_name_is_taken(self):
        for change in ("[outputs]\nenergy = \"0.5*(vx^2 + vz^2) + 10*z - 1\"\n[simulate]", None):
            result = self.result(BALL if change is None else BALL.replace("[simulate]", change))
            self.assertEqual(result["outputs"].count("energy"), 1)
            energy = result["trajectory"]["outputs"][0][result["outputs"].index("energy")]
            self.assertAlmostEqual(energy, 18.0 - (change is not None), delta=1e-12)

    def test_a_ball_lands_slides_and_stops(self):
        result = self.result(BALL, "--rtol", "1e-11", "--atol", "1e-13")
        self.assertEqual(result["states"], ["x", "z", "vx", "vz"])
        self.assertEqual(list(result["model"]["initial_state"]), result["states"])
        self.assertEqual(result["contacts"], ["ground"])
        self.assertEqual(result["outputs"], ["gap(ground)", "force(ground)", "friction(ground)", "impulse(ground)", "energy"])
        impact, stick = result["events"]
        self.assertEqual((impact["kind"], stick["kind"]), ("impact", "stick"))
        self.assertEqual(impact["surfaces"], ["ground"])
        self.assertAlmostEqual(impact["t"], math.sqrt(0.2), delta=1e-10)
        speed = 4 - 0.3 * math.sqrt(20)
        self.assertAlmostEqual(impact["x_after"][2], speed, delta=1e-10)
        self.assertAlmostEqual(impact["impulse"][0][0], math.sqrt(20), delta=1e-9)
        self.assertAlmostEqual(impact["impulse"][0][1], -0.3 * math.sqrt(20), delta=1e-9)
        self.assertEqual(impact["contact_modes_before"], ["open"])
        self.assertEqual(impact["contact_modes_after"], ["slip"])
        self.assertAlmostEqual(stick["t"] - impact["t"], speed / 3, delta=1e-9)
        self.assertEqual(stick["contact_modes_after"], ["stick"])
        self.assertEqual(result["final"]["contact_modes"], ["stick"])
        self.assertEqual(result["final"]["x"][2], 0.0)
        rows = result["trajectory"]
        self.assertEqual(len(rows["contact_modes"]), len(rows["t"]))
        self.assertGreaterEqual(min(outputs[0] for outputs in rows["outputs"]), -1e-12)
        energy = [outputs[4] for outputs in rows["outputs"]]
        self.assertTrue(all(b <= a + 1e-9 for a, b in zip(energy, energy[1:])))
        self.run_tool("report", "r.json", "--out", "r.html", code=0)

    def test_friction_in_a_plane(self):
        result = self.result(SPACE, "--rtol", "1e-11", "--atol", "1e-13")
        self.assertEqual(result["outputs"], ["gap(ground)", "force(ground)", "friction(ground)[1]", "friction(ground)[2]",
                                             "impulse(ground)", "energy"])
        impact, stick = result["events"]
        self.assertEqual((impact["kind"], stick["kind"]), ("impact", "stick"))
        speed = 5 - 0.3 * math.sqrt(20)
        for k, part in ((3, 0.6), (4, 0.8)):
            self.assertAlmostEqual(impact["x_after"][k], part * speed, delta=1e-9)
            self.assertAlmostEqual(impact["impulse"][0][k - 2], -part * 0.3 * math.sqrt(20), delta=1e-9)
        self.assertAlmostEqual(stick["t"] - impact["t"], speed / 3, delta=1e-9)
        self.assertEqual(result["final"]["x"][3:], [0.0, 0.0, 0.0])
        self.run_tool("report", "r.json", "--out", "r.html", code=0)
        # Frozen, the contact sticks up to the speed eps_t, which is what the end of the slip is off by.
        for eps_t in ("1e-4", "1e-6"):
            frozen = self.result(SPACE + f"[time_freezing]\na_n = 20\neps_t = {eps_t}\n", "--method", "fesd",
                                 "--set", "simulate.fesd.steps=40")
            self.assertEqual([event["kind"] for event in frozen["events"]], ["impact", "stick"])
            for k in range(3):
                self.assertAlmostEqual(frozen["events"][0]["impulse"][0][k], impact["impulse"][0][k], delta=1e-8)
                self.assertAlmostEqual(frozen["final"]["x"][k], result["final"]["x"][k], delta=2 * float(eps_t))
            self.assertLess(math.hypot(*frozen["final"]["x"][3:5]), 1.01 * float(eps_t))
            self.assertEqual(frozen["final"]["contact_modes"], ["stick"])

    def test_a_block_pushed_sideways_on_an_incline(self):
        block = (tool.SOURCE / "examples/contacts/block-on-incline.toml").read_text(encoding="utf-8")
        for integrator in ("dopri5", "radau5"):
            result = self.result(block, "--rtol", "1e-11", "--atol", "1e-13", "--integrator", integrator)
            (stick,) = result["events"]
            self.assertEqual(stick["kind"], "stick")
            self.assertAlmostEqual(stick["t"], 0.6914766235042755, delta=1e-9)
            friction = result["trajectory"]["outputs"][-1][2:4]
            self.assertAlmostEqual(friction[0], -9.81 * math.sin(0.3), delta=1e-9)
            self.assertAlmostEqual(friction[1], 0.0, delta=1e-9)

    def test_a_growing_pull_breaks_a_block_away_in_few_steps(self):
        """Pulled by 5 t against a friction of 5 it moves from t = 1 on like (t - 1)^3 5/6, with a direction at each speed."""
        written = "[model]\nname = 'm'\n[states]\nx = 0\ny = 0\nvx = 0\nvy = 0\n[dynamics]\nx = 'vx'\ny = 'vy'\n" \
            "vx = '3*t - 5*vx/hypot(vx, vy)'\nvy = '4*t - 5*vy/hypot(vx, vy)'\n[simulate]\nuntil = 2\n"
        pulled = SPACE.replace("z = 1", "z = 0").replace("vx = 3", "vx = 0").replace("vy = 4", "vy = 0").replace(
            'potential = "10*z"', 'potential = "10*z"\nforce = { vx = "3*t", vy = "4*t" }').replace(
            "friction = 0.3", "friction = 0.5").replace("until = 3", "until = 2")
        for name, model, velocity in (("written", written, 2), ("pulled", pulled, 3)):
            for integrator in ("dopri5", "dop853", "taylor", "radau5"):
                with self.subTest(model=name, integrator=integrator):
                    result = self.result(model, "--integrator", integrator, "--set", "simulate.max_steps=1000")
                    self.assertEqual(result["events"][-1]["kind"], "slip")
                    self.assertAlmostEqual(result["events"][-1]["t"], 1, delta=1e-9)
                    x = result["final"]["x"]
                    for value, expected in zip(x[:2] + x[velocity:velocity + 2], (0.5, 2 / 3, 1.5, 2)):
                        self.assertAlmostEqual(value, expected, delta=1e-8)

    def test_what_is_drawn_lies_at_every_row(self):
        drawn = BALL.replace('potential = "10*z"', 'potential = "10*z"\ndraw = [{ line = [[-1, 0], [5, 0]] }, '
                             '{ point = ["x", "z + mu"], radius = "mu" }]')
        for arguments in ((), ("--method", "fesd")):
            result = self.result(drawn.replace('friction = "mu"', "friction = 0.3"), *arguments)
            self.assertEqual(result["drawing"]["shapes"], [{"kind": "line", "points": 2}, {"kind": "disc", "points": 1}])
            self.assertEqual(result["drawing"]["rows"],
                             [[-1, 0, 5, 0, x[0], x[1] + 0.3, 0.3] for x in result["trajectory"]["x"]])
            out = self.run_tool("report", "r.json", "--out", "r.html", code=0)
            self.assertNotIn("warning", "".join(out))
        stored = self.folder / "r.json"
        result["drawing"]["rows"][3].pop()
        stored.write_text(json.dumps(result), encoding="utf-8")
        _, err = self.run_tool("report", "r.json", "--out", "r.html", code=2)
        self.assertIn("/drawing/rows/3", err)
        self.assertNotIn("drawing", self.result(BALL))

    def test_how_deep_bodies_are_in_each_other_is_told(self):
        self.assertLess(self.result(BALL)["penetration"], 1e-12)
        frozen = self.result(BALL.replace('"mu"', "0.3"), "--method", "fesd", "--set", "simulate.fesd.steps=20")
        gaps = [outputs[0] for outputs in frozen["trajectory"]["outputs"]]
        self.assertAlmostEqual(frozen["penetration"], max(0.0, -min(gaps)), delta=1e-14)

    def test_a_body_that_is_pulled_up_again_and_again_leaves_each_time(self):
        """The force that presses it vanishes where its terms cancel: lift-off is where 20 sin(3 t) = 9.81."""
        pulled = """[model]
name = "pulled up"
[states]
z = 0
vz = 0
[mechanics]
positions = ["z"]
velocities = ["vz"]
potential = "9.81*z"
force = { vz = "20*sin(3*t)" }
[[contacts]]
name = "table"
gap = "z"
restitution = 0
[simulate]
until = 9
"""
        first = math.asin(9.81 / 20) / 3
        for integrator in ("dopri5", "dop853", "radau5", "taylor"):
            events = self.result(pulled, "--integrator", integrator)["events"]
            self.assertEqual([event["kind"] for event in events], 4 * ["lift_off", "impact"] + ["lift_off"])
            for k, event in enumerate(events[::2]):
                self.assertAlmostEqual(event["t"], first + k * 2 * math.pi / 3, delta=1e-9)

    def test_bounces_on_what_friction_holds_end_in_one_accumulation(self):
        def run(hammer, pile, height, pull, friction):
            result = self.result(f"""[model]
name = "pile"
[states]
h = {height}
p = 0
vh = 0
vp = 0
[mechanics]
positions = ["h", "p"]
velocities = ["vh", "vp"]
mass = [["{hammer}", "0"], ["0", "{pile}"]]
potential = "9.81*({hammer}*h + {pile}*p)"
force = {{ vh = "{pull}*{hammer}*9.81", vp = "{friction}" }}
[[contacts]]
name = "hit"
gap = "h - p"
restitution = 0.5
[simulate]
until = 2.5
""", "--integrator", "dop853")
            force = [row[result["outputs"].index("force(hit)")] for row in result["trajectory"]["outputs"]]
            kinds = [event["kind"] for event in result["events"]]
            first = kinds.index("accumulation")
            self.assertGreaterEqual(min(force), 0)
            self.assertEqual(result["events"][first]["mode_after"][-1:], [0])  # the pile stands
            return result["events"][first], kinds[first + 1:], max(force)

        limit, behind, force = run(1.843, 2.166, 0.313, "if(mod(t, 1.019) < 0.509, 1.257, 0)", "-76.80429*sign(vp)")
        self.assertAlmostEqual(limit["t"], 1.8133559, delta=1e-7)
        self.assertEqual((limit["contact_modes_after"], behind), (["closed"], ["lift_off"]))
        self.assertAlmostEqual(force, 1.843 * 9.81, delta=1e-9)
        # Pulled up where the bounces end, the hammer leaves the pile at once.
        limit, behind, _ = run(1.781, 1.032, 0.468, "if(mod(t, 1.095) < 0.547, 1.357, 0)", "-51.31453*sign(vp) - 3*vp")
        self.assertAlmostEqual(limit["t"], 1.3887742, delta=1e-7)
        self.assertEqual((limit["contact_modes_after"], behind[0]), (["open"], "impact"))

    def test_tangents_that_no_body_slips_along(self):
        for row, words in (("{ x = 0 }", "is 0 at the start"), ("{ z = 1 }", "the direction in which its gap opens"),
                           ("{ z = -2 }", "the direction in which its gap opens")):
            text = BALL.replace("tangent = { x = 1 }", f"tangent = {row}")
            self.assertNotEqual(text, BALL)
            (self.folder / "m.toml").write_text(text, encoding="utf-8")
            _, err = self.run_tool("simulate", "m.toml", code=2)
            self.assertIn(words, err)
        # One that depends on t is looked at where the run begins.
        turning = BALL.replace("tangent = { x = 1 }", 'tangent = { x = "t - 1" }').replace("until = 2", "from = FROM\nuntil = 3")
        (self.folder / "m.toml").write_text(turning.replace("FROM", "1"), encoding="utf-8")
        for command in ("simulate", "check"):
            _, err = self.run_tool(command, "m.toml", code=2)
            self.assertRegex(err, r"^m.toml:\d+:.* the tangent of 'ground' is 0 at the start, t = 1\n")
        late = turning.replace('"t - 1"', '"t"').replace("FROM", "2").replace("until = 3", "until = 4")
        self.assertEqual(self.result(late)["events"][0]["kind"], "impact")  # at t = 0 it would be 0

    def test_a_gap_without_a_value(self):
        for gap in ("sqrt(z - 2)", "sqrt(z - 2 + 0*t)"):
            (self.folder / "m.toml").write_text(BALL.replace('gap = "z"', f'gap = "{gap}"'), encoding="utf-8")
            _, err = self.run_tool("simulate", "m.toml", code=2)
            self.assertIn("the gap of 'ground' is not a number at the start", err)
            self.assertIn("change them, or the expression", err)

    def test_gaps_that_depend_on_time_are_looked_at_where_the_run_begins(self):
        pad = BALL.replace('gap = "z"', 'gap = "z - 0.2*cos(t)"').replace("z = 1", "z = 0.05")
        self.assertEqual(pad.count("0.05") + pad.count("cos"), 2)
        late = pad.replace("until = 2", "from = 2\nuntil = 9")
        result = self.result(late, "--until", "3")  # at t = 0 the ball would be in the pad
        self.assertAlmostEqual(result["trajectory"]["outputs"][0][0], 0.05 - 0.2 * math.cos(2), delta=1e-12)
        self.assertEqual(result["events"][0]["kind"], "impact")
        for text, start in ((pad, 0), (late.replace("from = 2", "from = 6"), 6)):
            (self.folder / "m.toml").write_text(text, encoding="utf-8")
            for command in ("simulate", "check"):
                _, err = self.run_tool(command, "m.toml", code=2)
                self.assertRegex(err, rf"^m.toml:16:.* the gap of 'ground' is -0.1\d+ at the start, t = {start}\n")

    def test_check_says_how_bodies_move_and_touch(self):
        (self.folder / "m.toml").write_text(BALL, encoding="utf-8")
        out, _ = self.run_tool("check", "m.toml", code=0)
        self.assertIn("vz' = -d(10*z)/dz", out)
        self.assertIn("contacts (1)", out)
        self.assertIn("ground: gap z, tangent { x = 1 }, friction mu, restitution 0", out)

    def test_a_slip_that_turns_around_is_told(self):
        """Times of a Taylor series of degree 40 that shares nothing with the engine."""
        rod = (pathlib.Path(__file__).parents[2] / "models/falling-rod.toml").read_text(encoding="utf-8")
        events = self.result(rod, "--rtol", "1e-11", "--atol", "1e-13")["events"]
        self.assertEqual([event["kind"] for event in events], ["impact", "slip", "impact"])
        for event, t in zip(events, (0.382512420645, 0.46016542057, 0.484412978857)):
            self.assertAlmostEqual(event["t"], t, delta=1e-9)

    def test_coriolis_terms_keep_the_energy(self):
        result = self.result(PENDULUM)
        energy = [outputs[0] for outputs in result["trajectory"]["outputs"]]
        self.assertEqual(result["outputs"], ["energy"])
        self.assertLess(max(energy) - min(energy), 1e-8)

    def test_check_tells_the_contacts(self):
        out, _ = self.run_tool("check", self.write("m.toml", BALL), code=0)
        self.assertNotIn("ground.", out)  # modes are no states of the user

    def test_a_wedge_holds_what_falls_into_it(self):
        """Its friction is not unique: what rests does not slip at the edge of a cone. Work that it holds back stays."""
        for half, friction, bounce, sideways in ((0.1, 0.5, 0, 0), (0.3, 0.2, 0, 0), (0.3, 1.5, 0.5, 1)):
            n, t = math.cos(half), math.sin(half)
            walls = "".join(f"""[[contacts]]
name = "{name}"
gap = "{side * n}*x + {t}*z"
tangent = {{ x = {-t * side}, z = {n} }}
friction = {friction}
restitution = {bounce}
""" for name, side in (("left", 1), ("right", -1)))
            model = f"""[model]
name = 'wedge'
[states]
x = 0
z = 1
vx = {sideways}
vz = 0
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
force = {{ vz = -9.81 }}
{walls}[simulate]
until = 3
"""
            result = self.result(model)
            self.assertEqual(result["final"]["contact_modes"], ["stick", "stick"])
            self.assertEqual({e["kind"] for e in result["events"]}, {"impact"})
            self.assertLess(max(map(abs, result["final"]["x"])), 1e-9)

    def test_time_stepping_says_no(self):
        _, err = self.run_tool("simulate", self.write("m.toml", BALL), "--method", "timestepping", code=2)
        self.assertIn("does not cover contacts", err)

    def test_a_ball_comes_to_rest_in_a_corner_wherever_that_is(self):
        for shift in (0, 1, -300):
            result = self.result(CORNER, "--set", f"s={shift}", "--quiet")
            self.assertEqual(result["final"]["contact_modes"], ["closed", "closed"], shift)
            for value, expected in zip(result["final"]["x"], (shift, shift, 0, 0)):
                self.assertAlmostEqual(value, expected, delta=1e-10)
            passages = [event["t"] for event in result["events"][1:]]
            for i in range(4):
                self.assertAlmostEqual((passages[i + 2] - passages[i + 1]) / (passages[i + 1] - passages[i]), 0.28, delta=1e-5)

    def test_a_thrown_box_comes_to_rest(self):
        final = self.result(BOX, "--quiet")["final"]
        self.assertAlmostEqual(final["x"][1], 0.5, delta=1e-9)
        self.assertAlmostEqual(math.remainder(final["x"][2], math.pi / 2), 0, delta=1e-9)
        for speed in final["x"][3:]:
            self.assertAlmostEqual(speed, 0, delta=1e-9)

    def test_malformed(self):
        for number, (name, (old, new, line, *expected)) in enumerate(MALFORMED.items()):
            with self.subTest(name):
                self.assertIn(old, BALL)
                file = self.write(f"m{number}.toml", BALL.replace(old, new, 1))
                out, err = self.run_tool("simulate", file.name, "--out", "s.json", code=2)
                self.assertEqual(out, "")
                first = [text for text in err.splitlines() if "error: " in text][0]
                self.assertTrue(first.startswith(f"m{number}.toml:{line}:"), err)
                _, all_mistakes = self.run_tool("check", file.name, code=2)
                self.assertIn(f"m{number}.toml:{line}:", all_mistakes)
                for part in expected:
                    self.assertIn(part, err)
                    self.assertIn(part, all_mistakes)


if __name__ == "__main__":
    tool.main()
