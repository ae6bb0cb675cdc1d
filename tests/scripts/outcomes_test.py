"""tests/robustness/outcomes.py on outcomes that are made by hand: argv is the source tree."""

import contextlib
import io
import sys
import tempfile
import types
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[1]) / "tests" / "robustness"))
import outcomes  # noqa: E402

ROW = ("completed", "2", "1cd9", "1.234568", "-0.1234568")


def event(kind, t, name=None, surfaces=()):
    return types.SimpleNamespace(kind=kind, t=t, name=name, surfaces=surfaces)


class Outcomes(unittest.TestCase):
    def test_numbers_have_seven_digits_or_seven_decimals(self):
        for value, text in ((1234.56789, "1234.568"), (0.123456789, "0.1234568"), (-1e-9, "0"), (1e-7, "1e-07"),
                            (float("nan"), "nan"), (float("-inf"), "-inf")):
            with self.subTest(text=text):
                self.assertEqual(outcomes.rounded(value), text)

    def test_a_line_has_what_came_of_a_run(self):
        line = outcomes.line_of(7, "completed", [event("jump", 0.5, "j"), event("jump", 0.75, "j", ("s",))], [1.0, -0.25])
        seed, status, count, kinds, _, times, end, x = line.split(",")
        self.assertEqual((seed, status, count, kinds, times, end, x),
                         ("7", "completed", "2", "jump:2", "1.25", "0.5", "1;-0.25"))

    def test_the_hash_is_that_of_the_program(self):
        # FNV-1a of nothing is 811c9dc5.
        self.assertEqual(outcomes.hash_of([]), 0x811C ^ 0x9DC5)
        self.assertNotEqual(outcomes.hash_of(["ab", ""]), outcomes.hash_of(["a", "b"]))

    def test_what_differs_is_named(self):
        for place, other, what in ((0, "max_steps", "status"), (1, "3", "events"), (2, "1cd8", "events"),
                                   (3, "1.234571", "times"), (4, "-0.1234588", "end"), (4, "nan", "end"),
                                   (3, "1.234567", None), (4, "-0.1234567", None)):
            with self.subTest(place=place, other=other):
                row = (*ROW[:place], other, *ROW[place + 1:])
                self.assertEqual(outcomes.differs(ROW, row, 1e-6), what)

    def test_a_record_is_read_as_it_was_written(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "outcomes" / "affine.csv.gz"
            outcomes.record(file, "affine", 17, [ROW, ROW])
            self.assertEqual(outcomes.recorded(file), (17, [ROW, ROW]))

    def test_seeds_that_differ_are_listed(self):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            count = outcomes.compare("affine", 17, [ROW, ROW], [ROW, ("max_steps", *ROW[1:])], 1e-6)
        self.assertEqual(count, 1)
        self.assertIn("affine: 2 seeds, 1 differ\n  status: 1 seeds: 18\n", out.getvalue())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
