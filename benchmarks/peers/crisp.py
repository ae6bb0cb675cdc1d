#!/usr/bin/env python3
"""B2: contact-implicit problems on implicit Euler grids, each solved by Saltus, a plain Ipopt homotopy and mpecss from one file.

    python3 benchmarks/peers/crisp.py [--limit 60]          writes benchmarks/results/crisp.md

The problems are restated from numbers of the literature on contact-implicit optimisation (crisp_problems.py says which are ours).
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import common

sys.path.insert(0, str(common.ROOT / "benchmarks" / "mpcc"))
import run as mpcc  # noqa: E402

TEXT = """
Each problem is one file (functions of CasADi in JSON), which all three programs read. `transport` and `push-bot` are on the grid of 0.02 s, `push` of 0.05 s.
The violation is the largest of any constraint, of a pair the smaller side. *Error of the grid*: the controls found by Saltus, simulated by the event
engine in continuous time; the largest difference of the end state from that of the grid. It says what the grid of implicit Euler is worth, whoever solves it
(`push-bot` is unstable: its errors grow a thousandfold in two seconds).
CPU seconds: of Saltus with the start of the program, reading and derivatives; of the others without. `plain` is Scholtes' relaxation from 1 down by tenths over Ipopt.
The hopper of the same set needs a choice of foot placement that the published numbers leave open, and is not here.
"""
COLUMNS = {"problem": "problem", "contender": "program", "n": "variables", "pairs": "pairs", "status": "status", "objective": "objective",
           "violation": "violation", "seconds": "CPU s", "iterations": "iterations", "grid": "error of the grid"}


def solve(folder, problem, tool, limit):
    file = folder / f"{problem}.json"
    rows = []
    for contender in ("Saltus", "plain", "mpecss"):
        if contender == "mpecss" and not mpcc.MPECSS.exists():
            rows.append({"problem": problem, "contender": contender, "status": "not installed"})
            continue
        rows.append({"problem": problem, **mpcc.measure(contender, tool, file, limit)})
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for one problem and program")
    parser.add_argument("--tool", type=pathlib.Path, default=common.ROOT / "build" / "release" / "bin" / "saltus")
    arguments = parser.parse_args()
    rows = []
    python, script = common.python_of("Saltus"), common.HERE / "crisp_problems.py"
    environment = {**os.environ, **common.ONE_THREAD, "PYTHONPATH": str(common.ROOT / "build" / "release" / "python")}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        subprocess.run([python, script, "write", folder], check=True, env=environment)
        for problem in ("transport", "push-bot", "push"):
            found = solve(folder, problem, arguments.tool, arguments.limit)
            out = folder / f"{problem}.result.json"
            subprocess.run([arguments.tool, "mpcc", folder / f"{problem}.json", "--quiet", "--time-limit", str(arguments.limit), "--out", out], check=False)
            done = subprocess.run([python, script, "grid", problem, out], capture_output=True, text=True, env=environment, check=False)
            if done.returncode == 0:
                found[0]["grid"] = json.loads(done.stdout)
            else:
                print(done.stderr[-1500:])
            rows += found
    common.write("crisp", "Contact-implicit problems on Euler grids", TEXT, rows, COLUMNS)


if __name__ == "__main__":
    main()
