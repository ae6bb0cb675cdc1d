"""Several contacts at once where time stands still: the method fesd. Event-driven runs are the truth."""

import json
import math

import time_freezing_test
import tool

EXAMPLES = tool.SOURCE / "examples/contacts"
FINE = ("--set", "simulate.fesd.stages=3", "--set", "simulate.fesd.steps=200")

PLANE = time_freezing_test.HEAD + """[states]
x = {x}
z = {z}
vx = {vx}
vz = {vz}
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
{mechanics}
[[contacts]]
name = "c"
{contact}
[simulate]
until = {until}
"""

# Two bodies hit a heavier one from both sides at one time.
BOTH_SIDES = time_freezing_test.HEAD + """[states]
a = -4
b = 0
c = 4
va = 2
vb = 0
vc = -2
[mechanics]
positions = ["a", "b", "c"]
velocities = ["va", "vb", "vc"]
mass = [["1", "0", "0"], ["0", "3", "0"], ["0", "0", "1"]]
[[contacts]]
name = "left"
gap = "b - a - 1"
restitution = 0.7
[[contacts]]
name = "right"
gap = "c - b - 1"
restitution = 0.7
[simulate]
until = 3
"""

# A box lands flat on two feet of different friction, beside each other and below the centre of mass.
FLAT_BOX = time_freezing_test.HEAD + """[states]
x = 0
z = 0.7371
phi = 0
vx = 1.3
vz = -0.31
w = 0
[mechanics]
positions = ["x", "z", "phi"]
velocities = ["vx", "vz", "w"]
mass = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "0.4"]]
force = {{ vz = -9.81 }}
[[contacts]]
name = "l"
gap = "z - 0.6*phi - 0.1"
tangent = {{ x = "1", phi = "0.5" }}
friction = {}
[[contacts]]
name = "r"
gap = "z + 0.8*phi - 0.1"
tangent = {{ x = "1", phi = "0.5" }}
friction = {}
[simulate]
until = 0.9
"""

# A disc hits two that touch.
THREE_DISCS = time_freezing_test.HEAD + """[states]
x1 = -3.1
y1 = 0
x2 = 0
y2 = 0.5
x3 = 0
y3 = -0.5
u1 = 2
v1 = 0
u2 = 0
v2 = 0
u3 = 0
v3 = 0
[mechanics]
positions = ["x1", "y1", "x2", "y2", "x3", "y3"]
velocities = ["u1", "v1", "u2", "v2", "u3", "v3"]
""" + "".join(f"""[[contacts]]
name = "c{i}{j}"
gap = "sqrt((x{i} - x{j})^2 + (y{i} - y{j})^2) - 1"
restitution = RESTITUTION
""" for i, j in ((1, 2), (1, 3), (2, 3))) + "[simulate]\nuntil = 3\n"

PULLED_BLOCK = PLANE.format(
    x=0, z=0, vx=0, vz=0, until=3, mechanics='force = { vx = "15*(0.4*t - x) - 0.3*vx", vz = "-9.81 - 3*cos(2*t)" }',
    contact='gap = "z"\ntangent = { x = "1" }\nfriction = 0.25')


def pile(count):
    """Blocks on each other that are shaken from below, with friction."""
    names = [f"{axis}{i}" for i in range(count) for axis in "xz"]
    states = "".join(f"{name} = {name[1:] if name[0] == 'z' else 0}\nv{name} = 0\n" for name in names)
    contacts = "".join(f"""[[contacts]]
name = "c{i}"
gap = "z{i}{f' - z{i - 1} - 1' if i else ''}"
tangent = {{ x{i} = "1"{f', x{i - 1} = "-1"' if i else ''} }}
friction = 0.4
""" for i in range(count))
    return time_freezing_test.HEAD + f"""[states]
{states}[mechanics]
positions = {json.dumps(names)}
velocities = {json.dumps(["v" + name for name in names])}
potential = "9.81*({" + ".join(name for name in names if name[0] == "z")})"
force = {{ vx0 = "{8 * count}*sin(3*t)" }}
{contacts}[simulate]
until = 2
"""


