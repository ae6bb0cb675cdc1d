"""saltus optimize compares guesses of the states where the simulated ones are a bad guess."""

import json

import tool

# A rod that stands nearly upright. Under its guessed control it falls, or is driven round; the cost has a basin at every turn.
ROD = """
[model]
name = "a rod is held upright"
[states]
a = 0.1
w = 0
[controls]
u = { lower = -20, upper = 20 }
[dynamics]
a = "w"
w = "9.81*sin(a) + u - 0.3*sign(w)"
[optimize]
horizon = 6
control_intervals = 30
running_cost = "10*(1 - cos(a)) + 0.02*a^2 + 0.01*u^2"
"""
UPRIGHT = 0.0245353  # from constant states, by themselves; 18.9 and 44.6 are found from the simulated ones by themselves

# All guesses cost the same. From the straight line nothing is solved: the motion goes round once more.
ONCE_MORE = """
[model]
name = "an oscillator whose control is frozen while x2 < 0"
[states]
x1 = 2.5
x2 = 4
lam = { initial = 0, lower = -1, upper = 1, free = true }
[controls]
u = { lower = -1, upper = 1 }
v = { lower = -20, upper = 20 }
[dynamics]
x1 = "x2"
x2 = "if(x2 > 0, u, lam) - x1"
lam = "if(x2 > 0, v, 0)"
[optimize]
horizon = { free = true, initial = 8, lower = 1, upper = 20 }
control_intervals = 20
stages = 3
minimize_time = true
terminal_constraints = ["x1 == 0", "x2 == 0"]
"""

# All guesses cost the same: nothing but the time counts, which is not a state.
CAR = (tool.SOURCE / "models/turbo-car.toml").read_text(encoding="utf-8")


class ComparedStarts(tool.ToolTest):
    def optimized(self, model, *arguments):
        self.write("m.toml", model)
        self.run_tool("optimize", "m.toml", "--quiet", "--out", "r.json", *arguments, code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    @staticmethod
    def begins(result):
        return {step["message"] for step in result["homotopy"] if step.get("message", "").startswith("begins at")}

    def test_a_rod_that_falls_is_held(self):
        result = self.optimized(ROD)
        self.assertEqual(result["status"]["termination"], "completed")
        self.assertAlmostEqual(result["objective"], UPRIGHT, delta=1e-5)
        self.assertLessEqual({"begins at constant states", "begins at states that costs and terminal constraints name"}, self.begins(result))

    def test_a_rod_that_is_driven_round_is_held(self):
        model = ROD.replace("u = { lower", "u = { initial = 5, lower").replace(" + 0.02*a^2", "")
        self.assertLess(self.optimized(model)["objective"], 0.03)

    def test_one_start_where_states_are_given(self):
        guess = '[optimize.initial_guess]\na = "0.1"\nw = 0\n'
        given = self.optimized(ROD + guess)
        self.assertEqual(self.begins(given), {"begins at selections by the signs of the guessed states"})
        self.assertAlmostEqual(given["objective"], UPRIGHT, delta=1e-5)
        self.assertEqual(self.begins(self.optimized(ROD, "--start", "r.json")), set())

    def test_others_are_tried_where_nothing_is_solved(self):
        result = self.optimized(ONCE_MORE)
        self.assertAlmostEqual(result["objective"], 9.6332, delta=1e-3)  # arcs of circles; 9.6291 with free switching
        self.assertIn("begins at constant states", self.begins(result))

    def test_sigma_falls_by_smaller_steps_where_whole_ones_fail(self):
        result = self.optimized(ONCE_MORE.replace("stages = 3\n", ""))
        self.assertAlmostEqual(result["objective"], 9.63298, delta=1e-3)  # 3 stages: 9.6332
        self.assertIn("begins at the motion of the guessed controls", self.begins(result))
        sigmas = {f"{step['sigma']:.0e}" for step in result["homotopy"] if step["phase"] == "relaxed"}
        self.assertIn("3e-02", sigmas)

    def test_starts_that_cost_the_same_are_followed_from_the_large_sigma(self):
        result = self.optimized(CAR)
        self.assertGreaterEqual(len(self.begins(result)), 1)
        self.assertTrue(all(step["sigma"] > 1.0 for step in result["homotopy"] if step.get("message", "").startswith("begins at")))
        self.assertAlmostEqual(result["objective"], 40.0 / 3.0, delta=1e-6)


if __name__ == "__main__":
    tool.main()
