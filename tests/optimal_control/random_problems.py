"""Random optimal control problems, from outside: argv is the tool, then the number of problems (default 200).

Each ends with a status within its limit. What is `completed` is checked by code that shares nothing with the tool: the
collocation equations are solved again from the controls, lengths and selections of the file, and each interval is
simulated with small steps."""

import json
import math
import pathlib
import random
import subprocess
import sys
import tempfile
import unittest

TOOL = sys.argv[1]
PROBLEMS = int(sys.argv[2]) if len(sys.argv) > 2 else 200
SECONDS = 600  # per problem, by the clock; most take a tenth of one
FIRST_SEED = 22_000

# Radau IIA with two stages: matrix and weights, which are its last row.
A = [[5 / 12, -1 / 12], [3 / 4, 1 / 4]]


def solve(matrix, right):
    """Gaussian elimination with pivots by rows."""
    n = len(right)
    rows = [list(row) + [value] for row, value in zip(matrix, right)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            for j in range(k, n + 1):
                rows[i][j] -= factor * rows[k][j]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][j] * x[j] for j in range(i + 1, n))) / rows[i][i]
    return x


class Problem:
    """x' = M x + b u + sum_j c_j sign(psi_j), psi_j = a_j'x - d_j + e_j x_0^2, with cost sum q_i x_i^2 + r u^2."""

    def __init__(self, seed):
        dice = random.Random(seed)
        number = lambda low, high: round(dice.uniform(low, high), 2)
        self.seed = seed
        self.n = dice.randint(2, 4)
        self.surfaces = dice.randint(1, 2)
        n, m = self.n, self.surfaces
        self.matrix = [[number(-1, 1) for _ in range(n)] for _ in range(n)]
        for i in range(n):
            self.matrix[i][i] = number(-1, -0.1)
        self.gain = [number(-1, 1) for _ in range(n)]
        self.gain[dice.randrange(n)] = number(1, 2)
        self.jump = [[number(-1, 1) for _ in range(n)] for _ in range(m)]
        self.normal = [[number(-1, 1) for _ in range(n)] for _ in range(m)]
        for normal in self.normal:
            normal[dice.randrange(n)] = dice.choice([-1.0, 1.0])
        self.level = [number(-0.5, 0.5) for _ in range(m)]
        self.bend = [dice.choice([0.0, 0.0, number(-0.3, 0.3)]) for _ in range(m)]
        self.start = [number(-1.5, 1.5) for _ in range(n)]
        self.cost = [number(0, 2) for _ in range(n)]
        self.effort = number(0.05, 1)
        self.horizon = number(1, 3)
        self.intervals = dice.randint(2, 5)
        self.elements = dice.randint(2, 3)
        self.bound = number(1, 4)
        self.target = (dice.randrange(n), number(-1, 1)) if dice.random() < 0.5 else None
        self.soft = None if self.target else [(number(-1, 1), number(1, 20)) for _ in range(n)]

    def psi(self, j, x):
        return sum(a * v for a, v in zip(self.normal[j], x)) - self.level[j] + self.bend[j] * x[0] ** 2

    def field(self, x, u, signs):
        return [sum(self.matrix[i][k] * x[k] for k in range(self.n)) + self.gain[i] * u +
                sum(self.jump[j][i] * signs[j] for j in range(self.surfaces)) for i in range(self.n)]

    def running(self, x, u):
        return sum(q * v * v for q, v in zip(self.cost, x)) + self.effort * u * u

    def terminal(self, x):
        return sum(w * (v - goal) ** 2 for (goal, w), v in zip(self.soft, x)) if self.soft else 0.0

    def text(self):
        states = [f"x{i}" for i in range(self.n)]
        surfaces = [" + ".join(f"{a}*{s}" for a, s in zip(self.normal[j], states)) +
                    f" - ({self.level[j]}) + ({self.bend[j]})*x0^2" for j in range(self.surfaces)]
        lines = ["[model]", f'name = "random-{self.seed}"', "[states]"]
        lines += [f"{s} = {v}" for s, v in zip(states, self.start)]
        lines += ["[controls]", f"u = {{ lower = {-self.bound}, upper = {self.bound} }}", "[switching]"]
        lines += [f's{j} = "{text}"' for j, text in enumerate(surfaces)] + ["[dynamics]"]
        for i, state in enumerate(states):
            terms = [f"({self.matrix[i][k]})*{s}" for k, s in enumerate(states)] + [f"({self.gain[i]})*u"]
            terms += [f"({self.jump[j][i]})*sign(s{j})" for j in range(self.surfaces)]
            lines.append(f'{state} = "{" + ".join(terms)}"')
        running = " + ".join([f"{q}*{s}^2" for q, s in zip(self.cost, states)] + [f"{self.effort}*u^2"])
        lines += ["[optimize]", f"horizon = {self.horizon}", f"control_intervals = {self.intervals}",
                  f"elements = {self.elements}", "verification_tolerance = 1e-2", f'running_cost = "{running}"']
        if self.soft:
            goals = " + ".join(f"{w}*({s} - ({goal}))^2" for (goal, w), s in zip(self.soft, states))
            lines.append(f'terminal_cost = "{goals}"')
        else:
            lines.append(f'terminal_constraints = ["x{self.target[0]} == {self.target[1]}"]')
        return "\n".join(lines) + "\n"


