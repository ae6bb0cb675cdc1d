"""What varies on the way: friction and restitution of contacts over positions and time, thresholds of a hysteresis over
time. A state called `clock` beside them."""

import math

import tool

BODY = """
[model]
name = "a body on the ground"
[states]
x = 0
z = 0
vx = 1
vz = 0
[mechanics]
positions = ["x", "z"]
velocities = ["vx", "vz"]
force = { vx = 0, vz = -9.81 }
[[contacts]]
name = "ground"
gap = "z"
tangent = { x = 1 }
friction = "0.3*t"
[simulate]
until = 0.6
rtol = 1e-10
atol = 1e-10
"""


LINE_OF_FRICTION = 1 + BODY.splitlines().index('friction = "0.3*t"')


class Friction(tool.ResultTest):
    def test_begins_at_zero_with_the_time(self):
        # vx = 1 - 0.15 g t^2.
        result = self.result(BODY)
        x, z, vx, vz = result["final"]["x"]
        self.assertAlmostEqual(vx, 1.0 - 0.15 * 9.81 * 0.36, delta=1e-9)
        self.assertAlmostEqual(x, 0.6 - 0.05 * 9.81 * 0.6**3, delta=1e-9)
        self.assertEqual((z, vz), (0.0, 0.0))

    def test_begins_at_zero_and_brings_the_body_to_rest(self):
        result = self.result(BODY.replace("until = 0.6", "until = 2"))
        stick, = (event for event in result["events"] if event["kind"] == "stick")
        stop = 1.0 / math.sqrt(0.15 * 9.81)
        self.assertAlmostEqual(stick["t"], stop, delta=1e-9)
        self.assertAlmostEqual(result["final"]["x"][0], 2.0 / 3.0 * stop, delta=1e-9)
        self.assertEqual(result["final"]["contact_modes"], ["stick"])

    def test_of_zero_does_not_hold_a_body(self):
        # Pushed from rest where friction is 0.3 max(0, x): x' = sqrt(2 (x + 2)) up to x = 0, then x'' = 1 - 2.943 x.
        text = BODY.replace("x = 0\n", "x = -2\n", 1).replace("vx = 1\n", "vx = 0\n").replace("vx = 0, vz", "vx = 1, vz")
        text = text.replace("0.3*t", "0.3*max(0, x)").replace("until = 0.6", "until = 10")
        result = self.result(text)
        stick, = (event for event in result["events"] if event["kind"] == "stick")
        k = 0.3 * 9.81
        w = math.sqrt(k)
        # x = 1/k - cos(w s)/k + 2 sin(w s)/w
        stop = (math.pi - math.atan(2.0 * w)) / w
        self.assertAlmostEqual(stick["t"], 2.0 + stop, delta=1e-8)
        self.assertAlmostEqual(result["final"]["x"][0], 1.0 / k + math.hypot(1.0 / k, 2.0 / w), delta=1e-8)
        self.assertEqual(result["final"]["contact_modes"], ["stick"])

    def test_of_zero_leaves_a_body_at_rest_alone(self):
        text = BODY.replace("vx = 1\n", "vx = 0\n").replace("vx = 0, vz", "vx = \"sin(t)\", vz")
        text = text.replace("0.3*t", "0.3*max(0, x - 1)").replace("until = 0.6", "until = 1.5")
        x, _, vx, _ = self.result(text)["final"]["x"]
        self.assertAlmostEqual(vx, 1.0 - math.cos(1.5), delta=1e-9)
        self.assertAlmostEqual(x, 1.5 - math.sin(1.5), delta=1e-9)

    def test_holds_as_soon_as_there_is_some(self):
        text = BODY.replace("vx = 1\n", "vx = 0\n").replace("vx = 0, vz", "vx = \"0.1*t\", vz")
        result = self.result(text)
        self.assertEqual(result["final"]["contact_modes"], ["stick"])
        self.assertAlmostEqual(result["final"]["x"][0], 0.0, delta=1e-15)

    def test_may_end_and_begin_again(self):
        # 0.3 max(0, sin(pi t)): friction for 1, none for 1, friction again; vx falls by 0.6 g/pi each time.
        text = BODY.replace("vx = 1\n", "vx = 10\n").replace("0.3*t", "0.3*max(0, sin(pi*t))").replace("0.6", "4.5")
        vx = self.result(text)["final"]["x"][2]
        self.assertAlmostEqual(vx, 10.0 - 2.5 * 0.6 * 9.81 / math.pi, delta=1e-8)

    def test_may_touch_zero(self):
        text = BODY.replace("vx = 1\n", "vx = 10\n").replace("0.3*t", "0.3*(t - 1)^2").replace("0.6", "2")
        vx = self.result(text)["final"]["x"][2]
        self.assertAlmostEqual(vx, 10.0 - 9.81 * 0.2, delta=1e-8)

    def test_in_a_plane_begins_at_zero(self):
        text = BODY.replace("x = 0\n", "x = 0\ny = 0\n", 1).replace("vx = 1\n", "vx = 0.6\nvy = 0.8\n")
        text = text.replace('["x", "z"]', '["x", "y", "z"]').replace('["vx", "vz"]', '["vx", "vy", "vz"]')
        text = text.replace("tangent = { x = 1 }", "tangents = [{ x = 1 }, { y = 1 }]")
        result = self.result(text)
        x, y, _, vx, vy, _ = result["final"]["x"]
        v, s = 1.0 - 0.15 * 9.81 * 0.36, 0.6 - 0.05 * 9.81 * 0.6**3
        for value, expected in zip((x, y, vx, vy), (0.6 * s, 0.8 * s, 0.6 * v, 0.8 * v)):
            self.assertAlmostEqual(value, expected, delta=1e-8)
        stopped = self.result(text.replace("until = 0.6", "until = 2"))
        self.assertEqual(stopped["final"]["contact_modes"], ["stick"])
        self.assertAlmostEqual(stopped["final"]["x"][0], 0.4 / math.sqrt(0.15 * 9.81), delta=1e-8)

    def test_that_turns_negative_stops_the_run(self):
        for friction, end in (("0.2 - 0.1*t", 2.0), ("0.3*max(0, 1 - t) - 0.1*max(0, t - 2)", 2.0), ("0.5*t*(1 - t)", 1.0)):
            text = BODY.replace("vx = 1\n", "vx = 9\n").replace("0.3*t", friction).replace("until = 0.6", "until = 5")
            result = self.result(text, code=3)
            self.assertEqual(result["status"]["termination"], "outside_class", friction)
            self.assertAlmostEqual(result["status"]["time_reached"], end, delta=1e-9)
            self.assertIn("the friction of 'ground' turns negative", result["status"]["message"])

    def test_over_positions_where_time_stands_still(self):
        # x'' = -g (0.2 + 0.1 x) up to a stop; and friction that turns negative at x = 1, or 2 in a fall onto the ground.
        text = BODY.replace("0.3*t", "0.2 + 0.1*x").replace("until = 0.6", "until = 0.3")
        event = self.result(text)["final"]["x"]
        fesd = self.result(text, "--method", "fesd")["final"]["x"]
        for value, expected in zip(fesd, event):
            self.assertAlmostEqual(value, expected, delta=1e-7)
        text = BODY.replace("vx = 1\n", "vx = 9\n").replace("0.3*t", "0.2*(1 - x)")
        result = self.result(text, "--method", "fesd", code=3)
        self.assertEqual(result["status"]["termination"], "outside_class")
        self.assertAlmostEqual(result["final"]["x"][0], 1.0, delta=1e-7)
        self.assertIn("the friction of 'ground' turns negative at t = 0.1", result["status"]["message"])

    def test_over_time_needs_method_event(self):
        _, err = self.run_tool("simulate", self.write("m.toml", BODY), "--method", "fesd", code=2)
        self.assertIn("the friction of 'ground' depends on t, and time stands still", err)
        self.assertIn(f"m.toml:{LINE_OF_FRICTION}:", err)


