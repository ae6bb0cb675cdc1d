"""scripts/same_events.py on results that are made by hand: argv is the source tree."""

import copy
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[1]) / "scripts"))
import same_events  # noqa: E402

EVENT = {"t": 2.0, "kind": "crossing", "name": None, "surfaces": ["s"], "mode_before": [-1], "mode_after": [1],
         "unique": True, "alternatives": [], "x": [4.0, 0.0], "x_after": [4.0, 0.0]}
RESULT = {
    "status": {"termination": "completed", "message": ""},
    "states": ["a", "b"],
    "options": {"simulate.rtol": 1e-6, "simulate.atol": 1e-8},
    "final": {"t": 3.0, "x": [-5.0, 1e-9], "mode": [1]},
    "events": [EVENT],
    "trajectory": {"t": [0.0, 2.0, 2.0, 3.0], "x": [[1.0, 0.0], [4.0, 0.0], [4.0, 0.0], [-5.0, 0.0]],
                   "mode": [[-1], [-1], [1], [1]]},
}


def changed(change):
    result = copy.deepcopy(RESULT)
    change(result)
    return result


def put(*path):
    """A change of one value: its place, then the value."""
    def change(result):
        for key in path[:-2]:
            result = result[key]
        result[path[-2]] = path[-1]
    return change


class SameEvents(unittest.TestCase):
    def decided(self, change):
        return same_events.compared(RESULT, changed(change))[0]

    def distance(self, change):
        decided, largest = same_events.compared(RESULT, changed(change))
        self.assertIsNone(decided)
        return largest

    def test_a_result_is_itself(self):
        self.assertEqual(same_events.compared(RESULT, copy.deepcopy(RESULT)), (None, (0.0, largest_place())))

    def test_what_is_decided_otherwise_is_said(self):
        for change, words in ((put("status", "termination", "max_steps"), "completed became max_steps"),
                              (put("events", []), "no crossing at t = 2.0"),
                              (put("events", [EVENT, EVENT]), "a new crossing at t = 2.0"),
                              (put("events", 0, "kind", "jump"), "kind crossing became jump"),
                              (put("events", 0, "surfaces", ["r"]), "surfaces ['s'] became ['r']"),
                              (put("events", 0, "unique", False), "unique True became False"),
                              (put("events", 0, "alternatives", [{"mode": [0], "alpha": [0.5]}]), "alternatives"),
                              (put("trajectory", "mode", 1, [0]), "mode of row 1 at t = 2.0"),
                              (put("trajectory", "t", [0.0, 3.0]), "4 rows became 2"),
                              (put("final", "mode", [0]), "mode at the end")):
            with self.subTest(words=words):
                self.assertIn(words, self.decided(change))

    def test_states_are_measured_by_their_largest_value(self):
        # 1e-6 * 5 + 1e-8 of the first, 1e-6 * 1e-9 + 1e-8 of the second.
        size, place = self.distance(put("final", "x", [-5.0 - 5.01e-6, 1e-9]))
        self.assertAlmostEqual(size, 1.0, places=6)
        self.assertEqual(place, "a of end, t = 3.0")
        size, place = self.distance(put("events", 0, "x_after", [4.0, 1e-9]))
        self.assertAlmostEqual(size, 0.1, places=6)
        self.assertEqual(place, "b of event 0, t = 2.0")

    def test_times_are_measured_by_themselves(self):
        size, place = self.distance(put("events", 0, "t", 2.0 + 2.01e-6))
        self.assertAlmostEqual(size, 1.0, places=6)
        self.assertEqual(place, "time of event 0, t = 2.0")

    def test_what_is_no_number_is_beyond_unless_it_is_equal(self):
        self.assertEqual(self.distance(put("final", "x", [None, 1e-9]))[0], float("inf"))
        nothing = put("final", "x", [None, float("nan")])
        self.assertEqual(same_events.compared(changed(nothing), changed(nothing))[1][0], 0.0)

    def test_rows_may_have_some_of_the_states(self):
        def few(result):
            result["kept_columns"] = {"states": ["b"], "switching_functions": ["s"]}
            result["trajectory"]["x"] = [[0.0], [0.0], [0.0], [value]]

        value = 0.0
        old = changed(few)
        value = 1e-8
        _, (size, place) = same_events.compared(old, changed(few))
        self.assertAlmostEqual(size, 1.0, places=6)
        self.assertEqual(place, "b of row 3, t = 3.0")

    def test_branches_are_compared(self):
        old = changed(put("branches", [copy.deepcopy(RESULT)]))
        new = copy.deepcopy(old)
        new["branches"][0]["final"]["mode"] = [0]
        self.assertIn("branch 0: mode at the end", same_events.compared(old, new)[0])
        self.assertIn("1 branches became 0", same_events.compared(old, RESULT)[0])

    def test_refusals_have_one_message(self):
        refused = {"exit": 2, "message": "no such model"}
        self.assertIsNone(same_events.compared(refused, dict(refused))[0])
        self.assertIn("no such model became a result", same_events.compared(refused, RESULT)[0])


def largest_place():
    """What is named where nothing differs: the last by its name."""
    return max(place for _, place in same_events.distances(RESULT, RESULT))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
