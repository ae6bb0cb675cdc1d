"""Competitor (c): SciPy's solve_ivp with one terminal event at a time and a restart behind each; modes, sliding fields
and the choice of the next event by hand. Every mode has one guard: positive in the mode, zero at its end."""

import sys

import gene_ring
import numpy
import python_protocol
from scipy.integrate import solve_ivp


class StickSlip:
    until = 1000.0
    start = (0.04, -0.01)

    def __init__(self):
        self.mode = "slower"

    def field(self, _t, x):
        if self.mode == "stuck":
            return x[1], 0.0
        return x[1], -x[0] + (1 / (1.2 - x[1]) if self.mode == "slower" else -1 / (0.8 + x[1]))

    def guard(self, _t, x):
        if self.mode == "stuck":
            return 1 - x[0]
        return 0.2 - x[1] if self.mode == "slower" else x[1] - 0.2

    def cross(self, x):
        if self.mode == "stuck":
            self.mode = "slower"
            return 1.0, x[1]
        self.mode = "stuck" if abs(x[0]) < 1 else "faster" if self.mode == "slower" else "slower"
        return x[0], 0.2


class Relay:
    until = 10.0
    start = (0.0, -0.001, -0.02)
    w, xi = 25.0, 0.05
    matrix = numpy.array([[-(2 * xi * w + 1), 1, 0], [-(2 * xi * w + w * w), 0, 1], [-w * w, 0, 0]])
    input = numpy.array([1.0, -2.0, 1.0])

    def __init__(self):
        self.side = 0

    def field(self, _t, x):
        if self.side == 0:
            return 0.0, x[2] + 2 * x[1], -x[1]
        return self.matrix @ x - self.side * self.input

    def guard(self, _t, x):
        return 1 - abs(x[1]) if self.side == 0 else self.side * x[0]

    def cross(self, x):
        if self.side == 0:
            self.side = 1 if x[1] > 0 else -1
            return 0.0, float(self.side), x[2]
        self.side = 0 if abs(x[1]) < 1 else -self.side
        return 0.0, x[1], x[2]


class Network:
    """x' = production - decay x, monotone between switches: the guard is the distance to the nearest threshold."""

    def __init__(self, start, decay, thresholds, produce):
        self.start, self.decay = numpy.array(start), numpy.array(decay)
        self.thresholds, self.produce = thresholds, produce
        self.levels = [sum(own > threshold for threshold in row) for own, row in zip(self.start, thresholds)]
        self.look_ahead(self.start)

    def look_ahead(self, x):
        self.production = numpy.array(self.produce(self.levels))
        self.direction = numpy.where(self.production > self.decay * x, 1.0, -1.0)
        self.bound = numpy.array([self.ahead(i) for i in range(len(x))])

    def ahead(self, i):
        j = self.levels[i] if self.direction[i] > 0 else self.levels[i] - 1
        return self.thresholds[i][j] if 0 <= j < len(self.thresholds[i]) else self.direction[i] * 1e9

    def field(self, _t, x):
        return self.production - self.decay * x

    def guard(self, _t, x):
        return (self.direction * (self.bound - x)).min()

    def cross(self, x):
        i = int((self.direction * (self.bound - x)).argmin())
        x = x.copy()
        x[i] = self.bound[i]
        self.levels[i] += int(self.direction[i])
        self.look_ahead(x)
        return x


class Irma(Network):
    until = 1000.0

    def __init__(self):
        super().__init__((0.011, 0.09, 0.04, 0.05, 0.015), (0.05, 0.04, 0.05, 0.02, 0.6),
                         ((0.01,), (0.01, 0.06, 0.08), (0.035,), (0.04,), (0.01,)), self.produced)

    @staticmethod
    def produced(levels):
        low = levels[1] > 0
        return (1.1e-4 + 9e-4 * (levels[3] > 0), 3e-4 + 0.15 * (levels[0] > 0), 6e-4 + 0.018 * (levels[1] > 1),
                5e-4 * low + 0.03 * low * (levels[2] == 0), 7.5e-4 + 0.015 * (levels[1] > 2))


class Ring(Network):
    until = float(gene_ring.UNTIL)

    def __init__(self, inactive):
        network = gene_ring.Network(inactive)
        most = 2 * inactive + 2
        drive = numpy.concatenate([[0.0], numpy.cumsum([float(network.weight(j)) for j in range(most)])])
        constant = float(network.constant[0])

        def produced(levels):
            driven = [constant + drive[level] for level in levels]
            return [constant + drive[most] - drive[levels[-1]], *driven[:-1]]

        thresholds = [[float(threshold) for threshold in row] for row in network.thresholds]
        super().__init__([start / 1000 for start in network.start], [float(d) for d in network.decay], thresholds,
                         produced)


PROBLEMS = {"stick-slip": StickSlip, "relay-feedback": Relay, "irma": Irma,
            "gene-ring": lambda: Ring(gene_ring.INACTIVE), "gene-ring-active": lambda: Ring(0)}
METHODS = {"dopri5": "RK45", "dop853": "DOP853"}


def solve(make, method, tolerance):
    problem = make()

    def guard(t, x):
        return problem.guard(t, x)

    guard.terminal, guard.direction = True, -1
    t, x = 0.0, problem.start
    run = {"status": "completed", "events": [], "steps": 0, "evaluations": 0}
    while t < problem.until:
        piece = solve_ivp(problem.field, (t, problem.until), x, method=method, rtol=tolerance, atol=0.01 * tolerance,
                          events=guard)
        run["steps"] += len(piece.t) - 1
        run["evaluations"] += piece.nfev
        t, x = float(piece.t[-1]), piece.y[:, -1]
        if piece.status != 1:
            if piece.status != 0:
                run["status"] = piece.message
            break
        run["events"].append(t)
        if len(run["events"]) > 5000:
            run["status"] = "the same event again and again"
            break
        x = problem.cross(x)
    return {**run, "x": [float(value) for value in x]}


def main():
    case, budget, tolerances = python_protocol.request()
    if case["problem"] not in PROBLEMS or case["method"] not in METHODS:
        sys.exit(f"no such case: {case}")
    for tolerance in tolerances:
        run = {}

        def body():
            run.update(solve(PROBLEMS[case["problem"]], METHODS[case["method"]], tolerance))

        timing = python_protocol.median_time(budget, body)
        python_protocol.report(case, tolerance, timing, run)


if __name__ == "__main__":
    main()