class Restitution(tool.ResultTest):
    # Falls from z = 1 with vx = 1: impacts at t = sqrt(2/g), at x = t.
    FALL = BODY.replace("\nz = 0", "\nz = 1").replace("tangent = { x = 1 }\n", "")

    def fall(self, restitution, until=1.0, **how):
        text = self.FALL.replace('friction = "0.3*t"', f'restitution = "{restitution}"')
        return self.result(text.replace("until = 0.6", f"until = {until}"), **how)

    def test_is_that_of_the_impact(self):
        t = math.sqrt(2.0 / 9.81)
        for restitution, e in (("0.5 + 0.2*x", 0.5 + 0.2 * t), ("0.9 - t", 0.9 - t), ("min(1, 0.2 + max(0, x))", 0.2 + t),
                               ("max(0, x - 2)", 0.0)):
            rise = e * math.sqrt(2.0 * 9.81)
            result = self.fall(restitution, until=0.5)
            self.assertAlmostEqual(result["final"]["x"][3], rise - 9.81 * (0.5 - t) if e else 0.0, delta=1e-8)

    def test_out_of_range_stops_the_run(self):
        for restitution, value in (("0.9 + t", 0.9 + math.sqrt(2.0 / 9.81)), ("0.1 - x", 0.1 - math.sqrt(2.0 / 9.81))):
            result = self.fall(restitution, code=3)
            self.assertEqual(result["status"]["termination"], "outside_class")
            self.assertAlmostEqual(result["status"]["time_reached"], math.sqrt(2.0 / 9.81), delta=1e-9)
            self.assertIn(f"the restitution of 'ground' is {value:.6g} at the impact", result["status"]["message"])

    def test_that_falls_with_the_bounces(self):
        # e_k = 0.8 - 0.1 t_k at each impact; they accumulate at 2.338.
        t, v, impacts = math.sqrt(2.0 / 9.81), math.sqrt(2.0 * 9.81), []
        while len(impacts) < 12:
            impacts.append(t)
            v *= 0.8 - 0.1 * t
            t += 2.0 * v / 9.81
        result = self.fall("0.8 - 0.1*t", until=2.5)
        found = [event["t"] for event in result["events"] if event["kind"] == "impact"]
        for time, expected in zip(found, impacts):
            self.assertAlmostEqual(time, expected, delta=1e-7)
        self.assertGreater(len(found), 12)
        self.assertEqual(result["events"][-1]["kind"], "accumulation")

    def test_needs_method_event_where_it_varies(self):
        file = self.write("m.toml", self.FALL.replace('friction = "0.3*t"', 'restitution = "0.1*x"'))
        _, err = self.run_tool("simulate", file, "--method", "fesd", code=2)
        self.assertIn("the restitution of 'ground' varies", err)
        self.assertIn(f"m.toml:{LINE_OF_FRICTION - 1}:", err)

    def test_over_velocities(self):
        file = self.write("m.toml", self.FALL.replace('friction = "0.3*t"', 'restitution = "0.1*vx"'))
        _, err = self.run_tool("check", file, code=2)
        self.assertIn("the restitution of 'ground' depends on 'vx', which is no position and no parameter", err)


