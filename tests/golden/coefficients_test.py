"""Thresholds of a hysteresis over time, and a state called `clock` beside it."""

import tool

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
