#!/usr/bin/env python3
"""`saltus optimize` on random problems: how often is it within 1 % of the best that is known, and how does it fail?

    python3 benchmarks/random_optima/run.py                       writes benchmarks/results/random_optima.md and .csv
    python3 benchmarks/random_optima/run.py --switches 5 --contacts 0 --limit 5 --output /tmp
    python3 benchmarks/random_optima/run.py --write contacts 3    prints the model file of a seed

Each problem is solved as it is, by a plain homotopy from the same start, and from 8 starts, the best of which is what counts as the
best; and with the elastic steering linf. What is in the .csv is not computed again. The problems, and the check of what is `completed`, are those of tests/optimal_control. How to read the table:
benchmarks/README.md.
"""

import argparse
import collections
import concurrent.futures
import csv
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "optimal_control"))
sys.path.insert(0, str(ROOT / "benchmarks" / "compare"))
import contenders as contenders_of_runs  # noqa: E402
from contact_problem import ContactProblem  # noqa: E402
from switched_problem import SwitchedProblem  # noqa: E402

FAMILIES = {kind.family: kind for kind in (SwitchedProblem, ContactProblem)}
SETTINGS = {
    "default": {},
    # One relaxed problem of Scholtes behind the other, from 1 down by tenths, and nothing behind them.
    "plain": {"solver": "ipopt", "steering": "direct", "crossover": "false"},
    "8 starts": {"starts": "8"},
    "linf": {"steering": "linf"},
}
JUDGES = ("default", "plain", "8 starts")  # whose best is what all are measured by
COLUMNS = ("family", "seed", "way", "status", "objective", "violation", "defect", "seconds", "iterations", "faults", "message")
FEASIBLE = 2e-4  # violation of a point that counts: products of 1e-8, where relaxed problems end, have sides of 1e-4
BEST = 1e-2  # of the objective, relative: as good as the best
SMALL = 1e-2  # objectives are of the size of 1; below it differences are absolute
FIRST_SEED = 1


def run_limited(command, limit):
    """Runs a command with a limit in CPU seconds; returns what it said of errors, and its CPU seconds."""
    def limits():
        resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(limit), math.ceil(limit) + 5))

    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=errors, env=environment, preexec_fn=limits)
        _, process.returncode, usage = os.wait4(process.pid, 0)
        errors.seek(0)
        return errors.read(), usage.ru_utime + usage.ru_stime


def measure(tool, problem, way, limit):
    """A row of the table: what one way comes to on one problem."""
    settings = [word for key, value in SETTINGS[way].items() for word in ("--set", f"optimize.mpcc.{key}={value}")]
    row = {"family": problem.family, "seed": problem.seed, "way": way}
    with tempfile.TemporaryDirectory() as folder:
        model, out = pathlib.Path(folder) / "model.toml", pathlib.Path(folder) / "r.json"
        model.write_text(problem.text(), encoding="utf-8")
        # The tool ends by itself at its limit, and writes what it has; the other one is for a tool that does not.
        errors, seconds = run_limited([tool, "optimize", model, "--quiet", "--time-limit", limit, *settings, "--out", out], 2 * limit + 10)
        if not out.exists():
            return row | {"status": "failed", "seconds": seconds, "message": " ".join(errors.split())}
        result = json.loads(out.read_text(encoding="utf-8"))
    status, certificate = result["status"], result["certificate"]
    residuals = [certificate[key] for key in ("primal_infeasibility", "complementarity_residual")]
    return row | {
        "status": status["termination"], "objective": result["objective"],
        "violation": math.inf if None in residuals else max(residuals),
        "defect": result.get("verification", {}).get("interval_defect"),
        "seconds": seconds, "iterations": result["statistics"]["iterations"],
        "faults": "; ".join(problem.faults(result)) if status["termination"] == "completed" else "",
        "message": " ".join(status["message"].split())}


def number(row, key):
    text = row.get(key)
    return None if text in (None, "") else float(text)


def objective_of(row):
    """Of a point that satisfies all constraints, whatever its program says of it; None of another."""
    violation = number(row, "violation")
    return number(row, "objective") if violation is not None and violation <= FEASIBLE else None


def is_verified(row):
    """Whether the system itself moves like that."""
    defect = number(row, "defect")
    return defect is not None and defect <= FAMILIES[row["family"]].tolerance


def best_of(rows, counts=lambda row: True):
    """The judge's row with the least objective of the points that count; None without any."""
    points = [row for row in rows if row["way"] in JUDGES and objective_of(row) is not None and counts(row)]
    return min(points, key=objective_of, default=None)


def excess(row, best):
    """How much worse than the best, relative; None without a feasible point."""
    value = objective_of(row)
    return None if value is None or best is None else (value - objective_of(best)) / max(abs(objective_of(best)), SMALL)


def is_good(row, best):
    worse = excess(row, best)
    return worse is not None and worse <= BEST


def kind_of(ways):
    """How the default failed, or None where it did not."""
    row = ways["default"]
    if row["status"] == "completed" and not is_good(row, best_of(ways.values(), is_verified)):
        return "worse optimum"
    return None if row["status"] == "completed" else row["status"]


def by_problem(rows):
    grouped = collections.defaultdict(dict)
    for row in rows:
        grouped[row["family"], int(row["seed"])][row["way"]] = row
    return {key: ways for key, ways in sorted(grouped.items(), reverse=True) if all(way in ways for way in JUDGES)}