CAR = """
[model]
name = "a car whose turbo comes later and later"
[parameters]
start = 15
[states]
v = 12
[[hysteresis]]
name = "turbo"
input = "v"
on = "start + t"
off = "5 + 3*t"
[dynamics]
v = "if(turbo > 0.5, -1, 2)"
[simulate]
until = 3.5
rtol = 1e-10
atol = 1e-10
"""


LINE_OF_ON = 1 + CAR.splitlines().index('on = "start + t"')


def switches(result):
    return [event["t"] for event in result["events"] if event["kind"] == "jump"]


class Thresholds(tool.ResultTest):
    def test_over_time(self):
        # 12 + 2 t meets 15 + t at 3.
        result = self.result(CAR)
        (on,) = switches(result)
        self.assertAlmostEqual(on, 3.0, delta=1e-9)
        self.assertAlmostEqual(result["final"]["x"][0], 17.5, delta=1e-9)
        self.assertEqual(result["final"]["x"][1], 1)

    def test_both_are_met(self):
        # 18 - (t - 3) meets 5 + 3 t at 4; there 17 and from there on 17 + 2 (t - 4), and on at 15 + t again at 6.
        result = self.result(CAR.replace("until = 3.5", "until = 4.5"))
        self.assertEqual(len(switches(result)), 2)
        self.assertAlmostEqual(switches(result)[1], 4.0, delta=1e-9)
        self.assertEqual(result["final"]["x"][1], 0)
        self.assertAlmostEqual(result["final"]["x"][0], 18.0, delta=1e-9)

    def test_that_meet_stop_the_run(self):
        for off, end in (("5 + 3*t", 5.0), ("max(5, 9 + 2.2*t)", 5.0), ("min(5 + 4*t, start + t)", 10.0 / 3.0)):
            result = self.result(CAR.replace("5 + 3*t", off).replace("until = 3.5", "until = 8"), code=3)
            status = result["status"]
            self.assertEqual(status["termination"], "outside_class", off)
            self.assertAlmostEqual(status["time_reached"], end, delta=1e-8)
            self.assertIn(f"`on` and `off` of the hysteresis 'turbo' meet at {15.0 + end:.6g}", status["message"])
            self.assertTrue(result["events"])

    def test_that_are_equal_at_the_start(self):
        result = self.result(CAR.replace("5 + 3*t", "15 + 3*t"), code=3)
        self.assertEqual(result["status"]["time_reached"], 0)
        self.assertIn("'turbo' meet at 15", result["status"]["message"])

    def test_beyond_one_at_the_start(self):
        result = self.result(CAR.replace("v = 12", "v = 16").replace("until = 3.5", "until = 1"))
        self.assertEqual(result["final"]["x"], [15.0, 1])

    def test_a_thermostat_follows_its_set_point(self):
        # Heating by 2, cooling by 1 between 19 + t/2 (on) and 21 + t/2: 20 at 0, 21 + t/2 at 2/3, then 19 + t/2 at 2.
        text = CAR.replace("v = 12", "v = 20").replace("start + t", "19 + t/2").replace("5 + 3*t", "21 + t/2")
        text = text.replace("if(turbo > 0.5, -1, 2)", "if(turbo > 0.5, 2, -1)").replace("v = 20", "v = 20", 1)
        result = self.result(text.replace('name = "turbo"', 'name = "turbo"\ninitial = 1'))
        for t, expected in zip(switches(result), (2.0 / 3.0, 2.0, 2.0 + 4.0 / 3.0)):
            self.assertAlmostEqual(t, expected, delta=1e-9)
        self.assertEqual(len(switches(result)), 3)

    def test_need_method_event(self):
        file = self.write("m.toml", CAR)
        _, err = self.run_tool("simulate", file, "--method", "fesd", code=2)
        self.assertIn(f"m.toml:{LINE_OF_ON}:", err)
        self.assertIn("thresholds of the hysteresis 'turbo' vary", err)

    def test_over_a_state(self):
        file = self.write("m.toml", CAR.replace("start + t", "15 + v"))
        _, err = self.run_tool("check", file, code=2)
        self.assertIn(f"m.toml:{LINE_OF_ON}:", err)
        self.assertIn("`on` of the hysteresis 'turbo' depends on a state", err)


class Clock(tool.ResultTest):
    def test_may_be_the_name_of_a_state(self):
        text = CAR.replace("start + t", "15").replace("5 + 3*t", "14").replace("v = 12", "v = 12\nclock = 0")
        text = text.replace("[dynamics]", "[dynamics]\nclock = 2")
        for method in ("event", "fesd"):
            result = self.result(text, "--method", method)
            for value, expected in zip(result["final"]["x"], (14.5, 7.0, 1)):
                self.assertAlmostEqual(value, expected, delta=1e-8)


if __name__ == "__main__":
    tool.main()
