"""Modes of [[contacts]]: in any units, behind jumps of bodies at rest, and what they hold exactly."""

import math

import contacts_test
import tool

# Comes to its ground with no speed, and is pressed on from there.
TOUCH = """[model]
name = "touch-down"
[states]
z = 1
vz = -2
[mechanics]
positions = ["z"]
velocities = ["vz"]
force = { vz = "if(t < 1, 2, -5)" }
[[contacts]]
name = "ground"
gap = "z"
restitution = 0.5
[simulate]
until = 2
"""

# Lands where three gaps have one normal, and goes on to where a fourth one closes.
ONE_NORMAL = """[model]
name = "gaps with one normal"
[states]
q0 = 0.7878681358938533
q1 = 0.2362221948470239
v0 = 0.7148254430534484
v1 = 1.081754377947367
[mechanics]
positions = ["q0", "q1"]
velocities = ["v0", "v1"]
mass = [[1.1618960320809197, 0.4735680822745595], [0.4735680822745595, 1.098138054189938]]
force = { v0 = -2.383858138071811, v1 = -10.149819798064264 }
""" + "".join(f"""[[contacts]]
name = "c{k}"
gap = "{gap}^2/2"
restitution = {restitution}
""" for k, (gap, restitution) in enumerate((
    ("q0 - 0.08338790961338405*q1", 0.8623275836621129), ("q1 + 0.3360085858433248*q0", 0.0),
    ("q1 + 0.3257571678268575*q0", 0.29610722151376057), ("q1 - 0.03360495632346783*q0", 0.35759119719908483))))

# Comes to rest in a corner of three curved gaps, where slips begin from rest.
CORNER = """[model]
name = "into a corner"
[states]
q0 = 0.8665778228745569
q1 = 1.070685420943468
q2 = 1.2101262323879287
q3 = 0.20885278489384954
v0 = -0.3318091152772426
v1 = 0.9347786804640783
v2 = 1.0206857100291271
v3 = -0.6656960158152447
[mechanics]
positions = ["q0", "q1", "q2", "q3"]
velocities = ["v0", "v1", "v2", "v3"]
mass = [[1.0814581836110562, -0.27636356219233765, -0.41505441271440935, 0.7510932041414248],
        [-0.27636356219233765, 1.8037133484003711, -0.4274080045004332, -0.2262905553411677],
        [-0.41505441271440935, -0.4274080045004332, 1.3935266398845116, -0.3640510135814876],
        [0.7510932041414248, -0.2262905553411677, -0.3640510135814876, 2.3678013985830773]]
force = { v0 = -10.739123809134286, v1 = -7.695388853397256, v2 = -6.989969836156633, v3 = -3.715422712942297 }
""" + "".join(f"""[[contacts]]
name = "{name}"
gap = "{gap}^2/2"
tangent = {{ {along} = 1 }}
friction = {friction}
restitution = {restitution}
""" for name, gap, along, friction, restitution in (
    ("c0", "q3 - 0.0008779569559854705*q0", "q0", 0.6603014930115705, 0.0),
    ("c2", "q2 + 0.30349288389500473*q3", "q3", 1.2660669441940207, 0.0),
    ("c3", "q0 + 0.4565571727427692*q1", "q1", 0.9046277949991803, 0.8542911283714169)))

# Lands on a curved gap while it is held on another one.
BESIDE = """[model]
name = "lands beside"
[states]
q0 = 1.481201676640768
q1 = 0.9767394208190523
v0 = 0.3268784820048434
v1 = 1.1360879237124515
[mechanics]
positions = ["q0", "q1"]
velocities = ["v0", "v1"]
mass = [[1.5369207801504705, 0.11259725018316588], [0.11259725018316588, 2.6343428049006667]]
force = { v0 = -7.865568547885136, v1 = -2.517002886194417 }
[[contacts]]
name = "c0"
gap = "q0 + 0.40727488816257174*q1^2/2"
restitution = 0.2819010352963235
[[contacts]]
name = "c1"
gap = "q1 - 0.43117144379465366*q0^2/2"
tangent = { q0 = 1 }
friction = 0.08698190331458933
[simulate]
until = 3
"""

