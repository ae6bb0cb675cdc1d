#!/usr/bin/env python3
"""Measures what it takes to get a model ready, in Python: preparation.py [KIND ...] [--sizes 50 100 200] [--rounds 3]

Processor seconds, each in a process of its own, the smallest of some rounds: stating the model (NumPy, the builder), and its first run of next to no
time less a second one, which is reading, building and compiling. Kinds: see KINDS below. Prints a table for results/preparation.md.
"""
import argparse
import json
import resource
import subprocess
import sys
import time


def dense(saltus, np, n, term):
    """x' = W term(x - 1/2) - 9 x with a matrix that is full: n^2 terms."""
    b = saltus.Builder("dense")
    x = b.states("x", np.ones(n))
    b.rate(x, np.random.default_rng(0).normal(size=(n, n)) @ term(x - 0.5) - 9 * x)
    return b


def bar(saltus, np, n, consistent):
    """Elastic bar of finite elements before a wall, in [mechanics]."""
    b = saltus.Builder("bar")
    q, v = b.states("q", [5e-5] * n), b.states("v", [-0.1] * n)
    mass, stiffness = np.zeros((n, n)), 6.6e7 * n
    for i in range(n - 1):
        mass[i : i + 2, i : i + 2] += 2.45 / n / 6 * (np.array([[2, 1], [1, 2]]) if consistent else 3 * np.eye(2))
    force = {
        v[i]: -stiffness * sum((q[i] - q[j] for j in (i - 1, i + 1) if 0 <= j < n), 0.0) for i in range(n)
    }
    b.mechanics(list(q), list(v), mass=mass.tolist(), force=force)
    b.contact("wall", gap=q[0])
    return b


def hysteresis(saltus, np, n):
    """Preisach's operator: n relays of one input."""
    b = saltus.Builder("relays")
    x, v = b.state("x", 0.3), b.state("v", 0.0)
    thresholds = np.sort(np.random.default_rng(0).uniform(-1, 1, (n, 2)))
    relays = [b.hysteresis(f"h{i}", x, on=float(high), off=float(low)) for i, (low, high) in enumerate(thresholds)]
    b.rate(x, v)
    b.rate(v, -x - 0.1 * sum(relays) / n)
    return b


def neurons(saltus, np, n):
    """Leaky integrate-and-fire neurons, each with a jump that sets eleven states."""
    rng = np.random.default_rng(1)
    b = saltus.Builder("lif")
    v, s = b.states("v", list(rng.random(n))), b.states("s", [0.0] * n)
    for i in range(n):
        b.rate(v[i], float(1.1 + 0.4 * rng.random()) - v[i] + s[i])
        b.rate(s[i], -2 * s[i])
        sets = {s[int(j)]: s[int(j)] - 0.05 for j in rng.choice(n, min(n, 10), replace=False)}
        b.jump(v[i] - 1, {v[i]: 0, **sets}, direction="up", name=f"spike{i + 1}")
    return b


KINDS = {
    "dense steps": (lambda s, np, n: dense(s, np, n, s.step), (50, 100, 200, 1000)),
    "dense kinks": (lambda s, np, n: dense(s, np, n, lambda x: np.maximum(x, 0)), (50, 100, 200)),
    "bar": (lambda s, np, n: bar(s, np, n, True), (50, 100, 200)),
    "bar, lumped": (lambda s, np, n: bar(s, np, n, False), (50, 100, 200)),
    "hysteresis": (hysteresis, (100, 200, 400)),
    "neurons": (neurons, (250, 500, 1000)),
}


def measure(kind, n):
    """In a process of its own: what was imported and cached before says nothing."""
    import numpy as np
    import saltus

    start = time.process_time()
    builder = KINDS[kind][0](saltus, np, n)
    model = builder.model()
    stated = time.process_time()
    model.simulate(until=1e-9)
    first = time.process_time()
    model.simulate(until=1e-9)
    again = time.process_time()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"state": stated - start, "prepare": 2 * first - stated - again, "MB": peak}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="*", metavar="KIND", help=f"some of {', '.join(KINDS)}")
    parser.add_argument("--sizes", type=int, nargs="+")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--one", nargs=2, metavar=("KIND", "N"), help="measure in this process, print JSON")
    chosen = parser.parse_args()
    if chosen.one:
        print(json.dumps(measure(chosen.one[0], int(chosen.one[1]))))
        return
    print("| model | n | stated (s) | prepared (s) | MB |\n|---|---|---|---|---|")
    for kind in chosen.kinds or KINDS:
        for n in chosen.sizes or KINDS[kind][1]:
            command = [sys.executable, __file__, "--one", kind, str(n)]
            rows = [json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout) for _ in range(chosen.rounds)]
            best = {key: min(row[key] for row in rows) for key in rows[0]}
            print(f"| {kind} | {n} | {best['state']:.2f} | {best['prepare']:.2f} | {best['MB']:.0f} |", flush=True)


if __name__ == "__main__":
    main()
