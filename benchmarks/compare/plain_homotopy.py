"""A plain homotopy over IPOPT of the MPCC that Saltus transcribes, in CasADi alone.

usage: plain_homotopy.py PROBLEM      prints one line of JSON

Radau IIA in integral form, step form, cross complementarities, lengths of elements pulled towards their mean, products of
pairs <= sigma = 1, 0.1, … 1e-9, every problem from the solution before it.
"""

import json
import sys
import time

import casadi as ca
import numpy

import ocp_problems

SIGMAS = [10.0**-k for k in range(10)]


class Program:
    """Variables, rows and pairs as they come."""

    def __init__(self):
        self.w, self.lower, self.upper, self.start = [], [], [], []
        self.g, self.g_lower, self.g_upper = [], [], []
        self.pairs = []

    def variable(self, size, lower, upper, start):
        symbol = ca.SX.sym("w", size)
        self.w.append(symbol)
        for values, value in ((self.lower, lower), (self.upper, upper), (self.start, start)):
            values.extend(numpy.broadcast_to(value, size))
        return symbol

    def equation(self, row):
        self.g.append(row)
        self.g_lower.extend([0.0] * row.numel())
        self.g_upper.extend([0.0] * row.numel())


def lagrange(points):
    """Of the polynomials of a state through 0 and the points: D[i][j] = l_i'(points[j])."""
    nodes = [0.0, *points]
    matrix = numpy.zeros((len(nodes), len(points)))
    for i, node in enumerate(nodes):
        others = [other for k, other in enumerate(nodes) if k != i]
        basis = numpy.poly1d(others, r=True) / numpy.prod([node - other for other in others])
        matrix[i] = [basis.deriv()(point) for point in points]
    return matrix


def weights(points):
    """Of the quadrature through the points."""
    basis = [numpy.poly1d(others := [q for q in points if q != p], r=True) / numpy.prod([p - q for q in others])
             for p in points]
    return [one.integ()(1.0) for one in basis]


def element(program, problem, functions, x, u, length, time_scale, before):
    """One finite element: its end, its cost, its multipliers at the end. Adds its rows and pairs."""
    points = ca.collocation_points(problem.stages, "radau")
    matrix, b = lagrange(points), weights(points)
    lower, upper = problem.x_bounds or (-numpy.inf, numpy.inf)
    n_psi = problem.alpha.numel()
    states = [program.variable(problem.x.numel(), lower, upper, problem.x0) for _ in points]
    alphas = [program.variable(n_psi, 0, 1, 0.5) for _ in points]
    negative = [program.variable(n_psi, 0, ca.inf, 0.5) for _ in points]
    positive = [program.variable(n_psi, 0, ca.inf, 0.5) for _ in points]
    cost = 0
    for j in range(len(points)):
        slope = matrix[0][j] * x + sum(matrix[i + 1][j] * states[i] for i in range(len(points)))
        f, f_q = functions["f"](states[j], u, alphas[j])
        program.equation(slope - time_scale * length * f)
        program.equation(functions["psi"](states[j]) - positive[j] + negative[j])
        cost += time_scale * length * b[j] * f_q
    sum_alpha, sum_rest = sum(alphas), sum(1 - alpha for alpha in alphas)
    if problem.cross == "fe_fe":
        sides = [(sum(negative) + before[0], sum(positive) + before[1])]
    else:
        sides = [before, *zip(negative, positive, strict=True)]
    for of_alpha, of_rest in sides:
        program.pairs += [(of_alpha, sum_alpha), (of_rest, sum_rest)]
    return states[-1], cost, (negative[-1], positive[-1])


def transcribe(problem):
    """The MPCC, its objective, and the terms of the method."""
    program = Program()
    functions = {"f": ca.Function("f", [problem.x, problem.u, problem.alpha], [problem.f, problem.f_q]),
                 "psi": ca.Function("psi", [problem.x], [problem.psi])}
    time_scale = 1.0
    if problem.horizon_bounds:
        horizon = program.variable(1, *problem.horizon_bounds, problem.horizon)
        time_scale = horizon / problem.horizon
    x = ca.DM(problem.x0)
    if problem.x0_bounds:
        x = program.variable(problem.x.numel(), *problem.x0_bounds, problem.x0)
        before = tuple(program.variable(problem.alpha.numel(), 0, ca.inf, 0.5) for _ in range(2))
        program.equation(functions["psi"](x) - before[1] + before[0])
        program.pairs.append(before)
    else:
        psi = functions["psi"](x)
        before = (ca.fmax(-psi, 0), ca.fmax(psi, 0))
    mean = problem.horizon / problem.intervals / problem.elements
    objective, method = 0, 0
    for _ in range(problem.intervals):
        u = program.variable(problem.u.numel(), *problem.u_bounds, 0)
        lengths = [program.variable(1, 0, 2 * mean, mean) for _ in range(problem.elements)]
        for length in lengths:
            x, cost, before = element(program, problem, functions, x, u, length, time_scale, before)
            objective += cost
            method += (length - mean)**2
        program.equation(sum(lengths) - problem.elements * mean)
    program.equation(ca.substitute(problem.g_T, problem.x, x))
    objective += ca.substitute(problem.f_T, problem.x, x)
    if problem.horizon_bounds:
        objective += horizon
    return program, objective, method


def main():
    problem = ocp_problems.PROBLEMS[sys.argv[1]]()
    begin = time.perf_counter()
    program, objective, method = transcribe(problem)
    sigma = ca.SX.sym("sigma")
    G, H = (ca.vertcat(*side) for side in zip(*program.pairs, strict=True))
    w, products = ca.vertcat(*program.w), G * H
    options = {"ipopt": {"print_level": 0, "sb": "yes", "max_iter": 500, "tol": 1e-10, "bound_relax_factor": 0.0,
                         "mu_strategy": "adaptive", "mu_oracle": "quality-function"}, "print_time": False}
    solver = ca.nlpsol("solver", "ipopt", {"x": w, "p": sigma, "f": objective + method,
                                           "g": ca.vertcat(*program.g, products - sigma)}, options)
    value = ca.Function("value", [w], [objective, ca.mmax(ca.fmin(G, H))])
    built = time.perf_counter()
    found = ca.DM(program.start)
    iterations, evaluation, solved = 0, 0.0, True
    count = products.numel()
    for one in SIGMAS:
        found = solver(x0=found, p=one, lbx=program.lower, ubx=program.upper,
                       lbg=[*program.g_lower, *[-ca.inf] * count], ubg=[*program.g_upper, *[0.0] * count])["x"]
        stats = solver.stats()
        solved = stats["success"]
        iterations += stats["iter_count"]
        evaluation += sum(stats[key] for key in stats if key.startswith("t_wall_nlp_"))
    end = time.perf_counter()
    f, complementarity = (float(part) for part in value(found))
    print(json.dumps({"status": "completed" if solved else stats["return_status"], "objective": f,
                      "complementarity": complementarity, "iterations": iterations, "seconds": end - built,
                      "build_seconds": built - begin, "evaluation_seconds": evaluation,
                      "variables": w.numel(), "equations": len(program.g_lower), "pairs": count}))


if __name__ == "__main__":
    main()