def stages_of(problem, x, u, h, signs):
    """The stage states: X_i = x + h sum_j A_ij f(X_j, u, signs_j), a linear system as f is affine."""
    n, s = problem.n, len(A)
    matrix = [[0.0] * (n * s) for _ in range(n * s)]
    right = [0.0] * (n * s)
    constant = [problem.field([0.0] * n, u, signs[j]) for j in range(s)]
    for i in range(s):
        for k in range(n):
            row = i * n + k
            matrix[row][row] += 1.0
            right[row] = x[k] + h * sum(A[i][j] * constant[j][k] for j in range(s))
            for j in range(s):
                for c in range(n):
                    matrix[row][j * n + c] -= h * A[i][j] * problem.matrix[k][c]
    flat = solve(matrix, right)
    return [flat[i * n:(i + 1) * n] for i in range(s)]


def simulated(problem, x, u, length):
    """Heun's method in small steps: of the order of a step at switches, which is enough to see a wrong one."""
    steps = 1000
    h = length / steps
    signs = lambda y: [math.copysign(1.0, problem.psi(j, y)) for j in range(problem.surfaces)]
    for _ in range(steps):
        first = problem.field(x, u, signs(x))
        ahead = [v + h * d for v, d in zip(x, first)]
        second = problem.field(ahead, u, signs(ahead))
        x = [v + h / 2 * (a + b) for v, a, b in zip(x, first, second)]
    return x


class Checks(unittest.TestCase):
    outcomes, followed = {}, []

    def optimized(self, problem):
        with tempfile.TemporaryDirectory() as folder:
            model, out = pathlib.Path(folder) / "model.toml", pathlib.Path(folder) / "r.json"
            model.write_text(problem.text(), encoding="utf-8")
            done = subprocess.run([TOOL, "optimize", str(model), "--quiet", "--time-limit", str(SECONDS), "--out", str(out)],
                                  capture_output=True, text=True, timeout=4 * SECONDS)
            self.assertIn(done.returncode, (0, 3), done.stderr)
            return done, json.loads(out.read_text(encoding="utf-8"))

    def check_completed(self, problem, result):
        points = result["elements"]["points"]
        selection, multiplier = result["elements"]["selection"], result["elements"]["lambda"]
        self.assertEqual([s["form"] for s in result["elements"]["selections"]], ["step"] * problem.surfaces)
        nodes = result["start_values"]["nodes"]
        x, objective, row = problem.start, 0.0, 0
        # Where a surface repels, small steps leave a motion along it that is a solution; the file says so.
        verification = result["verification"]
        amplification = verification["open_loop"]["amplification"]
        is_followed = amplification is not None and amplification < 1e3 and not verification["message"]
        self.followed += [is_followed]
        ranges = [max(max(node[i] for node in nodes) - min(node[i] for node in nodes), 1e-6) for i in range(problem.n)]
        for k, lengths in enumerate(result["h"]):
            u = result["u"][k][0]
            self.assertLessEqual(abs(u), problem.bound * (1 + 1e-8))
            self.assertAlmostEqual(sum(lengths), problem.horizon / problem.intervals, delta=1e-8)
            start = x
            for h in lengths:
                if h <= 1e-9:  # such an element is not written
                    continue
                signs = [[2 * a - 1 for a in selection[row + 1 + m]] for m in range(len(A))]
                stages = stages_of(problem, x, u, h, signs)
                for m, stage in enumerate(stages):
                    objective += h * A[-1][m] * problem.running(stage, u)
                    for j in range(problem.surfaces):
                        psi, alpha = problem.psi(j, stage), selection[row + 1 + m][j]
                        self.assertAlmostEqual(multiplier[row + 1 + m][j], psi, delta=1e-6)
                        self.assertGreaterEqual(alpha, -1e-7)
                        self.assertLessEqual(alpha, 1 + 1e-7)
                        self.assertLessEqual(min(max(psi, 0.0), 1 - alpha), 1e-7)
                        self.assertLessEqual(min(max(-psi, 0.0), alpha), 1e-7)
                x = stages[-1]
                row += points
            if is_followed:
                for i, value in enumerate(simulated(problem, start, u, sum(lengths))):
                    self.assertAlmostEqual(value, x[i], delta=0.02 * max(1.0, ranges[i]))
            for i in range(problem.n):
                self.assertAlmostEqual(x[i], nodes[k + 1][i], delta=1e-6)
        if problem.target:
            self.assertAlmostEqual(x[problem.target[0]], problem.target[1], delta=1e-6)
        self.assertAlmostEqual(objective + problem.terminal(x), result["objective"], delta=1e-6 * (1 + abs(objective)))

    def test_problems(self):
        for seed in range(FIRST_SEED, FIRST_SEED + PROBLEMS):
            with self.subTest(seed):
                problem = Problem(seed)
                done, result = self.optimized(problem)
                status = result["status"]["termination"]
                self.assertEqual(done.returncode, 0 if status == "completed" else 3)
                self.outcomes[status] = self.outcomes.get(status, 0) + 1
                if status == "completed":
                    self.check_completed(problem, result)
        print(self.outcomes, sum(self.followed), "followed")
        self.assertGreaterEqual(self.outcomes.get("completed", 0), PROBLEMS * 3 // 5)
        self.assertGreaterEqual(sum(self.followed), PROBLEMS // 2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
