"""What multipliers of an optimum say: how the objective changes with what is asked for, by differences."""

import json
import unittest

import tool

BLOCK = (tool.SOURCE / "examples" / "optimize" / "block.toml").read_text(encoding="utf-8")
TERMINAL = '["q == 1", "v == 0"]'
STEP = 1e-3


class OptimumMultipliers(tool.ToolTest):
    def solve(self, intervals=10, q="1", v="0", limit=None):
        """Objective, multipliers by name (a list of entries each), certificate."""
        text = BLOCK.replace(TERMINAL, f'["q == {q}", "v == {v}"]').replace("control_intervals = 10", f"control_intervals = {intervals}")
        if limit is not None:
            text += f'path_constraints = ["v <= {limit}"]\n'
        self.write("m.toml", text)
        self.run_tool("optimize", "m.toml", "--quiet", "--out", "r.json", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        found = {}
        for entry in result["multipliers"]:
            found.setdefault(entry["name"], []).append(entry)
        return result["objective"], found, result["certificate"]

    def test_one_that_is_not_unique_is_the_slope_to_one_side(self):
        # v = 0 lies on the surface of sign(v): the branch can only end at v >= 0, or, with an element of length zero
        # behind v > 0, at v <= 0.
        for intervals in (10, 20, 30):
            objective, found, certificate = self.solve(intervals)
            (end,) = found["v == 0"]
            self.assertIsNone(end["value"])
            lower, upper = end["range"]
            self.assertEqual((lower, upper).count(None), 1)
            slope, to = (-upper, -STEP) if lower is None else (lower, STEP)
            beside = self.solve(intervals, v=str(to))[0]
            self.assertAlmostEqual((beside - objective) / STEP, -slope, delta=2e-3)
            self.assertIs(certificate["unique_multipliers"], False)
            self.assertIs(certificate["licq"], False)
            if upper is None:
                self.assertEqual(certificate["dependent_rows"], 1)
                self.assertIn("terminal constraint 'v == 0'", certificate["dependent"])
            else:  # equations of the element, too
                self.assertGreater(certificate["dependent_rows"], 1)
            # That of the distance is not touched by it.
            (distance,) = found["q == 1"]
            self.assertNotIn("range", distance)
            further = self.solve(intervals, q=str(1 + STEP))[0]
            self.assertAlmostEqual((further - objective) / STEP, -distance["value"], delta=1e-3)

    def test_those_that_are_unique_are_slopes_to_both_sides(self):
        objective, found, certificate = self.solve(v="0.3")
        self.assertIs(certificate["unique_multipliers"], True)
        for name, more, less in (("q == 1", {"q": str(1 + STEP)}, {"q": str(1 - STEP)}),
                                 ("v == 0.3", {"v": str(0.3 + STEP)}, {"v": str(0.3 - STEP)})):
            (entry,) = found[name]
            above, below = self.solve(**{"v": "0.3", **more})[0], self.solve(**{"v": "0.3", **less})[0]
            self.assertAlmostEqual((above - below) / (2 * STEP), -entry["value"], delta=1e-4, msg=name)

    def test_those_of_a_path_constraint_add_up(self):
        objective, found, _ = self.solve(v="0.3", limit="0.7")
        (name,) = [name for name in found if name.startswith("v") and "<=" in name]
        values = [entry["value"] for entry in found[name]]
        self.assertNotIn(None, values)
        self.assertGreaterEqual(min(values), 0.0)
        higher = self.solve(v="0.3", limit=str(0.7 + STEP))[0]
        self.assertAlmostEqual((higher - objective) / STEP, -sum(values), delta=2e-3)


if __name__ == "__main__":
    tool.main()
