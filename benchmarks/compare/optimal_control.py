#!/usr/bin/env python3
"""`saltus optimize` against PyPI's nosnoc and a plain homotopy over IPOPT, of the same discretised problems, in one run.

    python3 benchmarks/compare/optimal_control.py               writes benchmarks/results/optimal_control.md and .csv
    python3 benchmarks/compare/optimal_control.py --rounds 1 --problems 'turbo car' --output /tmp

The Python contenders live in nosnoc's virtual environment (scripts/install_benchmarks.sh); where it cannot be installed
their rows say so. How to read the table: benchmarks/README.md.
"""

import argparse
import csv
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import contenders
import table

HERE = pathlib.Path(__file__).resolve().parent
MODELS = contenders.ROOT / "models"
NOSNOC = contenders.BUILD / "nosnoc-venv" / "bin" / "python3"
# Model files and what is set in them: the settings of the literature; the others begin with sigma = 1.
PROBLEMS = {
    "turbo car": (MODELS / "turbo-car.toml", ("v_max=25",)),
    "sliding mode": (MODELS / "slide-and-hide.toml", ()),
    "cart-pole": (MODELS / "cart-pole.toml", ("optimize.stages=2", "optimize.mpcc.sigma_initial=auto")),
    "motor, u^2": (MODELS / "voice-coil.toml", ("optimize.stages=2",)),
    "motor, T": (MODELS / "voice-coil-time.toml", ("optimize.stages=2",)),
    "Stewart-Anitescu": (MODELS / "stewart-anitescu.toml", ()),
}
CONTENDERS = ("Saltus", "plain", "nosnoc")
PYTHON = {"plain": HERE / "plain_homotopy.py", "nosnoc": HERE / "nosnoc_optimal_control.py"}
MEASURED = ("status", "objective", "complementarity", "iterations", "seconds", "build_seconds", "evaluation_seconds")
COLUMNS = ("problem", "contender", "round", *MEASURED)
TIMES = ("seconds", "build_seconds", "evaluation_seconds")
# At these numbers of elements the discretised trajectory differs from the simulated one by up to 3e-3.
COMMON = ("optimize.verification_tolerance=1e-2",)


