"""Runs our and their way of a question, measures both, and checks the end against what is exact."""

import time

import numpy as np
from matplotlib import pyplot

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
    ROWS.append((question, "Saltus", seconds, error))
    print(f"Saltus: {seconds * 1e3:.2f} ms, error {error:.1e}")
    return result


def theirs(question, run, exact, value):
    """SciPy's result, as it was asked."""
    begin = time.perf_counter()
    result = run()
    first = time.perf_counter() - begin
    seconds = first if first > 1 else best_of(run, 3)
    error = float(np.max(np.abs(np.asarray(value(result), dtype=float) - exact)))
    ROWS.append((question, "SciPy", seconds, error))
    print(f"SciPy: {seconds * 1e3:.2f} ms, error {error:.1e}")
    return result


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
        axis.plot(their_t, column, ".", color="#7570b3", markersize=3, label="SciPy", zorder=1)
        axis.legend()


def table():
    """All that was measured."""
    from IPython.display import HTML

    rows = "".join(f"<tr><td>{q}</td><td>{who}</td><td>{1e3 * s:.2f}</td><td>{e:.1e}</td></tr>" for q, who, s, e in ROWS)
    return HTML(f"<table><thead><tr><th>Question</th><th>by</th><th>ms</th><th>error</th></tr></thead><tbody>{rows}</tbody></table>")