# Its second row loses its inertia where q = b.
# A ball rolls along a curved ground into a wall: six forces hold three velocities there.
HELD_IN_A_CORNER = """[model]
name = "ball in a corner"
[states]
x = -0.16
y = -0.24
z = 0.32
vx = 0.89
vy = -0.87
vz = -0.2
[mechanics]
positions = ["x", "y", "z"]
velocities = ["vx", "vy", "vz"]
force = { vx = 5.51, vy = "2.4*sin(3.3*t)", vz = -10 }
[[contacts]]
name = "ground"
gap = "z - 0.11*x^2 - 0.18*y^2"
tangents = [{ x = 1, z = "0.24*x" }, { y = 1, z = "0.19*y" }]
friction = 0.17
[[contacts]]
name = "wall"
gap = "0.5 - x + 0.17*z"
tangents = [{ y = 1 }, { z = 1 }]
friction = 0.66
[simulate]
until = 2
"""

DIAGONAL = '[[1, 0], [0, "b - q"]]'
MASS = f"""[model]
name = "mass"
[parameters]
b = 0.7
[states]
q = 0
a = 0
v = 1
w = 0.3
[mechanics]
positions = ["q", "a"]
velocities = ["v", "w"]
mass = {DIAGONAL}
force = {{ w = "FORCE" }}
[simulate]
until = 3
"""

# Bounces of one contact accumulate while two others slip: in the limit all three are at rest.
LIMIT = """[model]
name = "three come to rest"
[states]
q0 = 0
q1 = 0
q2 = 0
q3 = 0
v0 = -0.21767341868334866
v1 = 0.9082304940790829
v2 = -0.3022374403371426
v3 = 0.2921173838467408
[mechanics]
positions = ["q0", "q1", "q2", "q3"]
velocities = ["v0", "v1", "v2", "v3"]
mass = [[0.6334939342403885, 0.5329189521701388, 0.5110203613712322, -0.3010220325567163],
        [0.5329189521701388, 1.316788239917588, 0.7358865464496466, -0.09181789943388338],
        [0.5110203613712322, 0.7358865464496466, 1.2635728936776935, -0.7758058742795614],
        [-0.3010220325567163, -0.09181789943388338, -0.7758058742795614, 1.7166694650376564]]
potential = """ + '"(q0^2 + q1^2 + q2^2 + q3^2)/2 + 0.0662967193507451*q0 + 0.8045999114125195*q1 - 0.8102382431987731*q2 - 0.22224001358585244*q3"' + """
[[contacts]]
name = "c0"
gap = "0.21975415716220087 + 0.1*q0^2 - 0.6422862207734445*q0 + 0.689124476391674*q1 - 0.4703189848349361*q2 + 0.5501996323796665*q3"
restitution = 0.2997479429768589
friction = 0.9666432698325522
tangent = { q0 = -0.2280552627941983, q1 = 0.836813538816175, q2 = 0.0405086535619501, q3 = -0.39622709893576213 }
[[contacts]]
name = "c1"
gap = "0.1887657531213991 + 0.1*q0^2 + 0.9677469353130175*q0 + 0.8651021560760195*q1 - 0.06700162921401032*q2 + 0.15749320603315398*q3"
friction = 0.36335758500695214
tangents = [{ q0 = -0.16749494823058875, q1 = 0.3052903565551075, q2 = -0.5821924047503826, q3 = -0.11966795076323389 },
            { q0 = -0.7208002974921193, q1 = 0.7458843041381535, q2 = 0.3364410429864457, q3 = -0.2775308141288655 }]
[[contacts]]
name = "c3"
gap = "0.3205002507116627 + 0.1*q0^2 - 0.9714470033698948*q0 + 0.06019413247461314*q1 - 0.4917564911093504*q2 - 0.8474494912843089*q3"
friction = 1.2982949493303861
tangent = { q0 = -0.07526105708510311, q1 = -0.12427052751459255, q2 = 0.7803146047027671, q3 = 0.2999061341092746 }
[simulate]
until = 5
"""


