"""Optimal control problems of the catalogue, as they are shipped, from outside: argv is the tool, the source tree, and --all.

Those that take seconds; with --all every one (the preset `nightly`). What is `completed` has small residuals, is B-stationary, and was confirmed by the simulation of its controls."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOL = sys.argv[1]
MODELS = pathlib.Path(sys.argv[2]) / "models"
ALL = "--all" in sys.argv
# At most five seconds of one core each.
QUICK = {"ball-to-rest", "cart-pole", "estimator", "hysteresis-car", "slide-and-hide",
         "slide-and-hide-rates", "stewart-anitescu", "throw-mirrored", "turbo-car", "turbo-hysteresis", "two-carts",
         "voice-coil", "voice-coil-time"}
# Takes too long even at night: stopped by a time limit, which it says.
LONG = {"monoped"}
SECONDS, SECONDS_OF_LONG = 3600, 10  # by the clock


def problems():
    """All names, and those that are solved here."""
    names = sorted(path.stem for path in MODELS.rglob("*.toml") if "\n[optimize]" in path.read_text(encoding="utf-8"))
    return names, [name for name in names if ALL or name in QUICK | LONG]


class Catalogue(unittest.TestCase):
    def check(self, name):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "r.json"
            is_long = name in LONG
            limit = SECONDS_OF_LONG if is_long else SECONDS
            done = subprocess.run([TOOL, "optimize", name, "--quiet", "--time-limit", str(limit), "--out", str(file)],
                                  capture_output=True, text=True, timeout=2 * SECONDS)
            result = json.loads(file.read_text(encoding="utf-8"))
        status = result["status"]["termination"]
        self.assertEqual(done.returncode, 0 if status == "completed" else 3, done.stderr)
        if not is_long:
            self.assertEqual(status, "completed", result["status"]["message"])
        if status != "completed":
            return
        certificate = result["certificate"]
        for residual in ("primal_infeasibility", "complementarity_residual", "stationarity"):
            self.assertLessEqual(certificate[residual], 1e-8)
        self.assertIs(certificate["b_stationary"], True)
        self.assertLessEqual(result["verification"]["interval_defect"], result["verification"]["tolerance"])

    def test_problems(self):
        names, solved = problems()
        self.assertGreaterEqual(len(names), 25)
        self.assertLessEqual(QUICK | LONG, set(names))
        for name in solved:
            with self.subTest(name):
                self.check(name)


unittest.main(argv=[sys.argv[0], "-v"])
