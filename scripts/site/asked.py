"""Runs our and their way of a question, measures both, and checks the end against what is exact."""

import math
import time

import numpy as np
from matplotlib import pyplot
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import saltus

ROWS = []


def ours(question, text, exact, value, **options):
    """Our result; `value` of it is what is compared with `exact`."""
    model = saltus.Model.from_text('[model]\nname = "asked"\n' + text)
    result = model.simulate(**options)
    seconds = best_of(lambda: model.simulate(**options))
    error = float(np.max(np.abs(np.asarray(value(result), dtype=float) - exact)))
    scale = max(1.0, float(np.max(np.abs(exact))))
    assert error <= 1e-7 * scale, f"{question}: {error}"
    ROWS.append((question, "Saltus", seconds, f"{error:.1e}"))
    print(f"Saltus: {seconds * 1e3:.2f} ms, error {error:.1e}")
    return result


def theirs(question, run, exact, value, who="SciPy"):
    """SciPy's result: as it was asked, or `who` says how."""
    begin = time.perf_counter()
    result = run()
    first = time.perf_counter() - begin
    seconds = first if first > 1 else best_of(run, 3)
    found, exact = np.asarray(value(result), dtype=float), np.asarray(exact, dtype=float)
    error = f"{np.max(np.abs(found - exact)):.1e}" if found.shape == exact.shape else f"{found.size} of {exact.size} found"
    ROWS.append((question, who, seconds, error))
    print(f"{who}: {seconds * 1e3:.2f} ms, error {error}")
    return result


class Run:
    """Pieces of solve_ivp behind each other: what one writes who restarts it at events."""

    def __init__(self, until):
        self.until, self.t, self.y, self.times = until, [], [], []

    def go(self, f, t, y, event, direction=0, **options):
        """Integrates until an event or the end; time and state there."""
        def watched(t, y):
            return event(t, y)

        watched.terminal, watched.direction = True, direction
        sol = solve_ivp(f, (t, self.until), y, events=watched, **options)
        self.t.extend(sol.t)
        self.y.extend(sol.y.T)
        if sol.status == 1:
            self.times.append(sol.t[-1])
        return sol.t[-1], sol.y[:, -1].copy()


def relay_oscillator(until):
    """x of x'' = -x - x' + w from x = 0, x' = 1, w = 1 until x rises to 1, then -1 until it falls to -1, in closed form."""
    omega = math.sqrt(0.75)
    t, x, v, w = 0.0, 0.0, 1.0, 1
    while True:
        a, b = x - w, (v + (x - w) / 2) / omega

        def at(s, a=a, b=b, w=w):
            return w + math.exp(-s / 2) * (a * math.cos(omega * s) + b * math.sin(omega * s))

        def slope(s, a=a, b=b):
            c, d = b * omega - a / 2, -a * omega - b / 2
            return math.exp(-s / 2) * (c * math.cos(omega * s) + d * math.sin(omega * s))

        grid = [0.01 * k for k in range(1, 2000)]
        s = next(brentq(lambda s: at(s) - w, p, q, xtol=1e-15) for p, q in zip(grid, grid[1:]) if w * at(p) < 1 <= w * at(q))
        if t + s > until:
            return at(until - t)
        t, x, v, w = t + s, w, slope(s), -w


def best_of(run, times=5):
    best = np.inf
    for _ in range(times):
        begin = time.perf_counter()
        run()
        best = min(best, time.perf_counter() - begin)
        if best > 1:
            break
    return best


def over_each_other(r, names, their_t=None, their_columns=()):
    """Our curves, and theirs as dots."""
    _, axes = pyplot.subplots(len(names), 1, sharex=True, squeeze=False, figsize=(6.5, 0.8 + 1.3 * len(names)), layout="constrained")
    r.plot(names, axes=axes[:, 0])
    axes[0, 0].set_title("")
    for axis, column in zip(axes[:, 0], their_columns):
        # A hundred thousand dots are pixels: as shapes they keep a browser busy for seconds.
        axis.plot(their_t, column, ".", color="#d95f02", markersize=4, label="SciPy", zorder=3, rasterized=len(their_t) > 2000)
        axis.legend()


def table():
    """All that was measured."""
    from IPython.display import HTML

    rows = "".join(f"<tr><td>{q}</td><td>{who}</td><td>{1e3 * s:.2f}</td><td>{e}</td></tr>" for q, who, s, e in ROWS)
    return HTML(f"<table><thead><tr><th>Question</th><th>by</th><th>ms</th><th>error</th></tr></thead><tbody>{rows}</tbody></table>")