def on_processor(command, timeout, **more):
    """Runs the command; its output, and the share of the processor that it has got."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    before, begin = os.times(), time.perf_counter()
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment, timeout=timeout, **more)
    after, elapsed = os.times(), time.perf_counter() - begin
    used = (after.children_user - before.children_user) + (after.children_system - before.children_system)
    return done, min(used / elapsed, 1.0)


def run_saltus(tool, problem, timeout):
    file, values = PROBLEMS[problem]
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "result.json"
        settings = [part for value in (*values, *COMMON) for part in ("--set", value)]
        done, share = on_processor([tool, "optimize", file, *settings, "--out", out], timeout)
        if not out.exists():
            raise RuntimeError(done.stderr.strip())
        result = json.loads(out.read_text())
    spent = result["statistics"]
    return {"status": result["status"]["termination"], "objective": result["objective"],
            "complementarity": result["certificate"]["complementarity_residual"], "iterations": spent["iterations"],
            "seconds": spent["wall_seconds"] - spent["build_seconds"], "build_seconds": spent["build_seconds"],
            "evaluation_seconds": spent["evaluation_seconds"]}, share


def run_python(contender, problem, timeout):
    done, share = on_processor([NOSNOC, PYTHON[contender], problem], timeout, check=True)
    return json.loads(done.stdout.splitlines()[-1]), share


def measure(tool, contender, problem, timeout):
    """One row; times in seconds of the processor."""
    try:
        found, share = (run_saltus(tool, problem, timeout) if contender == "Saltus" else
                        run_python(contender, problem, timeout))
    except subprocess.TimeoutExpired:
        return {"status": f"more than {timeout:g} s"}
    except (RuntimeError, subprocess.CalledProcessError) as failure:
        lines = (getattr(failure, "stderr", None) or str(failure)).strip().splitlines()
        return {"status": lines[-1] if lines else "failed"}
    return {name: share * value if name in TIMES else value for name, value in found.items() if name in MEASURED}


def rows(tool, chosen, rounds, timeout):
    """Contenders take turns, so that what else the machine does meets all of them."""
    installed = contenders.succeeds(NOSNOC, "-c", "import nosnoc")
    for turn in range(rounds):
        for problem in chosen:
            for contender in CONTENDERS:
                row = {"problem": problem, "contender": contender, "round": turn}
                print(*row.values(), file=sys.stderr, flush=True)
                if contender == "Saltus" or installed:
                    yield row | measure(tool, contender, problem, timeout)
                else:
                    yield row | {"status": "not installed"}


def medians(measured):
    """One row for every problem and contender: everything but times is the same in all rounds."""
    groups = {}
    for row in measured:
        groups.setdefault((row["problem"], row["contender"]), []).append(row)
    for group in groups.values():
        times = {name: statistics.median(row[name] for row in group) for name in TIMES if all(name in row for row in group)}
        yield group[0] | times


def ratio(row, own, name):
    return f"{row[name] / own[name]:.1f}" if name in row and own.get(name) and row is not own else ""


def page(measured, rounds, load):
    found = list(medians(measured))
    saltus = {row["problem"]: row for row in found if row["contender"] == "Saltus"}
    body = []
    for row in found:
        own = saltus[row["problem"]]
        if "objective" not in row:
            body.append([row["problem"], row["contender"], row["status"], *[""] * 8])
            continue
        body.append([row["problem"], row["contender"], row["status"], f"{row['objective']:.8g}",
                     f"{row['complementarity']:.0e}", str(row["iterations"]), f"{row['seconds']:.3f}",
                     ratio(row, own, "seconds"), f"{1e3 * row['build_seconds']:.1f}", ratio(row, own, "build_seconds"),
                     f"{100 * row['evaluation_seconds'] / row['seconds']:.1f}"])
    head = ["problem", "", "status", "objective", "complementarity", "iterations", "s", "ratio", "building, ms", "ratio",
            "evaluation, %"]
    ask = "from importlib.metadata import version; print(f'nosnoc {version(\"nosnoc\")}, CasADi {version(\"casadi\")}')"
    other = subprocess.run([NOSNOC, "-c", ask], capture_output=True, text=True, check=False) if NOSNOC.exists() else None
    versions = f"{contenders.machine()} (Release); {other.stdout.strip() if other else 'no nosnoc'}"
    return (f"# Optimal control: Saltus, a plain homotopy, nosnoc\n\n{versions}\n\nMade by `benchmarks/compare/optimal_control.py`; "
            f"how to read it: [benchmarks/README.md](../README.md). {f'Medians of {rounds} rounds' if rounds > 1 else 'One round'}; processes that wanted to run "
            f"meanwhile (load average behind): {load:.1f}.\n\n" + table.markdown([head, ["---"] * len(head), *body]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", type=pathlib.Path, default=contenders.ROOT / "build" / "release" / "bin" / "saltus",
                        help="the tool, a release build (default: build/release/bin/saltus)")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--problems", nargs="+", choices=PROBLEMS, default=list(PROBLEMS))
    parser.add_argument("--timeout", type=float, default=300.0, help="seconds per run (default 300)")
    parser.add_argument("--output", type=pathlib.Path, default=contenders.ROOT / "benchmarks" / "results")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    measured = []
    for row in rows(options.tool.resolve(), options.problems, options.rounds, options.timeout):
        measured.append(row)
        with (options.output / "optimal_control.csv").open("w", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, COLUMNS)
            writer.writeheader()
            writer.writerows(measured)
    text = page(measured, options.rounds, os.getloadavg()[2])
    (options.output / "optimal_control.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
