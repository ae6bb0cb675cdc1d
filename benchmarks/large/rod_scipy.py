#!/usr/bin/env python3
"""The heated rod of large_models.py by SciPy: BDF with the exact sparse Jacobian, a terminal event at every switch, a
restart behind it. Usage: rod_scipy.py N RTOL; writes what rod_cvode writes. A peer of rod.py."""
import sys
import time

import numpy
import scipy.integrate
import scipy.sparse


def main(n, rtol):
    begin = time.process_time()
    scale, middle, end = float(n * n), (n + 1) // 2 - 1, 5.0
    neighbours = numpy.full(n, 2.0)
    neighbours[[0, -1]] = 1.0
    beside = numpy.full(n - 1, scale)
    matrix = scipy.sparse.diags([beside, -2.0 - scale * neighbours, beside], [-1, 0, 1], format="csc")
    heat = numpy.zeros(n)

    def threshold(_, u):
        return u[middle] - 0.5

    threshold.terminal = True
    t, u, heated, steps = 0.0, numpy.zeros(n), True, 0
    while t < end:
        heat[0] = 4.0 * n if heated else 0.0
        # Behind a switch the threshold is at zero to rounding: it is left into this direction, which is no event.
        threshold.direction = 1.0 if heated else -1.0
        run = scipy.integrate.solve_ivp(lambda _, x: matrix @ x + heat, (t, end), u, method="BDF", jac=matrix, rtol=rtol,
                                        atol=1e-2 * rtol, events=threshold)
        t, u, steps = run.t[-1], run.y[:, -1], steps + len(run.t) - 1
        if run.status == 1:
            heated = not heated
            print(f"switch {t:.17g}")
    print(f"last {u[-1]:.17g}\nsteps {steps}\nseconds {time.process_time() - begin:.6f}")


main(int(sys.argv[1]), float(sys.argv[2]))
