"""Random optimal control problems, from outside: argv is the tool, then how many with switches (200) and contacts (10).

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
SWITCHES = int(sys.argv[2]) if len(sys.argv) > 2 else 200
CONTACTS = int(sys.argv[3]) if len(sys.argv) > 3 else 10
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
        outcomes, followed = {}, 0
        for seed in range(FIRST_SEED, FIRST_SEED + problems):
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
        return outcomes.get("completed", 0), followed

    def test_switches(self):
        completed, followed = self.check(SwitchedProblem, SWITCHES)
        self.assertGreaterEqual(completed, SWITCHES * 3 // 5)
        self.assertGreaterEqual(followed, SWITCHES // 3)

    def test_contacts(self):
        completed, followed = self.check(ContactProblem, CONTACTS)
        self.assertGreaterEqual(completed, CONTACTS // 4)
        self.assertEqual(followed, completed)



if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
