"""The problems of fesd.py in PyPI's nosnoc: one homotopy over IPOPT per simulation step.

usage: nosnoc_runner.py PROBLEM FORM SCHEME STAGES STEPS UNTIL VARIANT      prints one line of JSON

FORM is step or stewart; VARIANT is "shipped" (nosnoc's own settings) or "fast" (each step starts from the solution before
it, sigma falls superlinearly): the quickest of the settings tried that keep its success rate.
"""

import json
import sys
import time
import warnings

import casadi
import nosnoc
import numpy

warnings.simplefilter("ignore")


def relay():
    x = casadi.SX.sym("x", 3)
    omega, xi = 25.0, 0.05
    smooth = casadi.vertcat(-(2 * xi * omega + 1) * x[0] + x[1], -(2 * xi * omega + omega**2) * x[0] + x[2],
                            -omega**2 * x[0])
    push = casadi.DM([-1, 2, -1])
    return x, [0, -0.001, -0.02], x[0], smooth - push, smooth + push


def stick_slip():
    x = casadi.SX.sym("x", 2)
    q, v = x[0], x[1]
    return (x, [0.04, -0.01], v - 0.2, casadi.vertcat(v, -q + 1 / (1.2 - v)), casadi.vertcat(v, -q - 1 / (0.8 + v)))


def two_regions(name, statement, form):
    """psi < 0: `below`, psi > 0: `above`."""
    x, x0, psi, below, above = statement
    if form == "stewart":
        return nosnoc.NosnocModel(x=x, F=[casadi.horzcat(below, above)], S=[numpy.array([[-1], [1]])], c=[psi],
                                  x0=numpy.array(x0), name=name)
    alpha = casadi.SX.sym("alpha")
    return nosnoc.NosnocModel(x=x, f_x=[alpha * above + (1 - alpha) * below], alpha=[alpha], c=[psi], x0=numpy.array(x0),
                              name=name)


def irma():
    x = casadi.SX.sym("x", 5)
    alpha = casadi.SX.sym("alpha", 7)
    gal4, low, mid, high, ash1, cbf1, _ = (alpha[i] for i in range(7))
    thresholds = casadi.vertcat(x[0] - 0.01, x[1] - 0.01, x[1] - 0.06, x[1] - 0.08, x[2] - 0.035, x[3] - 0.04,
                                x[4] - 0.01)
    f = casadi.vertcat(1.1e-4 + 9e-4 * cbf1 - 0.05 * x[0], 3e-4 + 0.15 * gal4 - 0.04 * x[1],
                       6e-4 + 0.018 * mid - 0.05 * x[2], 5e-4 * low + 0.03 * low * (1 - ash1) - 0.02 * x[3],
                       7.5e-4 + 0.015 * high - 0.6 * x[4])
    return nosnoc.NosnocModel(x=x, f_x=[f], alpha=[alpha], c=[thresholds],
                              x0=numpy.array([0.011, 0.09, 0.04, 0.05, 0.015]), name="irma")


def model_of(problem, form):
    if problem == "irma":
        return irma()
    return two_regions("model", relay() if problem == "relay-feedback" else stick_slip(), form)


def options_of(form, scheme, stages, length, variant):
    options = nosnoc.NosnocOpts()
    options.pss_mode = nosnoc.PssMode.STEP if form == "step" else nosnoc.PssMode.STEWART
    options.irk_scheme = getattr(nosnoc.IrkSchemes, scheme.upper())
    options.n_s = stages
    options.N_finite_elements = 2
    options.terminal_time = length
    options.print_level = 0
    if variant == "fast":
        options.initialization_strategy = nosnoc.InitializationStrategy.ALL_XCURRENT_WOPT_PREV
        options.homotopy_update_rule = nosnoc.HomotopyUpdateRule.SUPERLINEAR
    return options


def main():
    problem, form, scheme, stages, steps, until, variant = sys.argv[1:]
    steps, until = int(steps), float(until)
    begin = time.process_time()
    model = model_of(problem, form)
    solver = nosnoc.NosnocSolver(options_of(form, scheme, int(stages), until / steps, variant), model)
    built = time.process_time()
    looper = nosnoc.NosnocSimLooper(solver, model.x0, steps, print_level=0)
    looper.run()
    end = time.process_time()
    results = looper.get_results()
    failed = sum(status != nosnoc.Status.SUCCESS for status in looper.status)
    print(json.dumps({"x": [float(value) for value in results["X_sim"][-1]], "t": float(results["t_grid"][-1]),
                      "failed": failed, "build_seconds": built - begin, "seconds": end - built}))


if __name__ == "__main__":
    main()
