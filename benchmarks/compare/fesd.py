#!/usr/bin/env python3
"""Saltus' method fesd against PyPI's nosnoc: the same models, schemes and simulation steps, in one run.

    python3 benchmarks/compare/fesd.py                      writes benchmarks/results/fesd.md and fesd.csv
    python3 benchmarks/compare/fesd.py --keep-nosnoc        measures Saltus anew, keeps the rest

Success of every simulation step, error of the end state against tests/problems/references.json, CPU time per step
without what is done once per model. nosnoc gets a virtual environment of its own (scripts/install_benchmarks.sh); where
it cannot be installed its rows say so.
"""

import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys

import contenders
import table

HERE = pathlib.Path(__file__).resolve().parent
NOSNOC = contenders.BUILD / "nosnoc-venv" / "bin" / "python3"
# Simulation steps of two elements: an element is a tenth of a slip phase of stick-slip, a twentieth of a turn of the
# relay's fast mode, a time constant of the fastest gene of IRMA.
PROBLEMS = {"irma": (1000.0, 500), "stick-slip": (40.0, 200), "relay-feedback": (10.0, 400)}
# nosnoc's own number of stages in both forms; and four stages, which at these steps are enough for 1e-8.
SCHEMES = (("radau_iia", 2), ("radau_iia", 4))
VARIANTS = ("shipped", "fast")
COLUMNS = ("problem", "form", "scheme", "steps", "contender", "failed", "error", "seconds_per_step", "build_seconds")


def references():
    """End states of the catalogue's models at their own ends."""
    stored = json.loads((contenders.ROOT / "tests/problems/references.json").read_text())["problems"]
    return {entry["model"]: entry["final"]["x"] for entry in stored
            if entry["model"] in PROBLEMS and "case" not in entry and entry["until"] == PROBLEMS[entry["model"]][0]}


def run_nosnoc(problem, form, scheme, stages, variant, timeout):
    until, steps = PROBLEMS[problem]
    command = [NOSNOC, HERE / "nosnoc_runner.py", problem, form, scheme, stages, steps, until, variant]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment, timeout=timeout,
                          check=True)
    run = json.loads(done.stdout.splitlines()[-1])
    return {"failed": run["failed"], "x": run["x"], "seconds_per_step": run["seconds"] / steps,
            "build_seconds": run["build_seconds"]}


def run_saltus(program, problem, form, scheme, stages, seconds=0.5):
    until, steps = PROBLEMS[problem]
    command = [program, contenders.ROOT / "models" / f"{problem}.toml", form, scheme, stages, steps, until, seconds]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "XDG_CACHE_HOME": str(contenders.CACHE)}
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment, check=True)
    run = json.loads(done.stdout)
    return {"failed": 0 if run["status"] == "completed" else run["status"], "x": run["x"],
            "seconds_per_step": run["seconds_per_step"], "build_seconds": run["build_seconds"]}


def lines():
    """Problem, scheme, stages, form; what is measured first costs least."""
    for scheme, stages in SCHEMES:
        for problem in sorted(PROBLEMS, key=lambda name: PROBLEMS[name][1]):
            # 128 regions of seven thresholds are none of the forms in which nosnoc states IRMA.
            both = problem != "irma" and stages == SCHEMES[0][1]
            for form in ("step", "stewart") if both else ("step",):
                yield problem, scheme, stages, form


def measured_row(row, run, exact):
    try:
        found = run()
    except subprocess.TimeoutExpired as late:
        return {**row, "failed": f"more than {late.timeout:g} s"}
    except subprocess.CalledProcessError as failure:
        return {**row, "failed": (failure.stderr.strip().splitlines() or ["failed"])[-1]}
    error = max(abs(a - b) for a, b in zip(found.pop("x"), exact[row["problem"]], strict=True))
    return {**row, **found, "error": error}


