#!/usr/bin/env python3
"""`saltus mpcc` on every file of a folder, against a plain homotopy over Ipopt and PyPI's mpecss.

    python3 benchmarks/mpcc/run.py FOLDER                    writes benchmarks/results/mpcc.md and .csv
    python3 benchmarks/mpcc/run.py FOLDER --limit 5 --contenders Saltus --output /tmp

Files are AMPL .nl text and JSON of NOSBENCH. mpecss reads the latter only, and takes part where its environment is there
(scripts/install_benchmarks.sh). How to read the table: benchmarks/README.md.
"""

import argparse
import csv
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "compare"))
import contenders as contenders_of_runs  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
MPECSS = ROOT / "build" / "benchmarks" / "mpecss-venv" / "bin" / "python3"
# The plain homotopy: one relaxed problem of Scholtes behind the other, from 1 down by tenths, and nothing behind them.
PLAIN = ("--solver", "ipopt", "--set", "mpcc.steering=direct", "--set", "mpcc.crossover=false")
CONTENDERS = ("Saltus", "plain", "mpecss")
COLUMNS = ("file", "contender", "n", "pairs", "status", "objective", "violation", "seconds", "iterations")
SOLVED = 2e-4  # violation of a point that counts: products of 1e-8, where relaxed problems end, have sides of 1e-4
BEST = 1e-3  # of the objective, relative: as good as the best


def run_limited(command, limit):
    """Output of a command, and its CPU seconds; None where it had to be ended."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    try:
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment, timeout=limit)
    except subprocess.TimeoutExpired:
        done = None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def run_saltus(tool, file, limit, settings):
    """CPU time is that of the whole program: reading and derivatives, too."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "result.json"
        done, seconds = run_limited([tool, "mpcc", file, "--quiet", "--time-limit", limit, *settings, "--out", out], 2 * limit + 10)
        if not out.exists():
            return {"status": "time_limit" if done is None else "failed", "seconds": seconds}
        result = json.loads(out.read_text(encoding="utf-8"))
    certificate, spent = result["certificate"], result["statistics"]
    residuals = [certificate[key] for key in ("primal_infeasibility", "complementarity_residual")]
    worst = math.nan if None in residuals else max(residuals)
    return {"n": len(result["x"]), "pairs": spent["pairs"], "status": result["status"]["termination"],
            "objective": result["objective"], "violation": worst, "seconds": seconds, "iterations": spent["iterations"]}


def run_mpecss(file, limit):
    if file.suffix != ".json":
        return {"status": "not read"}
    runner = pathlib.Path(__file__).with_name("mpecss_runner.py")
    done, seconds = run_limited([MPECSS, runner, file, limit], 2 * limit + 10)
    if done is None:
        return {"status": "time_limit", "seconds": seconds}
    if done.returncode != 0:
        return {"status": "failed", "seconds": seconds}
    return json.loads(done.stdout.splitlines()[-1])


def measure(contender, tool, file, limit):
    if contender == "mpecss":
        found = run_mpecss(file, limit)
    else:
        found = run_saltus(tool, file, limit, PLAIN if contender == "plain" else ())
    return {"file": file.name, "contender": contender, **found}


def is_feasible(row):
    """A point that satisfies all constraints, whatever its program says of it."""
    return row.get("objective") is not None and row.get("violation", math.inf) <= SOLVED


def near(a, b):
    return abs(a - b) <= BEST * max(1.0, abs(b))


def geometric_mean(ratios):
    return math.exp(sum(map(math.log, ratios)) / len(ratios)) if ratios else math.nan


def summary(rows, contenders):
    """Lines of a table: how many each has solved, how many as well as the best, its time over that of the first."""
    by_file = {}
    for row in rows:
        by_file.setdefault(row["file"], {})[row["contender"]] = row
    best = {file: min((row["objective"] for row in of.values() if is_feasible(row)), default=None) for file, of in by_file.items()}
    lines = ["| contender | read | feasible to 2e-4 | of these certified | as good as the best | time over that of the first | on files |",
             "|---|---|---|---|---|---|---|"]
    for contender in contenders:
        own = [of[contender] for of in by_file.values() if contender in of and of[contender]["status"] != "not read"]
        feasible = [row for row in own if is_feasible(row)]
        certified = sum(row["status"] == "completed" for row in feasible) if contender == "Saltus" else "–"
        good = sum(near(row["objective"], best[row["file"]]) for row in feasible)
        ratios = [of[contender]["seconds"] / of[contenders[0]]["seconds"] for of in by_file.values()
                  if all(name in of and is_feasible(of[name]) for name in (contender, contenders[0]))]
        lines.append(f"| {contender} | {len(own)} | {len(feasible)} | {certified} | {good} | {geometric_mean(ratios):.2f} | {len(ratios)} |")
    return lines


def cell(row, key):
    value = row.get(key)
    if value is None or isinstance(value, float) and math.isnan(value):
        return "–"
    if key in ("violation", "seconds"):
        return f"{value:.1e}" if key == "violation" else f"{value:.2f}"
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def write(rows, contenders, limit, output):
    output.mkdir(parents=True, exist_ok=True)
    with open(output / "mpcc.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows(rows)
    lines = ["# Foreign MPCCs", "",
             f"{len({row['file'] for row in rows})} files, at most {limit:g} s each, on {contenders_of_runs.machine()}. Written by benchmarks/mpcc/run.py; "
             "how to read it: [benchmarks/README.md](../README.md).", "", *summary(rows, contenders), "",
             "| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(cell(row, key) for key in COLUMNS) + " |" for row in rows if row["status"] != "not read"]
    (output / "mpcc.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "bin" / "saltus")
    parser.add_argument("--limit", type=float, default=20.0, help="seconds for one file")
    parser.add_argument("--contenders", nargs="+", choices=CONTENDERS, default=CONTENDERS)
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "benchmarks" / "results")
    arguments = parser.parse_args()
    files = sorted(file for file in arguments.folder.iterdir() if file.suffix in (".nl", ".json"))
    contenders = list(arguments.contenders)
    if "mpecss" in contenders and not MPECSS.exists():
        print("mpecss is not installed (scripts/install_benchmarks.sh): going on without it", file=sys.stderr)
        contenders.remove("mpecss")
    rows = []
    for file in files:
        for contender in contenders:
            rows.append(measure(contender, arguments.tool, file, arguments.limit))
            print(" ".join(cell(rows[-1], key) for key in COLUMNS), flush=True)
    write(rows, contenders, arguments.limit, arguments.output)
    print("\n".join(summary(rows, contenders)))


if __name__ == "__main__":
    main()
