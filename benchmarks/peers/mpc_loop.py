"""Runner of mpc.py: one closed loop.      mpc_loop.py cart-pole|acrobot saltus|homotopy"""

import json
import pathlib
import sys
import time
import warnings

import casadi as ca
import numpy
import saltus
from mpc_problems import PROBLEMS

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "compare"))
import plain_homotopy  # noqa: E402

warnings.simplefilter("ignore")


class Saltus:
    def __init__(self, problem):
        self.model, self.names, self.last, self.unsolved = saltus.Model.from_text(problem.text), problem.names, None, 0
        self.controls = problem.controls

    def __call__(self, z):
        options = {"mpcc": {"first": "branch"}} if self.last is not None else {}
        found = self.model.optimize(set=dict(zip(self.names, map(float, z), strict=True)), start=self.last, **options)
        self.unsolved += str(found.status) not in ("completed", "verification_failed")  # the latter: solved, on a grid that is coarse
        self.last = found
        return [float(numpy.asarray(found[name])[0]) for name in self.controls]


class Homotopy:
    """The transcription of benchmarks/compare/plain_homotopy.py with the first state as parameter."""

    def __init__(self, problem):
        program, state, self.unsolved, self.found = plain_homotopy.Program(), ca.SX.sym("state", len(problem.names)), 0, None
        ocp = problem.ocp()
        functions = {"f": ca.Function("f", [ocp.x, ocp.u, ocp.alpha], [ocp.f, ocp.f_q]), "psi": ca.Function("psi", [ocp.x], [ocp.psi])}
        x, psi, objective, method = state, functions["psi"](state), 0, 0
        before, mean = (ca.fmax(-psi, 0), ca.fmax(psi, 0)), ocp.horizon / ocp.intervals / ocp.elements
        for k in range(ocp.intervals):
            u = program.variable(ocp.u.numel(), *ocp.u_bounds, 0)
            self.first = slice(0, ocp.u.numel()) if k == 0 else self.first
            lengths = [program.variable(1, 0, 2 * mean, mean) for _ in range(ocp.elements)]
            for length in lengths:
                x, cost, before = plain_homotopy.element(program, ocp, functions, x, u, length, 1.0, before)
                objective += cost
                method += (length - mean)**2
            program.equation(sum(lengths) - ocp.elements * mean)
        objective += ca.substitute(ocp.f_T, ocp.x, x)
        sigma = ca.SX.sym("sigma")
        G, H = (ca.vertcat(*side) for side in zip(*program.pairs, strict=True))
        options = {"ipopt": {"print_level": 0, "sb": "yes", "max_iter": 500, "tol": 1e-8}, "print_time": False}
        self.solver = ca.nlpsol("solver", "ipopt", {"x": ca.vertcat(*program.w), "p": ca.vertcat(state, sigma), "f": objective + method,
                                                    "g": ca.vertcat(*program.g, G * H - sigma)}, options)
        self.program, self.count = program, G.numel()

    def __call__(self, z):
        start, program = self.found if self.found is not None else self.program.start, self.program
        for sigma in ((1, 1e-1, 1e-2, 1e-4, 1e-6) if self.found is None else (1e-2, 1e-4, 1e-6)):
            start = self.solver(x0=start, p=[*z, sigma], lbx=program.lower, ubx=program.upper, lbg=[*program.g_lower, *[-ca.inf] * self.count],
                                ubg=[*program.g_upper, *[0.0] * self.count])["x"]
        self.unsolved += not self.solver.stats()["success"]
        self.found = start
        return [float(v) for v in start[self.first].full().ravel()]


def main():
    problem = PROBLEMS[sys.argv[1]]
    controller = {"saltus": Saltus, "homotopy": Homotopy}[sys.argv[2]](problem)
    plant, z, seconds, cost = saltus.Model.from_text(problem.text), numpy.array(problem.start, dtype=float), [], 0.0
    ocp = problem.ocp()
    stage = ca.Function("stage", [ocp.x, ocp.u], [ca.substitute(ocp.f_q, ocp.alpha, ca.DM.zeros(ocp.alpha.shape))])
    for _ in range(problem.samples):
        begin = time.process_time()
        u = controller(z)
        seconds.append(1e3 * (time.process_time() - begin))
        cost += problem.sampling * float(stage(z, u))
        final = plant.simulate(until=problem.sampling, set={**dict(zip(problem.names, map(float, z), strict=True)), **dict(zip(problem.controls, u, strict=True))}).final
        z = numpy.array([float(final[name]) for name in problem.names])
    print(json.dumps({"status": "completed", "samples": len(seconds), "unsolved": int(controller.unsolved), "cost": cost,
                      "median": float(numpy.median(seconds[1:])), "largest": max(seconds[1:])}))


if __name__ == "__main__":
    main()
