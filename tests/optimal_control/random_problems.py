"""Random optimal control problems, from outside: argv is the tool, and which of the seeds (1: all, 5: every fifth).

Each ends with a status within its limit. What is `completed` is checked by code that shares nothing with the tool
(switched_problem.py, contact_problem.py).
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

from contact_problem import ContactProblem
from switched_problem import SwitchedProblem

TOOL = sys.argv[1]
STEP = int(sys.argv[2]) if len(sys.argv) > 2 else 1
SWITCHES, CONTACTS = 200, 10
SECONDS = 600  # per problem, by the clock; most take a tenth of one
FIRST_SEED = 22_000


def optimized(problem):
    with tempfile.TemporaryDirectory() as folder:
        model, out = pathlib.Path(folder) / "model.toml", pathlib.Path(folder) / "r.json"
        model.write_text(problem.text(), encoding="utf-8")
        done = subprocess.run([TOOL, "optimize", str(model), "--quiet", "--time-limit", str(SECONDS), "--out", str(out)],
                              capture_output=True, text=True, timeout=4 * SECONDS, check=False)
        if done.returncode not in (0, 3):
            raise RuntimeError(f"exit code {done.returncode}: {done.stderr}")
        return done.returncode, json.loads(out.read_text(encoding="utf-8"))


class Checks(unittest.TestCase):
    def check(self, kind, problems):
        """How many there were, how many were completed, and how many of these a simulation follows."""
        outcomes, followed = {}, 0
        for seed in range(FIRST_SEED, FIRST_SEED + problems, STEP):
            with self.subTest(f"{kind.family} {seed}"):
                problem = kind(seed)
                code, result = optimized(problem)
                status = result["status"]["termination"]
                self.assertEqual(code, 0 if status == "completed" else 3)
                outcomes[status] = outcomes.get(status, 0) + 1
                if status == "completed":
                    self.assertEqual([], problem.faults(result))
                    followed += problem.can_follow(result)
        print(kind.family, outcomes, followed, "followed")
        return sum(outcomes.values()), outcomes.get("completed", 0), followed

    def test_switches(self):
        solved, completed, followed = self.check(SwitchedProblem, SWITCHES)
        self.assertGreaterEqual(completed, solved * 3 // 5)
        self.assertGreaterEqual(followed, solved // 3)

    def test_contacts(self):
        solved, completed, followed = self.check(ContactProblem, CONTACTS)
        self.assertGreaterEqual(completed, solved // 4)
        self.assertEqual(followed, completed)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