BLOCK = """
[model]
name = "a block on a rough plane"
[states]
x = 0
z = 0
vx = 2
vz = 0
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
force = { vz = -10 }
[[contacts]]
name = "ground"
gap = "z"
tangent = { x = 1 }
friction = "0.2 + 0.3*x"
[simulate]
until = 3
"""


class ContactModes(tool.ResultTest):
    def test_friction_may_vary_with_positions(self):
        # x'' + 3 x = -2 until it stops.
        result = self.result(BLOCK)
        stick, = (event for event in result["events"] if event["kind"] == "stick")
        root = math.sqrt(3.0)
        stop = math.atan(2.0 / (root * (2.0 / 3.0))) / root
        self.assertAlmostEqual(stick["t"], stop, delta=1e-8)
        x = math.hypot(2.0 / 3.0, 2.0 / root) - 2.0 / 3.0
        self.assertAlmostEqual(result["final"]["x"][0], x, delta=1e-8)

    def test_friction_may_vary_with_time(self):
        # It holds 1 until (0.5 - 0.1 t) 10 = 1; from there on v' = t - 4.
        text = BLOCK.replace("vx = 2", "vx = 0").replace("vz = -10 }", "vz = -10, vx = 1 }")
        text = text.replace("0.2 + 0.3*x", "0.5 - 0.1*t").replace("until = 3", "until = 4.5")
        result = self.result(text)
        slip, = (event for event in result["events"] if event["kind"] == "slip")
        self.assertAlmostEqual(slip["t"], 4.0, delta=1e-9)
        self.assertAlmostEqual(result["final"]["x"][2], 0.125, delta=1e-8)

    def test_the_unit_of_mass_changes_nothing(self):
        """A body leaves its table where 2 sin 2t = 1; a puck of 1 m/s stops at t = 1/(mu g); the corners of a box come to rest."""
        lifted = """[model]
name = "pulled up"
[parameters]
m = 1
a = 1e-3
[states]
z = 0
vz = 0
[mechanics]
positions = ["z"]
velocities = ["vz"]
mass = [["m"]]
potential = "m*a*z"
force = { vz = "m*a*2*sin(2*t)" }
[[contacts]]
name = "table"
gap = "z"
[simulate]
until = 0.5
rtol = 1e-11
atol = 1e-16
"""
        for mass in ("1e-12", "1e-6", "1", "1e9"):
            events = self.result(lifted, "--set", f"m={mass}")["events"]
            self.assertEqual([event["kind"] for event in events], ["lift_off"])
            self.assertAlmostEqual(events[0]["t"], math.pi / 12, delta=1e-9)
        puck = contacts_test.SPACE.replace("[states]", "[parameters]\nm = 1\n[states]").replace("z = 1\nvx = 3\nvy = 4", "z = 0\nvx = 0.6\nvy = 0.8")
        puck = puck.replace('potential = "10*z"', 'potential = "m*10*z"\nmass = [["m", 0, 0], [0, "m", 0], [0, 0, "m"]]')
        for mass in ("1e-9", "1", "1e9"):
            events = self.result(puck, "--rtol", "1e-11", "--atol", "1e-13", "--set", f"m={mass}")["events"]
            self.assertEqual([event["kind"] for event in events], ["stick"])
            self.assertAlmostEqual(events[0]["t"], 1 / 3, delta=1e-9)

    def test_bounces_end_in_one_accumulation(self):
        """A ball that lies, and one that bounces on it: the limit is at t1 (1 + e) / (1 - e)."""
        stacked = """[model]
name = "stacked"
[states]
a = 0
b = 1.0
va = 0
vb = 0
[mechanics]
positions = ["a", "b"]
velocities = ["va", "vb"]
potential = "9.81*(a + b)"
[[contacts]]
name = "ground"
gap = "a"
[[contacts]]
name = "balls"
gap = "b - a - 0.4"
restitution = E
[simulate]
until = 9
"""
        for e in (0.3, 0.5, 0.8, 0.9):
            result = self.result(stacked.replace("E", str(e)))
            kinds = [event["kind"] for event in result["events"]]
            self.assertEqual(kinds, (len(kinds) - 1) * ["impact"] + ["accumulation"])
            limit = math.sqrt(1.2 / 9.81) * (1 + e) / (1 - e)
            self.assertAlmostEqual(result["events"][-1]["t"], limit, delta=1e-8)
            self.assertEqual(result["final"]["contact_modes"], ["closed", "closed"])
            self.assertEqual(result["final"]["x"][2:], [0.0, 0.0])

    def test_what_is_squeezed_jams(self):
        """Between a wall that comes and one that stands the bounces accumulate where both meet."""
        squeezed = """[model]
name = "squeezed"
[states]
x = 0.5
v = 0
[mechanics]
positions = ["x"]
velocities = ["v"]
[[contacts]]
name = "left"
gap = "x - 0.3*t"
restitution = 0.5
[[contacts]]
name = "right"
gap = "1 - x"
restitution = 0.5
[simulate]
until = 5
"""
        result = self.result(squeezed, code=3)
        self.assertEqual(result["status"]["termination"], "outside_class")
        self.assertAlmostEqual(result["status"]["time_reached"], 10 / 3, delta=1e-8)
        self.assertIn("bodies jam", result["status"]["message"])

    def test_jumps_of_bodies_at_rest(self):
        """What a jump sets is what follows: the modes are found afresh, as at a start."""
        rest = (contacts_test.BALL.replace("z = 1\nvx = 4", "z = 0\nvx = 0").replace("mu = 0.3", "mu = 0.5")
                .replace('friction = "mu"', 'friction = "mu"\nrestitution = 0.5\n[[jumps]]\nname = "kick"\nat = [0.5]\nset = { SET }')
                .replace("until = 2", "until = 1.5\nrtol = 1e-10"))

        def kinds(change, code=0):
            result = self.result(rest.replace("SET", change), code=code)
            return result, [(event["kind"], round(event["t"], 9)) for event in result["events"]]

        flown, seen = kinds('vx = "vx + 1", vz = "vz + 0.5"')
        self.assertEqual(seen[:2], [("jump", 0.5), ("impact", 0.6)])
        self.assertAlmostEqual(flown["events"][1]["x"][0], 0.1, delta=1e-9)
        slid, seen = kinds("vx = 2")  # 5 m/s^2 for 0.4 s
        self.assertEqual(seen, [("jump", 0.5), ("stick", 0.9)])
        self.assertAlmostEqual(slid["final"]["x"][0], 0.4, delta=1e-9)
        self.assertEqual(kinds("z = 0.2")[1][:2], [("jump", 0.5), ("impact", 0.7)])
        hit, seen = kinds("vz = -1")
        self.assertEqual(seen[:3], [("jump", 0.5), ("impact", 0.5), ("impact", 0.6)])
        self.assertAlmostEqual(hit["events"][1]["impulse"][0][0], 1.5, delta=1e-12)
        below, _ = kinds("z = -0.1", code=3)
        self.assertEqual(below["status"]["termination"], "outside_class")
        self.assertIn("makes the gap of 'ground' -0.1", below["status"]["message"])

    def test_a_touch_without_an_approach_is_no_impact(self):
        """The height is (1 - t)^2 up to t = 1."""
        for integrator in ("dopri5", "radau5", "taylor"):
            with self.subTest(integrator):
                (event,) = self.result(TOUCH, "--integrator", integrator)["events"]
                self.assertEqual((event["kind"], event["contact_modes_after"]), ("contact", ["closed"]))
                self.assertAlmostEqual(event["t"], 1, delta=1e-12)

    def test_gaps_that_share_a_normal_close_together(self):
        expected = self.result(ONE_NORMAL + "[simulate]\nuntil = 3\n", "--integrator", "radau5")["final"]["x"]
        result = self.result(ONE_NORMAL + "[simulate]\nuntil = 3\nmax_steps = 2000\n")
        for value, other in zip(result["final"]["x"], expected):
            self.assertAlmostEqual(value, other, delta=1e-8)

    def test_what_lands_beside_a_closed_gap_is_not_in_it(self):
        self.assertLess(self.result(BESIDE)["penetration"], 1e-12)

    def test_slips_that_begin_at_rest_do_not_end_there(self):
        """Two contacts hold the bodies in the corner; the gap of the first one is 0, whether it presses, too, or not."""
        result = self.result(CORNER + "[simulate]\nuntil = 3\nmax_events = 1000\n")
        self.assertEqual(result["final"]["contact_modes"][1:], 2 * ["stick"])
        self.assertAlmostEqual(result["final"]["outputs"][result["outputs"].index("gap(c0)")], 0, delta=1e-12)
        for speed in result["final"]["x"][4:]:
            self.assertAlmostEqual(speed, 0, delta=1e-12)

    def test_what_comes_to_rest_in_a_limit_does_not_slip_there(self):
        result = self.result(LIMIT)
        for name in ("c0", "c1", "c3"):
            force = result["outputs"].index(f"force({name})")
            self.assertGreater(min(row[force] for row in result["trajectory"]["outputs"]), -1e-9, name)
        limit = next(event for event in result["events"] if event["kind"] == "accumulation")
        self.assertEqual(limit["contact_modes_after"], 3 * ["stick"])

    def test_friction_in_a_corner_holds(self):
        expected = self.result(HELD_IN_A_CORNER, "--rtol", "1e-10")["final"]["x"]
        for integrator in ("dopri5", "dop853", "radau5", "taylor"):
            for rtol in ("1e-6", "1e-8"):
                with self.subTest(integrator=integrator, rtol=rtol):
                    final = self.result(HELD_IN_A_CORNER, "--integrator", integrator, "--rtol", rtol)["final"]
                    self.assertEqual(final["contact_modes"], 2 * ["stick"])
                    for value, other in zip(final["x"], expected):
                        self.assertAlmostEqual(value, other, delta=1e-6)

    def test_a_mass_that_is_lost_on_the_way_ends_the_run(self):
        """The inertia b - q of the second row is used up where q = b, whatever turns it."""
        for mass in (DIAGONAL, '[[1, 1], [1, "1 + b - q"]]'):
            for force in ("-1", "0.1*(b - q)", "w - 1", "0"):
                for integrator in ("dopri5", "dop853", "radau5", "taylor"):
                    with self.subTest(mass=mass, force=force, integrator=integrator):
                        result = self.result(MASS.replace(DIAGONAL, mass).replace("FORCE", force), "--integrator", integrator, code=3)
                        status = result["status"]
                        self.assertEqual(status["termination"], "outside_class")
                        self.assertIn("the mass matrix is not positive definite beyond", status["message"])
                        self.assertIn("row 2 ('w')", status["message"])
        jump = MASS.replace("FORCE", "-1") + '[[jumps]]\nat = [0.1]\nset = { q = 1 }\n'
        status = self.result(jump, code=3)["status"]
        self.assertEqual((status["termination"], status["time_reached"]), ("outside_class", 0.1))
        self.assertIn("row 2 ('w')", status["message"])

    def test_what_is_held_by_itself_is_zero(self):
        """A cart that sticks under its pendulum: its velocity is 0, not the rounding of a projection."""
        cart = """[model]
name = "cart"
[states]
x = 0
z = 0
a = 1.2
vx = 0
vz = 0
w = 0
[mechanics]
positions = ["x", "z", "a"]
velocities = ["vx", "vz", "w"]
mass = [[2, 0, "cos(a)"], [0, 2, "sin(a)"], ["cos(a)", "sin(a)", 1]]
potential = "9.81*(2*z - cos(a))"
[[contacts]]
name = "ground"
gap = "z"
tangent = { x = 1 }
friction = 0.1
[[contacts]]
name = "stop"
gap = "a + 0.3"
restitution = 0.5
[simulate]
rtol = 1e-11
atol = 1e-13
until = 2.5
"""
        rows = self.result(cart)["trajectory"]
        modes = [row[0] for row in rows["contact_modes"]]
        self.assertIn("stick", modes)
        for mode, x in zip(modes, rows["x"], strict=True):
            if mode == "stick":
                self.assertEqual(x[3:5], [0.0, 0.0])


if __name__ == "__main__":
    tool.main()
