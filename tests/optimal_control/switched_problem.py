"""A random optimal control problem with switches, and a check of its result that shares nothing with the tool.

The collocation equations are solved again from the controls, lengths and selections of the file, and each interval is
simulated with small steps.
"""

import math
import random

from solved_checks import Faults, faults_of_certificate, ranges_of

# Radau IIA with two stages: matrix and weights, which are its last row.
A = [[5 / 12, -1 / 12], [3 / 4, 1 / 4]]
STEPS = 500  # of a simulated interval


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


class SwitchedProblem:
    """x' = M x + b u + sum_j c_j sign(psi_j), psi_j = a_j'x - d_j + e_j x_0^2, with cost sum q_i x_i^2 + r u^2.

    2 to 6 states and 1 to 3 surfaces; of a third of the problems some states grow by themselves.
    """

    family = "switches"
    tolerance = 1e-2  # of verification

    def __init__(self, seed):
        dice = random.Random(seed)
        number = lambda low, high: round(dice.uniform(low, high), 2)
        self.seed = seed
        self.n = dice.randint(2, 6)
        self.surfaces = dice.randint(1, 3)
        n, m = self.n, self.surfaces
        grows = dice.random() < 1 / 3
        self.matrix = [[number(-1, 1) for _ in range(n)] for _ in range(n)]
        for i in range(n):
            self.matrix[i][i] = number(-0.5, 1) if grows else number(-1, -0.1)
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
        self.intervals = dice.randint(6, 10)
        self.elements = m + dice.randint(1, 2)  # room for a switch of each surface in every interval
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
                  f"elements = {self.elements}", f"verification_tolerance = {self.tolerance}", f'running_cost = "{running}"']
        if self.soft:
            goals = " + ".join(f"{w}*({s} - ({goal}))^2" for (goal, w), s in zip(self.soft, states))
            lines.append(f'terminal_cost = "{goals}"')
        else:
            lines.append(f'terminal_constraints = ["x{self.target[0]} == {self.target[1]}"]')
        return "\n".join(lines) + "\n"

    def stages(self, x, u, h, signs):
        """The stage states: X_i = x + h sum_j A_ij f(X_j, u, signs_j), a linear system as f is affine."""
        n, s = self.n, len(A)
        matrix = [[0.0] * (n * s) for _ in range(n * s)]
        right = [0.0] * (n * s)
        constant = [self.field([0.0] * n, u, signs[j]) for j in range(s)]
        for i in range(s):
            for k in range(n):
                row = i * n + k
                matrix[row][row] += 1.0
                right[row] = x[k] + h * sum(A[i][j] * constant[j][k] for j in range(s))
                for j in range(s):
                    for c in range(n):
                        matrix[row][j * n + c] -= h * A[i][j] * self.matrix[k][c]
        flat = solve(matrix, right)
        return [flat[i * n:(i + 1) * n] for i in range(s)]

    def simulated(self, x, u, length):
        """Heun's method in small steps: of the order of a step at switches, which is enough to see a wrong one."""
        h = length / STEPS
        signs = lambda y: [math.copysign(1.0, self.psi(j, y)) for j in range(self.surfaces)]
        for _ in range(STEPS):
            first = self.field(x, u, signs(x))
            ahead = [v + h * d for v, d in zip(x, first)]
            second = self.field(ahead, u, signs(ahead))
            x = [v + h / 2 * (a + b) for v, a, b in zip(x, first, second)]
        return x

    def can_follow(self, result):
        """Whether small steps find its motion: where a surface repels, they leave one that is a solution along it."""
        verification = result["verification"]
        amplification = verification["open_loop"]["amplification"]
        return amplification is not None and amplification < 1e3 and not verification["message"]

    def faults(self, result):
        """What a completed result states that its own numbers do not bear out."""
        found = faults_of_certificate(result)
        points = result["elements"]["points"]
        selection, multiplier = result["elements"]["selection"], result["elements"]["lambda"]
        nodes = result["start_values"]["nodes"]
        follows, ranges = self.can_follow(result), ranges_of(nodes)
        x, objective, row = self.start, 0.0, 0
        for k, lengths in enumerate(result["h"]):
            u, start = result["u"][k][0], x
            found.expect(abs(u) <= self.bound * (1 + 1e-8), f"control {u} of interval {k}")
            found.expect_near(sum(lengths), self.horizon / self.intervals, 1e-8, f"length of interval {k}")
            for h in lengths:
                if h <= 1e-9:  # such an element is not written
                    continue
                selections = selection[row + 1:row + 1 + len(A)]
                stages = self.stages(x, u, h, [[2 * a - 1 for a in values] for values in selections])
                for m, stage in enumerate(stages):
                    objective += h * A[-1][m] * self.running(stage, u)
                    found += self.faults_of_sides(stage, selections[m], multiplier[row + 1 + m], k)
                x = stages[-1]
                row += points
            for i, value in enumerate(self.simulated(start, u, sum(lengths)) if follows else ()):
                found.expect_near(value, x[i], 0.02 * max(1.0, ranges[i]), f"x{i} simulated over interval {k}")
            for i in range(self.n):
                found.expect_near(x[i], nodes[k + 1][i], 1e-6 * max(1.0, ranges[i]), f"x{i} behind interval {k}")
        if self.target:
            found.expect_near(x[self.target[0]], self.target[1], 1e-6 * max(1.0, ranges[self.target[0]]), "target")
        found.expect_near(objective + self.terminal(x), result["objective"], 1e-6 * (1 + abs(objective)), "objective")
        return found

    def faults_of_sides(self, x, selections, multipliers, interval):
        """psi > 0 with selection 1, psi < 0 with selection 0, or psi = 0."""
        found = Faults()
        for j, alpha in enumerate(selections):
            psi, where = self.psi(j, x), f"s{j} in interval {interval}"
            found.expect_near(multipliers[j], psi, 1e-6 * max(1.0, abs(psi)), where)
            found.expect(-1e-7 <= alpha <= 1 + 1e-7, f"selection {alpha} of {where}")
            found.expect(min(max(psi, 0.0), 1 - alpha) <= 1e-7, f"selection {alpha} of {where}, which is {psi}")
            found.expect(min(max(-psi, 0.0), alpha) <= 1e-7, f"selection {alpha} of {where}, which is {psi}")
        return found
