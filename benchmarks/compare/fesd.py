#!/usr/bin/env python3
"""Saltus' method fesd against PyPI's nosnoc: the same models, schemes and simulation steps, in one run.

    python3 benchmarks/compare/fesd.py --tool build/bin/saltus      writes benchmarks/results/fesd.md and fesd.csv

Success of every simulation step, error of the end state against tests/problems/references.json, CPU time per step
without what is done once per model. nosnoc gets a virtual environment of its own (scripts/install_benchmarks.sh); where
it cannot be installed its rows say so.
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

import contenders
import table

HERE = pathlib.Path(__file__).resolve().parent
NOSNOC = contenders.BUILD / "nosnoc-venv" / "bin" / "python3"
# Simulation steps of two elements: an element is a tenth of a slip phase of stick-slip, a twentieth of a turn of the
# relay's fast mode, a time constant of the fastest gene of IRMA.
PROBLEMS = {"irma": (1000.0, 500), "stick-slip": (40.0, 200), "relay-feedback": (10.0, 400)}
SCHEMES = (("radau_iia", 2), ("radau_iia", 3), ("gauss_legendre", 2))
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


def simulate(tool, problem, settings):
    """The result of one run; a status other than completed is no error here."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "r.json"
        sets = [word for key, value in settings.items() for word in ("--set", f"simulate.{key}={value}")]
        subprocess.run([tool, "simulate", problem, "--quiet", "--out", out, *sets], check=False, capture_output=True)
        return json.loads(out.read_text())


def run_saltus(tool, problem, form, scheme, stages, repeats=5):
    until, steps = PROBLEMS[problem]
    common = {"method": "fesd", "output.points": 2, "fesd.scheme": scheme, "fesd.stages": stages,
              "fesd.reformulation": form, "fesd.elements": 2}
    results = [simulate(tool, problem, {**common, "fesd.steps": steps}) for _ in range(repeats)]
    # One step tells what building costs.
    single = [simulate(tool, problem, {**common, "fesd.steps": 1, "until": until / steps}) for _ in range(repeats)]
    once = statistics.median(run["statistics"]["wall_seconds"] for run in single)
    whole = statistics.median(run["statistics"]["wall_seconds"] for run in results)
    result = results[0]
    done = result["status"]["termination"] == "completed"
    return {"failed": 0 if done else result["status"]["termination"], "x": result["final"]["x"],
            "seconds_per_step": (whole - once) / (steps - 1), "build_seconds": once}


def rows(tool, timeout):
    exact = references()
    installed = contenders.succeeds(NOSNOC, "-c", "import nosnoc")
    for problem, (_, steps) in PROBLEMS.items():
        for scheme, stages in SCHEMES:
            for form in ("step", "stewart"):
                line_up = {"Saltus": lambda: run_saltus(tool, problem, form, scheme, stages)}
                # 128 regions of seven thresholds are none of the forms in which nosnoc states IRMA.
                if problem != "irma" or form == "step":
                    for variant in ("shipped", "fast"):
                        line_up[f"nosnoc, {variant}"] = (
                            lambda v=variant: run_nosnoc(problem, form, scheme, stages, v, timeout))
                for name, run in line_up.items():
                    row = {"problem": problem, "form": form, "scheme": f"{scheme} {stages}", "steps": steps,
                           "contender": name}
                    print(*row.values(), file=sys.stderr, flush=True)
                    if name != "Saltus" and not installed:
                        yield {**row, "failed": "not installed"}
                        continue
                    try:
                        found = run()
                    except subprocess.TimeoutExpired:
                        yield {**row, "failed": f"more than {timeout:g} s"}
                        continue
                    except subprocess.CalledProcessError as failure:
                        yield {**row, "failed": failure.stderr.strip().splitlines()[-1]}
                        continue
                    error = max(abs(a - b) for a, b in zip(found.pop("x"), exact[problem], strict=True))
                    yield {**row, **found, "error": error}


def page(measured):
    lines = []
    saltus = {}
    for row in measured:
        key = (row["problem"], row["form"], row["scheme"])
        time = row.get("seconds_per_step")
        if row["contender"] == "Saltus":
            saltus[key] = time
        ratio = time / saltus[key] if time and saltus.get(key) and row["contender"] != "Saltus" else None
        lines.append([row["problem"], row["form"], row["scheme"], str(row["steps"]), row["contender"],
                      str(row["failed"]), f"{row['error']:.1e}" if "error" in row else "–",
                      f"{1e3 * time:.3g}" if time else "–", f"{ratio:.0f}" if ratio else ""])
    head = ["problem", "form", "scheme", "steps", "", "failed steps", "error", "ms per step", "ratio"]
    lines.insert(0, ["---"] * len(head))
    return ("# FESD: Saltus and nosnoc\n\nMade by `benchmarks/compare/fesd.py`; how to read it: "
            "[benchmarks/README.md](../README.md).\n\n" + table.markdown([head, *lines]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", type=pathlib.Path, required=True, help="the saltus tool of a release build")
    parser.add_argument("--timeout", type=float, default=600.0, help="seconds per run of nosnoc (default 600)")
    parser.add_argument("--output", type=pathlib.Path, default=contenders.ROOT / "benchmarks" / "results")
    options = parser.parse_args()
    measured = list(rows(options.tool.resolve(), options.timeout))
    options.output.mkdir(parents=True, exist_ok=True)
    with (options.output / "fesd.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        writer.writerows(measured)
    (options.output / "fesd.md").write_text(page(measured), encoding="utf-8")


if __name__ == "__main__":
    main()
