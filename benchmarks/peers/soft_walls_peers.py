"""Runners of soft_walls.py: ADMM over OSQP, and branch and bound over QPs of HiGHS, on the same discretised problem.

    soft_walls_peers.py admm | branch

Unknowns v = (z_1 u_0 r_1 l_1 | z_2 …): forces r, l of the walls and their sides w = distance + force / K; 0 <= force, w and one of them zero.
"""

import sys

import numpy
import scipy.sparse as sp
from soft_walls_plant import E_TIP, K, N, WALL, A, B, D, Q, R, loop, riccati

SIZE = 4 + 1 + 2 + 2  # z, u, forces, sides
FORCES = [SIZE * k + 5 + j for k in range(N) for j in range(2)]
SIDES = [i + 2 for i in FORCES]


def problem():
    """H, equations (matrix, right side without the state), rows of the state z_0."""
    h = numpy.zeros((SIZE * N, SIZE * N))
    rows, right = [], []
    p = riccati()
    for k in range(N):
        at = SIZE * k
        h[at:at + 4, at:at + 4] = p if k == N - 1 else Q
        h[at + 4, at + 4] = R[0, 0]
        for i in range(4):
            row = numpy.zeros(SIZE * N)
            row[at + i] = 1
            row[at + 4], row[at + 5], row[at + 6] = -B[i], D[i], -D[i]
            if k:
                row[at - SIZE:at - SIZE + 4] = -A[i]
            rows.append(row)
            right.append(0.0)
        for j, sign in ((0, 1), (1, -1)):
            row = numpy.zeros(SIZE * N)
            row[at + 7 + j], row[at + 5 + j] = 1, -1 / K
            row[at:at + 2] = sign * E_TIP
            rows.append(row)
            right.append(WALL)
    return 2 * h, numpy.array(rows), numpy.array(right)


H, EQUATIONS, RIGHT = problem()
P = riccati()
GAIN = (B @ P @ A) / (R[0, 0] + B @ P @ B)


def right_for(z):
    right = RIGHT.copy()
    right[:4] = A @ z
    return right


class Admm:
    """min v'Hv/2 over the equations, with the pairs in a copy d: v - d = 0 by ADMM."""

    def __init__(self, rho, growth, iterations=10):
        import osqp

        self.pairs, self.rho, self.growth, self.iterations = FORCES + SIDES, rho, growth, iterations
        self.scale = numpy.array([1.0 / K] * len(FORCES) + [1.0] * len(SIDES))
        self.solvers = []
        for i in range(iterations):
            weight = numpy.zeros(SIZE * N)
            weight[self.pairs] = rho * growth**i * self.scale**2 * 1e2
            solver = osqp.OSQP()
            solver.setup(sp.csc_matrix(H + numpy.diag(weight)), numpy.zeros(SIZE * N), sp.csc_matrix(EQUATIONS), RIGHT, RIGHT, verbose=False,
                         eps_abs=1e-6, eps_rel=1e-6, polishing=False)
            self.solvers.append((solver, weight))

    def guess(self, z):
        """The motion under the feedback without walls, with the walls' forces of each step's beginning."""
        d = numpy.zeros(SIZE * N)
        for k in range(N):
            u = -float(GAIN @ z)
            tip = E_TIP @ z[:2]
            walls = K * numpy.maximum(0, [tip - WALL, -WALL - tip])
            z = A @ z + B * u + D * (walls[1] - walls[0])
            d[SIZE * k:SIZE * (k + 1)] = [*z, u, *walls, *(walls / K + WALL + numpy.array([-1, 1]) * (E_TIP @ z[:2]))]
        return d

    def project(self, v):
        """The nearest point whose pairs have one side zero."""
        d = v.copy()
        force, side = v[FORCES] / K, v[SIDES]
        is_pressed = force > side
        d[FORCES] = numpy.where(is_pressed, numpy.maximum(v[FORCES], 0), 0)
        d[SIDES] = numpy.where(is_pressed, 0, numpy.maximum(side, 0))
        return d

    def __call__(self, z):
        right, dual = right_for(z), numpy.zeros(SIZE * N)
        d = self.project(self.guess(z))
        for solver, weight in self.solvers:
            solver.update(q=-weight * (d - dual), l=right, u=right)
            solver.warm_start(x=d)
            v = solver.solve().x
            d = self.project(v + dual)
            dual = (dual + v - d) / self.growth
        return v[4]


class Branch:
    """The global optimum: depth first, the pair with the largest product is split, pairs of the last optimum first."""

    def __init__(self):
        import highspy

        self.highspy, self.solved = highspy, 0

    def relaxed(self, right, zeros):
        highspy = self.highspy
        lp = highspy.HighsLp()
        n, m = EQUATIONS.shape[1], EQUATIONS.shape[0]
        lp.num_col_, lp.num_row_ = n, m
        lower, upper = numpy.full(n, -numpy.inf), numpy.full(n, numpy.inf)
        lower[FORCES + SIDES] = 0
        upper[list(zeros)] = 0
        lp.col_cost_, lp.col_lower_, lp.col_upper_ = numpy.zeros(n), lower, upper
        lp.row_lower_ = lp.row_upper_ = right
        matrix, hessian = sp.csc_matrix(EQUATIONS), sp.csc_matrix(numpy.tril(H))
        lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = matrix.indptr, matrix.indices, matrix.data
        model = highspy.HighsModel()
        model.lp_ = lp
        model.hessian_.dim_, model.hessian_.format_ = n, highspy.HessianFormat.kTriangular
        model.hessian_.start_, model.hessian_.index_, model.hessian_.value_ = hessian.indptr, hessian.indices, hessian.data
        solver = highspy.Highs()
        solver.setOptionValue("output_flag", False)
        solver.passModel(model)
        solver.run()
        self.solved += 1
        if solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            return numpy.inf, None
        return solver.getInfo().objective_function_value, numpy.array(solver.getSolution().col_value)

    def __call__(self, z):
        right, best, answer, stack = right_for(z), numpy.inf, None, [frozenset()]
        while stack:
            zeros = stack.pop()
            value, v = self.relaxed(right, zeros)
            if value >= best - 1e-9:
                continue
            products = numpy.minimum(v[FORCES] / K, v[SIDES])
            worst = int(numpy.argmax(products))
            if products[worst] < 1e-7:
                best, answer = value, v
                continue
            near, far = (FORCES[worst], SIDES[worst]) if v[FORCES[worst]] / K < v[SIDES[worst]] else (SIDES[worst], FORCES[worst])
            stack += [zeros | {far}, zeros | {near}]
        return answer[4]


if __name__ == "__main__":
    if sys.argv[1] == "admm":
        for rho, growth in ((30.0, 2.0), (0.3, 3.0)):
            loop(f"ADMM, 10 iterations, rho = {rho:g}, times {growth:g} each", Admm(rho, growth))
    else:
        loop("branch and bound over QPs of HiGHS", Branch(), samples=2)
