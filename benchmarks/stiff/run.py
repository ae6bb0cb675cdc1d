"""Work and precision of the integrators on stiff models with switches, and of the choice between them.

usage: run.py TOOL [--models FOLDER] [--rtol 1e-4,1e-6,1e-8,1e-10] [--repeats 3] [--catalogue] [--scipy]

Each model is run by every integrator at each tolerance, alternately; a figure is the smallest time of the repeats and the
largest error of the end state, relative to 1e-3 and the state, against radau13 at rtol = 1e-12. "auto / best" compares times
at equal error: that of the best named integrator is interpolated along its own line of error over time.
"""

import argparse
import json
import math
import statistics
import subprocess
from pathlib import Path

NAMED = ("dopri5", "dop853", "taylor", "radau5", "radau9", "radau13")
LONGEST = 60.0


def simulate(tool, model, integrator, rtol):
    """The result of a run, or None where it does not end in time or stops early."""
    command = [tool, "simulate", model, "--quiet", "--integrator", integrator, "--rtol", str(rtol), "--atol",
               str(1e-3 * rtol), "--set", "simulate.output=steps", "--set", "simulate.max_steps=2000000", "--out", "-"]
    try:
        run = subprocess.run(command, capture_output=True, text=True, timeout=LONGEST, check=False)
    except subprocess.TimeoutExpired:
        return None
    result = json.loads(run.stdout) if run.returncode == 0 else None
    return result if result and result["status"]["termination"] == "completed" else None


def error_of(result, exact):
    """Largest error of the end state."""
    pairs = zip(result["final"]["x"], exact["final"]["x"])
    return max(abs(a - b) / (1e-3 + abs(b)) for a, b in pairs)


def line_of(tool, model, integrator, tolerances, repeats, exact):
    """Points (seconds, error, what was used) of an integrator."""
    points = []
    for rtol in tolerances:
        results = [simulate(tool, model, integrator, rtol) for _ in range(repeats)]
        if results[0] is None:
            continue
        seconds = min(result["statistics"]["wall_seconds"] for result in results if result)
        used = results[0]["statistics"].get("integrators", [])
        points.append((seconds, max(error_of(results[0], exact), 1e-16), "+".join(use["name"] for use in used)))
    return points


def time_at(points, error):
    """Seconds at which a line has an error: between its points by logarithms, beyond them its nearest point that has it."""
    points = sorted(points, key=lambda point: point[1], reverse=True)
    for (slow, low), (fast, high) in ((b[:2], a[:2]) for a, b in zip(points, points[1:])):
        if low <= error <= high and low < high:
            share = math.log(high / error) / math.log(high / low)
            return math.exp((1.0 - share) * math.log(fast) + share * math.log(slow))
    reached = [seconds for seconds, other, _ in points if other <= error]
    return min(reached) if reached else None


def scipy_times(module, tolerances):
    """Rows for SciPy on the one model that needs no events of its own; nothing without SciPy."""
    try:
        from scipy.integrate import solve_ivp  # noqa: PLC0415
    except ImportError:
        return [f"| {module} | SciPy | not installed |"]
    import time  # noqa: PLC0415

    def robertson(_t, x):
        k = 0.05 if x[1] > 3e-5 else 0.04
        slow, fast = 1e4 * x[1] * x[2], 3e7 * x[1] ** 2
        return [-k * x[0] + slow, k * x[0] - slow - fast, fast]

    rows = []
    for method in ("LSODA", "BDF"):
        for rtol in tolerances:
            begin = time.perf_counter()
            solve_ivp(robertson, (0.0, 40.0), [1.0, 0.0, 0.0], method=method, rtol=rtol, atol=1e-3 * rtol)
            rows.append(f"| robertson | SciPy {method}, no events | {rtol:g} | {time.perf_counter() - begin:.2e} |")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--models", default=str(Path(__file__).parent / "models"))
    parser.add_argument("--rtol", default="1e-4,1e-6,1e-8,1e-10")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--catalogue", action="store_true", help="the models of the catalogue, too")
    parser.add_argument("--scipy", action="store_true", help="SciPy's LSODA and BDF on Robertson's reactions")
    arguments = parser.parse_args()
    tolerances = [float(word) for word in arguments.rtol.split(",")]
    models = [str(path) for path in sorted(Path(arguments.models).glob("*.toml"))]
    if arguments.catalogue:
        listed = subprocess.run([arguments.tool, "models"], capture_output=True, text=True, check=True).stdout
        models += [line.split()[0] for line in listed.partition("\n\n")[0].splitlines() if line.strip()]
    print("| model | integrator | rtol: seconds, error | used |\n|---|---|---|---|")
    ratios = []
    for model in models:
        exact = simulate(arguments.tool, model, "radau13", 1e-12)
        if exact is None:
            print(f"| {Path(model).stem} | no reference |", flush=True)
            continue
        lines = {name: line_of(arguments.tool, model, name, tolerances, arguments.repeats, exact)
                 for name in ("auto", *NAMED)}
        for name, points in lines.items():
            text = "; ".join(f"{seconds:.1e}, {error:.0e}" for seconds, error, _ in points)
            print(f"| {Path(model).stem} | {name} | {text} | {points[-1][2] if points else ''} |", flush=True)
        for seconds, error, _ in lines["auto"]:
            best = [time for name in NAMED if (time := time_at(lines[name], error)) is not None]
            if best:
                ratios.append((seconds / min(best), Path(model).stem))
    if ratios:
        mean = math.exp(statistics.fmean(math.log(ratio) for ratio, _ in ratios))
        worst = max(ratios)
        print(f"\nauto / best of the named at equal error: geometric mean {mean:.2f}, worst {worst[0]:.2f} ({worst[1]})")
    if arguments.scipy:
        print("\n".join(scipy_times("robertson", tolerances)))


if __name__ == "__main__":
    main()