def rows(program, timeout, kept):
    """One by one, contender by contender; `kept`: rows of nosnoc measured before, by key, if it is not to run again."""
    exact = references()
    installed = contenders.succeeds(NOSNOC, "-c", "import nosnoc")
    for variant in (*VARIANTS, None):
        for problem, scheme, stages, form in lines():
            row = {"problem": problem, "form": form, "scheme": f"{scheme} {stages}", "steps": PROBLEMS[problem][1],
                   "contender": f"nosnoc, {variant}" if variant else "Saltus"}
            print(*row.values(), file=sys.stderr, flush=True)
            if variant is None:
                yield measured_row(row, lambda: run_saltus(program, problem, form, scheme, stages), exact)
            elif kept is not None:
                yield kept.get(key(row), {**row, "failed": "not measured"})
            elif not installed:
                yield {**row, "failed": "not installed"}
            else:
                yield measured_row(row, lambda: run_nosnoc(problem, form, scheme, stages, variant, timeout), exact)


def by_line(measured):
    """Lines in the order of `lines`, Saltus first."""
    order = {line: place for place, line in enumerate((p, form, f"{scheme} {n}") for p, scheme, n, form in lines())}
    return sorted(measured, key=lambda row: (order[row["problem"], row["form"], row["scheme"]],
                                             row["contender"] != "Saltus"))


def key(row):
    return tuple(str(row[column]) for column in ("problem", "form", "scheme", "steps", "contender"))


def stored_rows(file):
    """Rows of an earlier run, with numbers where there were any."""
    if not file.exists():
        return []
    numbers = ("error", "seconds_per_step", "build_seconds")
    with file.open(newline="", encoding="utf-8") as stream:
        return [{name: float(value) if name in numbers else value for name, value in row.items() if value != ""}
                for row in csv.DictReader(stream)]


def versions():
    """Of the machine, and of what is in the virtual environment of nosnoc."""
    ask = "from importlib.metadata import version; print(f'nosnoc {version(\"nosnoc\")}, CasADi {version(\"casadi\")}')"
    try:
        other = subprocess.run([NOSNOC, "-c", ask], capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        other = "no nosnoc"
    return f"{contenders.machine()} (Release); {other}"


def page(measured, loads, remark):
    body = []
    saltus = {row_line(row): row.get("seconds_per_step") for row in measured if row["contender"] == "Saltus"}
    for row in measured:
        time, own = row.get("seconds_per_step"), saltus.get(row_line(row))
        ratio = time / own if time and own and row["contender"] != "Saltus" else None
        body.append([row["problem"], row["form"], row["scheme"], str(row["steps"]), row["contender"],
                     str(row["failed"]), f"{row['error']:.1e}" if "error" in row else "–",
                     f"{1e3 * time:.3g}" if time else "–", f"{ratio:.0f}" if ratio else ""])
    head = ["problem", "form", "scheme", "steps", "", "failed steps", "error", "ms per step", "ratio"]
    return (f"# FESD: Saltus and nosnoc\n\n{versions()}\n\nMade by `benchmarks/compare/fesd.py`; how to read it: "
            "[benchmarks/README.md](../README.md). Processes that wanted to run meanwhile (load average before and "
            f"behind): {loads[0]:.1f}, {loads[1]:.1f}.{remark}\n\n" + table.markdown([head, ["---"] * len(head), *body]))


def row_line(row):
    return key({**row, "contender": ""})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, help="compare_fesd (default: built in build/benchmarks)")
    parser.add_argument("--timeout", type=float, default=900.0, help="seconds per run of nosnoc (default 900)")
    parser.add_argument("--keep-nosnoc", action="store_true", help="take the rows of nosnoc from the earlier fesd.csv")
    parser.add_argument("--output", type=pathlib.Path, default=contenders.ROOT / "benchmarks" / "results")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    file = options.output / "fesd.csv"
    stored = {key(row): row for row in stored_rows(file) if row["contender"] != "Saltus"}
    program = options.program or contenders.build(contenders.BUILD / "cmake", ("compare_fesd",)) / "compare_fesd"
    load_before = os.getloadavg()[2]
    measured = []
    for row in rows(program.resolve(), options.timeout, stored if options.keep_nosnoc else None):
        measured.append(row)
        with file.open("w", newline="", encoding="utf-8") as stream:  # what is measured is kept, whatever follows
            writer = csv.DictWriter(stream, COLUMNS)
            writer.writeheader()
            writer.writerows(by_line(measured))
    remark = " The rows of nosnoc are those of an earlier run." if options.keep_nosnoc else ""
    text = page(by_line(measured), (load_before, os.getloadavg()[2]), remark)
    (options.output / "fesd.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
