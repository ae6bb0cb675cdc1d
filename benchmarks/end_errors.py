"""What a tolerance means at the end of a run: the largest error of the end state over rtol, for the whole catalogue.

usage: end_errors.py TOOL [--rtol 1e-4,1e-6,1e-8,1e-10] [--out results/end_errors.md]

Ends are compared with references of 20 digits and more (tests/problems/references.json): |error| / (0.01 + |x|), at
atol = rtol / 100. A figure of 2 says that the end is as wrong as two tolerances, whatever the events between.
"""

import argparse
import json
import statistics
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
INTEGRATORS = ("auto", "dopri5", "dop853", "taylor", "radau5", "radau9", "radau13")
ROUNDING = 1e-13


def simulate(tool, problem, integrator, rtol):
    """The end state of a run, or None where it stops early."""
    command = [tool, "simulate", problem["model"], "--quiet", "--integrator", integrator, "--rtol", str(rtol), "--atol",
               str(0.01 * rtol), "--until", repr(problem["until"]), "--set", "simulate.output=steps", "--out", "-"]
    for name, value in problem.get("overrides", {}).items():
        command += ["--set", f"{name}={value!r}"]
    for surface, mode in problem.get("initial_mode", {}).items():
        command += ["--set", f"simulate.initial_mode.{surface}={mode}"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    result = json.loads(run.stdout) if run.returncode == 0 else None
    return result["final"]["x"] if result and result["status"]["termination"] == "completed" else None


def error_of(x, exact):
    """Largest error of a component, relative to a hundredth and the component."""
    return max((abs(a - b) / (0.01 + abs(b)) for a, b in zip(x, exact)), default=0.0)


def row_of(tool, problems, integrator, rtol):
    """(median, 95th percentile, largest, its model, runs) of errors over rtol."""
    found = []
    for problem in problems:
        end = simulate(tool, problem, integrator, rtol)
        if end is None:
            continue
        error = error_of(end, problem["final"]["x"])
        found.append((max(0.0, error - ROUNDING) / rtol, problem["model"]))
    found.sort()
    values = [value for value, _ in found]
    return statistics.median(values), values[int(0.95 * (len(values) - 1))], *found[-1], len(values)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--rtol", default="1e-4,1e-6,1e-8,1e-10")
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    problems = json.loads((ROOT / "tests/problems/references.json").read_text(encoding="utf-8"))["problems"]
    lines = ["# Errors at the end, over rtol", "",
             f"Made by `benchmarks/end_errors.py`: {len(problems)} problems of the catalogue with references of 20 digits and more; atol = rtol / 100;",
             "the largest |error| / (0.01 + |x|) of the end state, in units of rtol. It does not depend on the machine.", "",
             "| integrator | rtol | median | 95 % | largest | of | runs |", "| --- | --- | ---: | ---: | ---: | --- | ---: |"]
    for integrator in INTEGRATORS:
        for rtol in arguments.rtol.split(","):
            median, most, largest, model, runs = row_of(arguments.tool, problems, integrator, float(rtol))
            lines.append(f"| {integrator} | {rtol} | {median:.2g} | {most:.2g} | {largest:.2g} | {model} | {runs} |")
            print(lines[-1], flush=True)
    if arguments.out:
        arguments.out.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
