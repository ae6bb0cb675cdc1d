"""The problems of optimal_control.py in PyPI's nosnoc, with its own settings.

usage: nosnoc_optimal_control.py PROBLEM      prints one line of JSON

Step form, Radau IIA and the pull of lengths towards their mean are those of the others; everything else is as nosnoc has
it. A free horizon is a global variable that scales the dynamics.
"""

import json
import sys
import time
import warnings

import casadi as ca
import nosnoc
import numpy

import ocp_problems

warnings.simplefilter("ignore")


def options_of(problem):
    options = nosnoc.NosnocOpts()
    options.pss_mode = nosnoc.PssMode.STEP
    options.irk_scheme = nosnoc.IrkSchemes.RADAU_IIA
    options.step_equilibration = nosnoc.StepEquilibrationMode.HEURISTIC_MEAN
    options.n_s = problem.stages
    options.N_stages = problem.intervals
    options.N_finite_elements = problem.elements
    options.terminal_time = float(problem.horizon)
    options.print_level = 0
    return options


def statement(problem):
    """Model and goal; the horizon is scaled by a global variable where it is free."""
    scale, bounds = ca.SX.sym("scale", 0), {}
    f, f_q = problem.f, problem.f_q
    if problem.horizon_bounds:
        scale = ca.SX.sym("scale")
        lower, upper = problem.horizon_bounds
        bounds = {"lbv_global": numpy.array([lower / problem.horizon]), "v_global_guess": numpy.array([1.0]),
                  "ubv_global": numpy.array([upper / problem.horizon])}
        f, f_q = scale * f, scale
    model = nosnoc.NosnocModel(x=problem.x, f_x=[f], alpha=[problem.alpha], c=[problem.psi], u=problem.u, v_global=scale,
                               x0=numpy.array(problem.x0, dtype=float), name="model")
    if problem.x_bounds:
        bounds |= {"lbx": numpy.array(problem.x_bounds[0]), "ubx": numpy.array(problem.x_bounds[1])}
    lower, upper = (numpy.array(bound, dtype=float) for bound in problem.u_bounds)
    return model, nosnoc.NosnocOcp(lbu=lower, ubu=upper, f_q=f_q, f_terminal=problem.f_T, g_terminal=problem.g_T, **bounds)


def main():
    problem = ocp_problems.PROBLEMS[sys.argv[1]]()
    if problem.x0_bounds:
        print(json.dumps({"status": "cannot be stated: the initial state is free"}))
        return
    begin = time.perf_counter()
    options = options_of(problem)
    solver = nosnoc.NosnocSolver(options, *statement(problem))
    built = time.perf_counter()
    evaluation = 0.0
    original = solver.solver

    def counted(**arguments):
        nonlocal evaluation
        found = original(**arguments)
        stats = original.stats()
        evaluation += sum(stats[key] for key in stats if key.startswith("t_wall_nlp_"))
        return found

    counted.stats = original.stats
    solver.solver = counted
    results = solver.solve()
    end = time.perf_counter()
    mean = options.terminal_time / (options.N_stages * options.N_finite_elements)
    cost = solver.problem.cost_fun(results["w_sol"], solver.p_val)
    method = float(((numpy.array(results["time_steps"]) - mean)**2).sum())
    residual = float(solver.problem.comp_res(results["w_sol"], solver.p_val))
    print(json.dumps({"status": "completed" if results["status"] == nosnoc.Status.SUCCESS else "failed",
                      "objective": float(cost) - method, "complementarity": residual,
                      "iterations": sum(n for n in results["nlp_iter"] if n is not None), "seconds": end - built,
                      "build_seconds": built - begin, "evaluation_seconds": evaluation}))


if __name__ == "__main__":
    main()
