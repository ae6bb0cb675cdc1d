"""Limits of the bounces of [[contacts]], and where their forces end: what follows there is what follows for any integrator."""

import tool

# A rod falls on rough ground; each of its last bounces ends in sticking.
ROD = """[model]
name = "falling rod"
[states]
x = 0.0
y = "sin(ANGLE) + 0.1"
a = ANGLE
vx = SPEED
vy = 0.0
w = 0.0
[mechanics]
positions = ["x", "y", "a"]
velocities = ["vx", "vy", "w"]
mass = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "INERTIA"]]
potential = "9.81*y"
[[contacts]]
name = "tip"
gap = "y - sin(a)"
tangent = { x = "1", a = "sin(a)" }
friction = FRICTION
restitution = RESTITUTION
[simulate]
until = 0.5
rtol = 1e-10
atol = 1e-12
"""

# A ball on the ground, or above it.
RESTING = """[model]
name = "resting"
[states]
z = {z}
v = {v}
[mechanics]
positions = ["z"]
velocities = ["v"]
force = {{ v = "-10" }}
[[contacts]]
name = "ground"
gap = "z"
[simulate]
until = 2
"""

# A table that goes up and down, under a ball.
TABLE = """[model]
name = "table"
[states]
z = 0
v = 0
[mechanics]
positions = ["z"]
velocities = ["v"]
potential = "9.81*z"
[[contacts]]
name = "table"
gap = "z - 0.1*sin(2*t)"
restitution = 0.5
[simulate]
until = 1
"""

# A body on a foot, with a spring that is driven: it lands, comes to rest, and leaves the ground.
HOPPER = """[model]
name = "hopper"
[parameters]
m = 3.8995
m2 = 0.3398
k = 1906.917
d = 4.5723
[states]
y = 0.8
z = 0.3
vy = 0.0
vz = 0.0
[mechanics]
positions = ["y", "z"]
velocities = ["vy", "vz"]
mass = [["m", "0"], ["0", "m2"]]
potential = "9.81*(m*y + m2*z)"
force = { vy = "-(k*(y - z - 0.5 - 0.0312*sin(11.2435*t)) + d*(vy - vz))", vz = "k*(y - z - 0.5 - 0.0312*sin(11.2435*t)) + d*(vy - vz)" }
[[contacts]]
name = "foot"
gap = "z"
restitution = 0.5578
[simulate]
until = 2
rtol = 1e-10
atol = 1e-12
max_events = 300
"""


def rod(**values):
    text = ROD
    for name, value in values.items():
        text = text.replace(name.upper(), str(value))
    return text


class ContactLimits(tool.ResultTest):
    def test_what_sticks_after_each_bounce_sticks_in_their_limit(self):
        """The states are those of all integrators at rtol 1e-12."""
        for integrator, text, x, a in (
            ("taylor", rod(angle=1.0195, speed=0.5846, inertia=0.1481, friction=2.0, restitution=0.15), 0.534815120579, 0.281905780049),
            ("radau9", rod(angle=0.7164, speed=-2.961, inertia=0.1617, friction=1.9215, restitution=0.25), -0.34365825, 0.58696795)):
            with self.subTest(integrator):
                result = self.result(text, "--integrator", integrator)
                limit = next(event for event in result["events"] if event["kind"] == "accumulation")
                self.assertEqual(limit["contact_modes_after"], ["stick"])
                self.assertAlmostEqual(result["final"]["x"][0], x, delta=1e-7)
                self.assertAlmostEqual(result["final"]["x"][2], a, delta=1e-7)

    def test_bounces_end_on_a_gap_that_moves(self):
        result = self.result(TABLE)
        self.assertIn("accumulation", [event["kind"] for event in result["events"]])
        self.assertLess(result["penetration"], 1e-12)
        gap = result["outputs"].index("gap(table)")
        rows = result["trajectory"]
        limit = next(event["t"] for event in result["events"] if event["kind"] == "accumulation")
        at_limit = [row[gap] for t, row in zip(rows["t"], rows["outputs"], strict=True) if t == limit]
        self.assertEqual(len(at_limit), 2)
        for value in at_limit:
            self.assertAlmostEqual(value, 0, delta=1e-14)

    def test_a_body_that_begins_below_the_ground_by_rounding_lands(self):
        """Its gap is negative, and grows so slowly that it never becomes positive: it must not count as fallen through."""
        for z in ("-1e-20", "-1e-107", "-1e-250", "1e-20"):
            for v in ("1e-20", "1e-40", "1e-160", "-1e-40"):
                put = f'[[jumps]]\nname = "put"\nat = [1]\nset = {{ z = "{z}", v = "{v}" }}\n'
                for text in (RESTING.format(z=z, v=v), RESTING.format(z=1, v=0) + put):
                    with self.subTest(z=z, v=v, jumps=put in text):
                        self.assertLess(abs(self.result(text)["final"]["x"][0]), 1e-12)

    def test_a_foot_leaves_the_ground_once(self):
        """Its force ends, and grows on as an acceleration: the gap opens like t^3, less than steps leave of its rate."""
        expected = None
        for integrator in ("dopri5", "radau5"):
            with self.subTest(integrator):
                result = self.result(HOPPER, "--integrator", integrator)
                expected = expected or result
                count = [event["kind"] for event in result["events"]].count
                self.assertEqual(count("lift_off"), [event["kind"] for event in expected["events"]].count("lift_off"))
                self.assertEqual(count("contact"), 0)
                for value, other in zip(result["final"]["x"], expected["final"]["x"], strict=True):
                    self.assertAlmostEqual(value, other, delta=1e-6)

    def test_a_box_sticks_slips_and_hops_ahead(self):
        result = self.result((tool.SOURCE / "examples/contacts/walking-box.toml").read_text(encoding="utf-8"), "--until", "1.5")
        modes = {tuple(modes) for modes in result["trajectory"]["contact_modes"]}
        self.assertTrue({("stick", "stick"), ("slip", "slip"), ("open", "open")} <= modes, modes)
        self.assertGreater(result["final"]["x"][0], 0.2)
        self.assertLess(result["penetration"], 1e-9)
        self.assertEqual(len(result["drawing"]["rows"]), len(result["trajectory"]["t"]))


if __name__ == "__main__":
    tool.main()
