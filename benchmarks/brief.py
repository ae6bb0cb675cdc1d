#!/usr/bin/env python3
"""Runs every benchmark command of a build for about a second: does it start, and does it still find what it is measured against?

    cmake -S . -B build -DSALTUS_BENCHMARKS=ON && cmake --build build
    python3 benchmarks/brief.py build

No figure of such a run means anything; what it writes goes into BUILD/brief. What needs SUNDIALS, SciPy or nosnoc is left out.
Exit code 1 if a command fails.
"""

import argparse
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
RESULTS = HERE / "results"


def programs(build):
    """Command lines of the programs of benchmarks/micro."""
    return [[program, "--benchmark_min_time=0.01"] for program in sorted((build / "benchmarks").glob("bench_*"))]


def scripts(build, output):
    """Command lines of the scripts, as short as their arguments allow."""
    tool, compare = build / "bin" / "saltus", build / "benchmarks" / "compare"
    return [
        [HERE / "compare/run.py", "--no-install", "--build", build, "--rounds", "1", "--seconds", "0.001",
         "--contenders", "Saltus", "by hand", "--output", output],
        [HERE / "compare/bodies.py", compare, "--rounds", "1", "--seconds", "0.001"],
        # The rows of nosnoc are those that are stored: the file beside them is rewritten.
        [HERE / "compare/fesd.py", "--program", compare / "compare_fesd", "--keep-nosnoc", "--output", output],
        [HERE / "compare/optimal_control.py", "--tool", tool, "--rounds", "1", "--problems", "turbo car", "--output", output],
        [HERE / "mpcc/run.py", HERE.parent / "examples/mpcc", "--tool", tool, "--limit", "1", "--contenders", "Saltus", "--output", output],
        [HERE / "random_optima/run.py", "--tool", tool, "--switches", "1", "--contacts", "0", "--limit", "5", "--output", output],
        [HERE / "large/run.py", tool, "--sizes", "10", "--limit", "10", "-o", output / "large.md"],
        [HERE / "large/fesd.py", tool, "--sizes", "5", "--steps", "10", "--repeats", "1"],
        [HERE / "monoped/run.py", tool, "--intervals", "5", "--seconds", "1"],
        [compare / "compare_catalogue_events", output / "models"],
    ]


def runs(command, limit):
    """Whether a command ends with success; its last lines are shown where it does not."""
    words = [str(word) for word in command]
    if words[0].endswith(".py"):
        words.insert(0, sys.executable)
    begin = time.monotonic()
    try:
        # A session of its own, so that what a command has started ends with it.
        process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
        text, _ = process.communicate(timeout=limit)
        outcome = "" if process.returncode == 0 else f"exit code {process.returncode}\n{text[-2000:]}"
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        outcome = f"more than {limit:g} s"
    except OSError as error:
        outcome = str(error)
    print(f"{time.monotonic() - begin:6.1f} s  {' '.join(words)}{'  FAILED: ' + outcome if outcome else ''}", flush=True)
    return not outcome


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, help="build folder, with -DSALTUS_BENCHMARKS=ON")
    parser.add_argument("--limit", type=float, default=300.0, help="seconds per command (default 300)")
    options = parser.parse_args()
    build = options.build.resolve()
    output = build / "brief"
    output.mkdir(parents=True, exist_ok=True)
    shutil.copy(RESULTS / "fesd.csv", output)
    (output / "models").mkdir(exist_ok=True)
    shutil.copy(HERE.parent / "models" / "stick-slip.toml", output / "models")
    commands = programs(build)
    if not commands:
        sys.exit(f"{build} has no benchmarks: configure it with -DSALTUS_BENCHMARKS=ON, and install libbenchmark-dev")
    failed = [command for command in commands + scripts(build, output) if not runs(command, options.limit)]
    print("Left out, as they need SciPy, SUNDIALS or the Python package: large/rod.py, large/local_steps.py, sweeps/run.py")
    print(f"{len(failed)} commands failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
