"""Modes of [[contacts]]: in any units, behind jumps of bodies at rest, and what they hold exactly."""

import math

import contacts_test
import tool


class ContactModes(tool.ResultTest):
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
