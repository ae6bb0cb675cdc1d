"""Several contacts at once where time stands still: the method fesd. Event-driven runs are the truth."""

import time_freezing_test
import tool

EXAMPLES = tool.SOURCE / "examples/contacts"
FINE = ("--set", "simulate.fesd.stages=3", "--set", "simulate.fesd.steps=200")


def forced(name, force, horizon):
    """An example of [optimize] with a force as a function of t for its control."""
    text = (EXAMPLES / name).read_text(encoding="utf-8")
    head = text[:text.index("[optimize]")].replace("u - d*", f"{force} - d*")
    start = head.index("[controls]")
    return head[:start] + head[head.index("[mechanics]"):] + f"[simulate]\nuntil = {horizon}\n"


class FrozenContacts(time_freezing_test.FrozenTest):
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
        for more in (second + wall, hysteresis, second + hysteresis, second + wall + hysteresis):
            for speed in (0, 1):
                model = bodies.replace("vx = 1", f"vx = {speed}") + more + "[simulate]\nuntil = 1\n"
                with self.subTest(more=more, speed=speed):
                    _, frozen = self.assert_agree(model, 1e-12)
                    self.assertEqual(frozen["final"]["contact_modes"][0], "closed")

    def test_curved_gaps_are_held_with_few_stages(self):
        # Their rates are held; the gaps drift by the error of the scheme, which every element takes back.
        for model, two, three in ((str(EXAMPLES / "disc-exchange.toml"), 1e-5, 1e-9), ("falling-rod", 1e-5, 1e-9)):
            for delta, options in ((two, ()), (three, FINE)):
                _, frozen = self.assert_agree(model, delta, *options)
                self.assertLess(frozen["statistics"]["steps"], 1000)
                self.assertLess(frozen["statistics"]["rejected"], 100)

    def test_carts_stay_on_the_ground_while_one_pushes_the_other(self):
        self.assert_agree(forced("carts-on-ground.toml", "8*cos(pi*t/4)", 4), 1e-8, *FINE)

    def test_a_ball_hits_a_heap(self):
        # Balls that touch without a force may be told of or not.
        event = self.simulated("pile-of-balls", "event", "--until", "0.12")
        frozen = self.simulated("pile-of-balls", "fesd", "--until", "0.12", "--set", "simulate.fesd.stages=3")
        self.assertEqual([e["kind"] for e in frozen["events"]], ["impact"] * 4)
        for expected, found in zip(event["events"], frozen["events"]):
            self.assertAlmostEqual(expected["t"], found["t"], delta=1e-9)
        for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
            self.assertAlmostEqual(expected, found, delta=1e-8)

    def test_a_leg_falls_onto_a_slope(self):
        event, frozen = (self.simulated(str(EXAMPLES / "leg-on-slope.toml"), method, "--until", "0.4", *options)
                         for method, options in (("event", ()), ("fesd", FINE)))
        for expected, found in zip(event["events"], frozen["events"], strict=True):
            self.assertAlmostEqual(expected["t"], found["t"], delta=1e-8)
        for expected, found in zip(event["final"]["x"], frozen["final"]["x"]):
            self.assertAlmostEqual(expected, found, delta=1e-8)


if __name__ == "__main__":
    tool.main()
