"""Models whose modes are discrete states, or that have no states at all: from the file to the result."""

import json
import math

import tool

MACHINE = """[model]
name = "machine"
[states]
x = 1
q = 0
last = 0
peak = 0
[dynamics]
q = 0
last = 0
peak = 0
[[modes]]
when = "q == 0"
dynamics = { x = "-x" }
[[modes]]
when = "q == 1"
dynamics = { x = "2 - x" }
[[modes]]
when = "otherwise"
dynamics = { x = "if(t - last > 0.5, 1, -1)" }
[[jumps]]
name = "low"
when = "x < 0.5 and q == 0"
set = { q = 1, last = "t" }
[[jumps]]
name = "high"
when = "q == 1 and x > 1.5"
set = { q = 2, last = "t", peak = "x" }
[[jumps]]
name = "back"
when = "q >= 2 and x > 1.5 and t > last + 0.1"
set = { q = 0, last = "t" }
[simulate]
until = 4
"""

CLOCK = """[model]
name = "clock"
[states]
[outputs]
side = "sign(sin(t))"
[[events]]
when = "sin(3*t)"
direction = "up"
[simulate]
until = 10
"""


# S4 is set back whenever it passes S2, which falls to 1/2: there the jumps change nothing any more.
SET_BACK = """[model]
name = "set-back"
[states]
S1 = 1
S2 = 2
S4 = 0
[dynamics]
S1 = "-0.1*S1"
S2 = "-0.3*S2"
S4 = "S1"
[[jumps]]
name = "back"
when = "S4 > S2"
set = { S1 = 1, S4 = 0.5 }
[simulate]
until = 10
"""

# Two jumps with one condition: the first takes it away from the second.
TWO_PRIORITIES = """[model]
name = "two-priorities"
[states]
first = 0
second = 0
last = 0
[dynamics]
first = 0
second = 0
last = 0
[[jumps]]
name = "rising"
when = "t - last >= 0.01"
priority = "t"
persistent = false
set = { last = "t", first = "first + 1" }
[[jumps]]
name = "constant"
when = "t - last >= 0.01"
priority = "5.001"
persistent = false
set = { last = "t", second = "second + 1" }
[simulate]
until = 10
"""

GATED = """[model]
name = "gated"
[states]
x = 0
y = 0
on = 0
[dynamics]
x = "if(on*(t-3) > 0, 10, 1)"
y = "if(on*(x-1.5) >= 0, 1, -1)"
on = 0
[[jumps]]
at = [1, 2, 3.5]
set = { on = "1 - on" }
[simulate]
until = 5
"""


class DiscreteStates(tool.ToolTest):
    def simulated(self, text, *arguments):
        self.run_tool("simulate", self.write("model.toml", text), "--quiet", "--out", "r.json", *arguments, code=0)
        return json.loads((self.folder / "r.json").read_text())

    def test_a_machine_goes_through_its_modes(self):
        result = self.simulated(MACHINE)
        jumps = [(event["surfaces"], event["t"]) for event in result["events"] if event["kind"] == "jump"]
        self.assertEqual([surfaces for surfaces, _ in jumps], [["low"], ["high"], ["back"], ["low"]])
        low = math.log(2)  # e^-t = 1/2
        high = low + math.log(3)  # 2 - 3/2 e^-s = 3/2
        back = high + 1.0  # down by 1/2 and up again
        for (_, found), expected in zip(jumps, [low, high, back, back + math.log(3)]):
            self.assertAlmostEqual(found, expected, delta=1e-7)
        self.assertAlmostEqual(result["final"]["x"][3], 1.5, delta=1e-8)
        # While q stands at 1, the functions of q == 0 and q == 1 have the signs as written: no 0, nothing slides.
        names = result["switching_functions"]
        for event in result["events"]:
            for k in event["mode_after"] or []:
                self.assertIn(k, [-1, 1])
        self.assertEqual(set(names), {"q-0", "0-q", "q-1", "1-q", "t-last-0.5"})

    def test_another_mode_can_be_set_at_the_start(self):
        result = self.simulated(MACHINE, "--set", "q=1")
        first = next(event for event in result["events"] if event["kind"] == "jump")
        self.assertEqual(first["surfaces"], ["high"])
        self.assertAlmostEqual(first["t"], math.log(2), delta=1e-7)  # 2 - e^-t = 3/2

    def test_a_function_that_a_discrete_state_makes_vanish_is_decided_as_written(self):
        result = self.simulated(GATED)
        # x' = 10 from 3.5 on; y' = -1 only where on is 1 and x < 1.5, from t = 1 to 1.5.
        for found, expected in zip(result["final"]["x"], [18.5, 4.0, 1.0]):
            self.assertAlmostEqual(found, expected, delta=1e-9)
        self.assertEqual([(event["kind"], round(event["t"], 9)) for event in result["events"]],
                         [("jump", 1.0), ("crossing", 1.5), ("jump", 2.0), ("jump", 3.5)])

    def test_jumps_end_where_they_change_nothing_any_more(self):
        result = self.simulated(SET_BACK)
        self.assertEqual(result["status"]["termination"], "completed")
        limit = result["events"][-1]
        self.assertEqual(limit["kind"], "accumulation")
        end = math.log(4) / 0.3
        self.assertAlmostEqual(limit["t"], end, delta=1e-8)
        grown = 0.5 + 10 * (1 - math.exp(-0.1 * (10 - end)))
        for found, expected in zip(result["final"]["x"], [math.exp(-0.1 * (10 - end)), 2 * math.exp(-3), grown]):
            self.assertAlmostEqual(found, expected, delta=1e-7)

    def test_one_condition_of_two_jumps_becomes_true_at_once(self):
        result = self.simulated(TWO_PRIORITIES)
        self.assertEqual(len(result["events"]), 1000)
        wrong = [event["t"] for event in result["events"]
                 if event["surfaces"] != ["constant" if event["t"] < 5.001 else "rising"]]
        self.assertEqual(wrong, [])

    def test_a_model_without_states_has_outputs_and_events_of_time(self):
        result = self.simulated(CLOCK)
        times = [event["t"] for event in result["events"]]
        self.assertEqual(len(times), 4)
        for k, found in enumerate(times):
            self.assertAlmostEqual(found, 2 * math.pi * (k + 1) / 3, delta=1e-12)
        self.assertEqual(result["final"]["outputs"], [-1])
        empty = self.write("empty.toml", '[model]\nname = "nothing"\n[simulate]\nuntil = 1\n')
        _, err = self.run_tool("simulate", empty, code=2)
        self.assertIn("the model has no states", err)


if __name__ == "__main__":
    tool.main()