def shares(problems):
    """Lines of a table: of each family and way how many come to the best, and how many of these are certified."""
    lines = ["| problems | way | feasible | within 1 % of the best feasible point | … and verified | within 1 % of the best verified point | "
             "completed | of these not solved when recomputed | seconds, mean |", "|---|---|---:|---:|---:|---:|---:|---:|---:|"]
    for family in FAMILIES:
        known = [ways for (own, _), ways in problems.items() if own == family]
        best = [(ways, best_of(ways.values())) for ways in known]
        verified = [(ways, best_of(ways.values(), is_verified)) for ways in known]
        share = lambda good, of: f"{len(good)} of {(n := sum(point is not None for _, point in of))} ({100 * len(good) / max(n, 1):.0f} %)"
        for way in SETTINGS if known else ():
            if not all(way in ways for ways in known):
                continue
            rows = [ways[way] for ways in known]
            completed = [row for row in rows if row["status"] == "completed"]
            near = [ways[way] for ways, point in best if is_good(ways[way], point)]
            near_verified = [ways[way] for ways, point in verified if is_good(ways[way], point) and is_verified(ways[way])]
            lines.append(
                f"| {len(known)} with {family} | {way} | {sum(objective_of(row) is not None for row in rows)} | {share(near, best)} | "
                f"{sum(map(is_verified, near))} | {share(near_verified, verified)} | {len(completed)} | "
                f"{sum(bool(row['faults']) for row in completed)} | {sum(number(row, 'seconds') for row in rows) / len(rows):.2f} |")
    return lines


def failures(problems):
    """Lines of a table: the problems that the default does not solve, by kind."""
    lines = ["| kind | problems | seed | objective | the best feasible | by | its defect | the best verified | by | message |",
             "|---|---|---:|---:|---:|---|---:|---:|---|---|"]
    found = []
    for (family, seed), ways in problems.items():
        if kind := kind_of(ways):
            cell = lambda row, key: "–" if row is None or not row[key] else f"{float(row[key]):.5g}" if key != "way" else row[key]
            row, best, verified = ways["default"], best_of(ways.values()), best_of(ways.values(), is_verified)
            message = row["message"].replace("|", "\\|")
            found.append((kind, family, seed, cell(best_of([row]), "objective"), cell(best, "objective"), cell(best, "way"), cell(best, "defect"),
                          cell(verified, "objective"), cell(verified, "way"), message if len(message) < 160 else message[:157] + "…"))
    return lines + ["| " + " | ".join(map(str, line)) + " |" for line in sorted(found)]


def page(rows, limit):
    problems = by_problem(rows)
    kinds = collections.Counter((family, kind_of(ways)) for (family, _), ways in problems.items())
    counts = [f"{family}: {count} {kind}" for (family, kind), count in sorted(kinds.items(), key=str) if kind]
    wrong = [f"* {row['family']} {row['seed']}, {row['way']}: {row['faults']}" for ways in problems.values() for row in ways.values() if row["faults"]]
    return "\n".join([
        "# Random optima", "",
        f"{len(problems)} random problems, at most {limit:g} s for each start, on {contenders_of_runs.machine()}. Written by "
        "benchmarks/random_optima/run.py; how to read it: [benchmarks/README.md](../README.md).", "",
        *shares(problems), "", "Not solved by the default, by kind: " + ("; ".join(counts) or "none") + ".", "", *failures(problems),
        *(["", "Completed, and not solved when recomputed:", "", *wrong] if wrong else []), ""])


def read(path):
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def run_all(wanted, path, jobs, task):
    """Runs what is not in the file yet, and appends each row as it comes."""
    done = {(row["family"], int(row["seed"]), row["way"]) for row in read(path)}
    left = [key for key in wanted if key not in done]
    is_new = not path.exists()
    with path.open("a", newline="", encoding="utf-8") as stream, concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        table = csv.DictWriter(stream, COLUMNS)
        if is_new:
            table.writeheader()
        for row in pool.map(lambda key: task(*key), left):
            table.writerow(row)
            stream.flush()
            print(*(row.get(key) for key in ("family", "seed", "way", "status", "objective", "seconds", "faults")), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "bin" / "saltus")
    parser.add_argument("--switches", type=int, default=400, help="how many problems with switches")
    parser.add_argument("--contacts", type=int, default=100, help="how many problems with contacts")
    parser.add_argument("--limit", type=float, default=30.0, help="seconds for a start; 8 starts have four times as many together")
    parser.add_argument("--ways", nargs="+", choices=SETTINGS, default=list(SETTINGS))
    parser.add_argument("--jobs", type=int, default=1, help="runs at once")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "benchmarks" / "results")
    parser.add_argument("--write", nargs=2, metavar=("FAMILY", "SEED"), help="print a model file, and end")
    options = parser.parse_args()
    if options.write:
        print(FAMILIES[options.write[0]](int(options.write[1])).text(), end="")
        return
    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / "random_optima.csv"
    counts = {"switches": options.switches, "contacts": options.contacts}
    wanted = [(family, seed, way) for family, count in counts.items() for seed in range(FIRST_SEED, FIRST_SEED + count) for way in options.ways]

    def task(family, seed, way):
        limit = options.limit * (4 if way == "8 starts" else 1)
        return measure(options.tool.resolve(), FAMILIES[family](seed), way, limit)

    run_all(wanted, path, options.jobs, task)
    rows = [row for row in read(path) if (row["family"], int(row["seed"]), row["way"]) in set(wanted)]
    text = page(rows, options.limit)
    (options.output / "random_optima.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