def forced(name, force, horizon):
    """An example of [optimize] with a force as a function of t for its control."""
    text = (tool.SOURCE / "models/optima" / name).read_text(encoding="utf-8")
    head = text[:text.index("[simulate]")].replace("u - d*", f"{force} - d*")
    start = head.index("[controls]")
    return head[:start] + head[head.index("[mechanics]"):] + f"[simulate]\nuntil = {horizon}\n"


class FrozenContacts(time_freezing_test.FrozenTest):
    def test_contacts_that_close_at_once_are_one_impact(self):
        # Whatever the rounding, which other steps change. One behind the other they would end elsewhere, which is said.
        models = [BOTH_SIDES] + [THREE_DISCS.replace("RESTITUTION", e) for e in ("0",)]
        models += [FLAT_BOX.format(*friction) for friction in ((0.2, 0.6), (0.6, 0.6), (0.3, 0))]
        for model in tool.some(models, 1):
            event = self.simulated(model, "event")
            for steps in (37, 100):
                with self.subTest(model=model, steps=steps):
                    frozen = self.simulated(model, "fesd", "--set", f"simulate.fesd.steps={steps}")
                    for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
                        self.assertAlmostEqual(expected, found, delta=1e-9)
                    first, found = event["events"][0], frozen["events"][0]
                    self.assertEqual((first["kind"], first["unique"]), (found["kind"], found["unique"]))
                    for a, b in zip(first["x_after"], found["x_after"]):
                        self.assertAlmostEqual(a, b, delta=1e-9)

    def test_impacts_of_bodies_apart_at_one_time_are_unique(self):
        # Neither moves what the other one touches.
        falling = PLANE.format(x=1, z=1, vx=-1, vz=-1, mechanics="", until=1.5, contact='gap = "x"\nrestitution = 0.5')
        falling = falling.replace("[simulate]", '[[contacts]]\nname = "d"\ngap = "z"\nrestitution = 0.5\n[simulate]')
        _, frozen = self.assert_agree(falling, 1e-12)
        self.assertEqual([e["unique"] for e in frozen["events"]], [True])

    def test_a_ball_rests_on_the_floor_between_walls(self):
        # While it hits a wall nothing presses it down, and nothing but second derivatives holds it there.
        walls = "".join(f'[[contacts]]\nname = "{name}"\ngap = "{gap}"\nrestitution = {{1}}\n'
                        for name, gap in (("left", "x"), ("right", "1.2 - x")))
        model = PLANE.format(x=0.4, z=0.8, vx=1.7, vz=0, mechanics='potential = "9.81*z"', until=4,
                             contact='gap = "z"\nrestitution = {0}')
        lid = '[[contacts]]\nname = "lid"\ngap = "1.6 - z"\nrestitution = {0}\n'
        model = model.replace("[simulate]", walls + lid + "[simulate]")
        for restitution in tool.some(((0.6, 0.85), (0.55, 0.85), (0.55, 0.9), (0.65, 0.9)), 1):
            with self.subTest(restitution=restitution):
                bodies = model.format(*restitution)
                event = self.simulated(bodies, "event")
                frozen = self.simulated(bodies, "fesd", "--set", "simulate.fesd.stages=4", "--set", "simulate.fesd.steps=200")
                self.assertEqual(frozen["events"][-1]["surfaces"], event["events"][-1]["surfaces"])
                for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
                    self.assertAlmostEqual(expected, found, delta=1e-9)

    @tool.not_sanitized
    def test_blocks_in_a_pile_stick_and_slip(self):
        # All joints above the first one reach their bounds at once.
        for count in (2, 4):
            with self.subTest(count=count):
                event, frozen = self.simulated(pile(count), "event"), self.simulated(pile(count), "fesd", *FINE)
                for expected, found in zip(event["final"]["x"], frozen["final"]["x"], strict=True):
                    self.assertAlmostEqual(expected, found, delta=1e-7)

    def test_what_sticks_stands_in_every_row(self):
        # Inside elements, too: from t = 0 to 0.4803 and from 1.9529 to 2.2043.
        block = self.simulated(PULLED_BLOCK, "fesd", "--set", "simulate.fesd.stages=4", "--set", "simulate.fesd.steps=100",
                               "--set", "simulate.output.every=0.01")
        rows = block["trajectory"]
        sticking = [abs(x[2]) for t, x in zip(rows["t"], rows["x"]) if t < 0.48 or 1.953 < t < 2.204]
        self.assertGreater(len(sticking), 70)
        self.assertLess(max(sticking), 1e-12)

    def test_bodies_at_rest_at_the_start_beside_what_is_idle(self):
        # What a wall far away, or a hysteresis that waits, does has no equation there.
        bodies = time_freezing_test.HEAD + """[states]
x = 0
y0 = 0
y1 = 0
vx = 1
v0 = 0
v1 = 0
[mechanics]
positions = ["x", "y0", "y1"]
velocities = ["vx", "v0", "v1"]
force = { v0 = -10, v1 = -9.81 }
[[contacts]]
name = "g0"
gap = "y0"
"""
        second = '[[contacts]]\nname = "g1"\ngap = "y1"\n'
        hysteresis = '[[hysteresis]]\nname = "h"\ninput = "x"\non = 0.3\noff = -0.1\n'
        wall = '[[contacts]]\nname = "wall"\ngap = "x + 1"\n'
        for more in tool.some((second + wall, hysteresis, second + hysteresis, second + wall + hysteresis), 1):
            for speed in (0, 1):
                model = bodies.replace("vx = 1", f"vx = {speed}") + more + "[simulate]\nuntil = 1\n"
                with self.subTest(more=more, speed=speed):
                    _, frozen = self.assert_agree(model, 1e-12)
                    self.assertEqual(frozen["final"]["contact_modes"][0], "closed")

    def test_curved_gaps_are_held_with_few_stages(self):
        # Their rates are held; the gaps drift by the error of the scheme, which every element takes back.
        for model, two, three in tool.some((("falling-rod", 1e-5, 1e-9), (str(EXAMPLES / "disc-exchange.toml"), 1e-5, 1e-9)), 1):
            for delta, options in ((two, ()), (three, FINE)):
                _, frozen = self.assert_agree(model, delta, *options)
                self.assertLess(frozen["statistics"]["steps"], 1000)
                self.assertLess(frozen["statistics"]["rejected"], 100)

    def test_carts_stay_on_the_ground_while_one_pushes_the_other(self):
        self.assert_agree(forced("carts-on-ground.toml", "8*cos(pi*t/4)", 4), 1e-8, *FINE)

    @tool.not_sanitized
    def test_a_ball_hits_a_heap(self):
        # Balls that touch without a force may be told of or not.
        event = self.simulated("pile-of-balls", "event", "--until", "0.12")
        frozen = self.simulated("pile-of-balls", "fesd", "--until", "0.12", "--set", "simulate.fesd.stages=3")
        self.assertEqual([e["kind"] for e in frozen["events"]], ["impact"] * 4)
        for expected, found in zip(event["events"], frozen["events"]):
            self.assertAlmostEqual(expected["t"], found["t"], delta=1e-9)
        for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
            self.assertAlmostEqual(expected, found, delta=1e-8)

    @tool.not_sanitized
    def test_a_leg_falls_onto_a_slope(self):
        event, frozen = (self.simulated(str(EXAMPLES / "leg-on-slope.toml"), method, "--until", "0.4", *options)
                         for method, options in (("event", ()), ("fesd", FINE)))
        for expected, found in zip(event["events"], frozen["events"], strict=True):
            self.assertAlmostEqual(expected["t"], found["t"], delta=1e-8)
        for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
            self.assertAlmostEqual(expected, found, delta=1e-8)

    def test_what_bounces_is_held_on_a_slope(self):
        # Of the gap and its rate one equation holds two selections; the clock alone tells which weights they have.
        for a, restitution in tool.some(((0.2, 0.9), (0.3, 0.9), (0.4, 0.9), (0.9, 0.9), (0.4, 1)), 1):
            slope = PLANE.format(x=0, z=0, vx=2 * math.cos(a), vz=2 * math.sin(a), mechanics='potential = "9.81*z"',
                                 contact=f'gap = "z*{math.cos(a)} - x*{math.sin(a)}"\nrestitution = {restitution}', until=1)
            way, speed = 2 - 0.5 * 9.81 * math.sin(a), 2 - 9.81 * math.sin(a)
            for stages in (2, 3):
                with self.subTest(a=a, restitution=restitution, stages=stages):
                    frozen = self.simulated(slope, "fesd", "--set", f"simulate.fesd.stages={stages}")
                    expected = (way * math.cos(a), way * math.sin(a), speed * math.cos(a), speed * math.sin(a))
                    for value, found in zip(expected, frozen["final"]["x"]):
                        self.assertAlmostEqual(value, found, delta=1e-10)
                    self.assertEqual((frozen["events"], frozen["final"]["contact_modes"]), ([], ["closed"]))
                    self.assertLess(frozen["statistics"]["rejected"], 10)

    def test_what_bounces_is_held_beside_another_contact(self):
        # Masses couple them: an impact of one pushes the other.
        bodies = time_freezing_test.HEAD + """[states]
x = 0
z = 0
w = {start}
vx = 0.8
vz = 0
vw = 0
[mechanics]
positions = ["x", "z", "w"]
velocities = ["vx", "vz", "vw"]
mass = [[2, 0.2, -0.1], [0.2, 2, 0.25], [-0.1, 0.25, 1.5]]
force = {{ vx = "1 - 3*x", vz = -20, vw = -15 }}
[[contacts]]
name = "c"
gap = "z - 0.3*x^2"
restitution = 0.7
[[contacts]]
name = "d"
gap = "w"
restitution = {restitution}
[simulate]
until = 0.8
"""
        for start, restitution in tool.some(((0.3, 0.6), (0, 0), (0, 0.6), (0.3, 0)), 1):
            with self.subTest(start=start, restitution=restitution):
                model = bodies.format(start=start, restitution=restitution)
                event, frozen = (self.simulated(model, method, *more) for method, more in
                                 (("event", ()), ("fesd", ("--set", "simulate.fesd.stages=3"))))
                for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
                    self.assertAlmostEqual(expected, found, delta=1e-7)

    def test_an_impact_presses_what_is_at_rest(self):
        # A body falls onto one that lies on the ground or is pressed to a wall, or both are coupled and begin at rest.
        for mass, gap, start, speed in (("[[0.788, 0], [0, 1.517]]", "b - a", 0.161, -1.577),
                                        ("[[2.5, -0.3], [-0.3, 1.1]]", "b", 0.2, -0.9),
                                        ("[[2.5, 0.4], [0.4, 1.1]]", "b", 0, 0)):
            for first, second in tool.some(((0.5, 0.7), (0.7, 0.3), (0.5, 0), (1, 0.5), (1, 0)), 1):
                model = time_freezing_test.HEAD + f"""[states]
a = 0
b = {start}
va = 0
vb = {speed}
[mechanics]
positions = ["a", "b"]
velocities = ["va", "vb"]
mass = {mass}
force = {{ va = "-12 - 3*(a - b)", vb = "-7 + 3*(a - b)" }}
[[contacts]]
name = "first"
gap = "a"
restitution = {first}
[[contacts]]
name = "second"
gap = "{gap}"
restitution = {second}
[simulate]
until = 0.3
"""
                for form in ("step", "stewart"):
                    with self.subTest(gap=gap, start=start, restitution=(first, second), form=form):
                        event, frozen = (self.simulated(model, method, *more) for method, more in (
                            ("event", ()), ("fesd", ("--set", "simulate.fesd.stages=3", "--set",
                                                     f"simulate.fesd.reformulation={form}"))))
                        for expected, found in zip(event["final"]["x"], frozen["final"]["x"], strict=True):
                            self.assertAlmostEqual(expected, found, delta=1e-8)

    def test_a_step_ends_where_a_ball_turns(self):
        # 2/100 after the impact at 0.5, in numerical time: steps of 0.02.
        box = (tool.SOURCE / "models/ball-in-box.toml").read_text(encoding="utf-8")
        for restitution in tool.some((0.5, 1), 1):
            with self.subTest(restitution=restitution):
                self.assert_agree(box.replace("restitution = 1", f"restitution = {restitution}"), 1e-10, *FINE)

    def test_what_bounces_is_held_with_a_speed_that_is_zero_but_for_roundings(self):
        spring = PLANE.format(
            x=0, z=0, vx=-1.775875111177648, vz=0.6744108353881114, until=1.5,
            mechanics="mass = [[1.8986452924415897, -0.06067651611389455], [-0.06067651611389455, 1.1637097537834817]]\n"
                      'force = { vx = "-0.521 - 8.345*x", vz = -7.634 }',
            contact='gap = "0.3797625357454809*x + z"\nrestitution = 0.9')
        for stages, delta in tool.some(((2, 1e-5), (3, 1e-8), (5, 1e-8)), 1):
            with self.subTest(stages=stages):
                _, frozen = self.assert_agree(spring, delta, "--set", f"simulate.fesd.stages={stages}")
                self.assertLess(frozen["statistics"]["steps"], 1000)

    def test_a_body_leaves_a_round_hill(self):
        hill = PLANE.format(x=0, z=1, vx=1, vz=0, mechanics='potential = "9.81*z"', contact='gap = "x^2 + z^2 - 1"',
                            until=0.627)
        for steps in tool.some((100, 200), 1):
            _, frozen = self.assert_agree(hill, 1e-8, "--set", "simulate.fesd.stages=3", "--set",
                                          f"simulate.fesd.steps={steps}")
            self.assertAlmostEqual(frozen["events"][0]["x_after"][1], 2 / 3 + 1 / (3 * 9.81), delta=1e-9)

    def test_a_block_comes_to_rest_in_a_round_bowl(self):
        bowl = PLANE.format(x=math.sin(1), z=-math.cos(1), vx=0, vz=0, mechanics='potential = "9.81*z"', until=6,
                            contact='gap = "0.5*(1 - x^2 - z^2)"\ntangent = { x = "-z", z = "x" }\nfriction = 0.2')
        for steps, delta in tool.some(((40, 1e-5), (100, 1e-7)), 1):
            frozen = self.simulated(bowl, "fesd", "--set", "simulate.fesd.stages=3", "--set",
                                    f"simulate.fesd.steps={steps}")
            # Integrated in the angle with rtol 1e-12.
            self.assertAlmostEqual(frozen["final"]["x"][0], 0.0470137806, delta=delta)
            self.assertAlmostEqual(frozen["events"][-1]["t"], 2.0291623058, delta=delta)
            self.assertEqual(frozen["events"][-1]["kind"], "stick")

    def test_one_stage_needs_no_more_evaluations_per_step(self):
        slope = PLANE.format(x=0, z=0, vx=0, vz=0, mechanics='potential = "9.81*z"', until=1,
                             contact=f'gap = "z*{math.cos(0.6)} + x*{math.sin(0.6)}"\nfriction = 0.3\n'
                                     f"tangent = {{ x = {math.cos(0.6)}, z = {-math.sin(0.6)} }}")
        rate = 9.81 * (math.sin(0.6) - 0.3 * math.cos(0.6))
        frozen = self.simulated(slope, "fesd", "--set", "simulate.fesd.stages=1")
        self.assertAlmostEqual(frozen["final"]["x"][2], rate * math.cos(0.6), delta=1e-9)
        counts = frozen["statistics"]
        self.assertLess(counts["rhs_evaluations"], 60 * counts["steps"])


if __name__ == "__main__":
    tool.main()
