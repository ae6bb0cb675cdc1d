"""Instructions of runs (valgrind's callgrind): what a change costs, whatever else the machine does.

usage: instructions.py BUILD [--record | --out FILE] [--against [FILE]] [--bound 1.02] [--only WORD] [--jobs N]

BUILD is a build folder with bin/saltus and benchmarks/compare/compare_saltus (cmake --preset release -DSALTUS_BENCHMARKS=ON).
Measured are the four problems of the comparison at every other of its tolerances (1e-4 to 1e-10) and the models of the
events table at rtol 1e-8, by compare_saltus, and five runs of the catalogue by the tool; with the models of the events
table the choice of an integrator beside the one that it takes, whose ratio is printed and has the bound, too. What starting, reading and building cost is taken away: each
figure is the difference between two runs of the program. compare_saltus goes on with its tolerances
behind the first one (an integration that is repeated: no derivative is made any more), the tool to a later end.

--record writes results/instructions.csv. Only a commit of its own moves that file, and says why; a change that costs or
saves instructions says so without it. --against prints ratios to a file (without FILE to that one), their median and the
largest; exit code 1 where one is beyond the bound. Figures of two machines or compilers differ: measure both builds on one
with --out, and compare these. Native code is made for x86-64-v3, not for the machine: valgrind knows no AVX-512.
"""

import argparse
import concurrent.futures
import csv
import dataclasses
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RECORDED = ROOT / "benchmarks" / "results" / "instructions.csv"
sys.path.insert(0, str(ROOT / "benchmarks" / "compare"))
import contenders  # noqa: E402

HEAD = "# Instructions of runs (benchmarks/instructions.py). Only a commit of its own moves this file, and says why."
COLUMNS = ("name", "integrator", "instructions")
COMPILER = """#!/bin/sh
for word; do shift; [ "$word" = -march=native ] && word=-march=x86-64-v3; set -- "$@" "$word"; done
exec cc "$@"
"""
EVENTS_TABLE = ("bouncing-ball", "bouncing-ball-fmi", "bridge-rectifier", "buck-converter", "forced-friction", "irma",
                "relay-feedback", "relay-oscillator", "repressilator", "super-twisting", "suspension-bridge", "twisting",
                "welander")
CHOSEN, CHOICE_RTOL = "taylor", "1e-8"  # of `auto` at this tolerance
REPEATS = 4  # of a tolerance in the events table: compare_saltus integrates five times for each


@dataclasses.dataclass(frozen=True)
class Figure:
    """What is measured: the instructions of `long` less those of `short`."""

    name: str
    integrator: str
    long: tuple
    short: tuple


def catalogue(tool, folder):
    """Elements, contacts, contacts where time stands still, a hundred blocks, sliding: by the tool."""
    blocks = folder / "spring-block.toml"
    text = subprocess.run([tool, "models", "spring-block", "--set", "blocks=100"], capture_output=True, text=True, check=True)
    blocks.write_text(text.stdout, encoding="utf-8")
    element = "simulate.fesd.steps="
    for name, integrator, model, long, short in (
            ("elements", "fesd", "relay-feedback", ("--until", "10", "--set", f"{element}400"),
             ("--until", "0.25", "--set", f"{element}10")),
            ("contacts", "dopri5", "pile-of-balls", (), ("--until", "1e-3")),
            ("time freezing", "fesd", "ball-in-space", ("--until", "1", "--set", f"{element}100"),
             ("--until", "0.01", "--set", f"{element}1")),
            ("large", "dopri5", blocks, (), ("--until", "1e-3")),
            ("sliding", "dopri5", "friction-blocks", (), ("--until", "1e-3"))):
        method = ("--method", "fesd") if integrator == "fesd" else ("--method", "event", "--integrator", integrator)
        start = (tool, "simulate", model, "--quiet", "--set", "simulate.native=on", *method)
        yield Figure(f"catalogue: {name}, {Path(model).stem}", integrator, (*start, *long), (*start, *short))


def choices(tool):
    """The choice of an integrator, and the one that it takes where nothing is stiff, on the models of the events table."""
    for model in EVENTS_TABLE:
        until = tomllib.loads((ROOT / "models" / f"{model}.toml").read_text(encoding="utf-8"))["simulate"]["until"]
        for integrator in ("auto", CHOSEN):
            start = (tool, "simulate", model, "--quiet", "--rtol", CHOICE_RTOL, "--set", "simulate.native=on", "--integrator", integrator)
            yield Figure(f"choice: {model}", integrator, start, (*start, "--until", repr(1e-3 * until)))


def figures(build, folder):
    """All figures, with the model files that they need in a folder."""
    program, tool = build / "benchmarks" / "compare" / "compare_saltus", build / "bin" / "saltus"
    for file in (program, tool):
        if not file.exists():
            sys.exit(f"instructions.py: {file} is missing: cmake --preset release -DSALTUS_BENCHMARKS=ON, then\n"
                     f"  cmake --build {build} --target saltus_tool compare_saltus")
    contenders.MODELS = folder / "compare"
    contenders.write_models()
    tolerances = tuple(map(repr, contenders.TOLERANCES[:-1:2]))
    for problem in contenders.PROBLEMS:
        for method in ("dopri5", "dop853", "taylor"):
            start = (program, contenders.MODELS / f"{problem}.toml", method, "native", "0", tolerances[0])
            yield Figure(f"compare: {problem}", method, (*start, *tolerances), start)
    for model in EVENTS_TABLE:
        for method in ("dopri5", "dop853"):
            start = (program, ROOT / "models" / f"{model}.toml", method, "trajectory", "0")
            yield Figure(f"events: {model}", method, (*start, *["1e-8"] * (1 + REPEATS)), (*start, "1e-8"))
    yield from catalogue(tool, folder)
    yield from choices(tool)


def instructions(command, environment):
    run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *map(str, command)],
                         capture_output=True, text=True, env=environment, check=False)
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found:
        sys.exit(f"instructions.py: {' '.join(map(str, command))} failed under valgrind:\n{run.stderr[-2000:]}")
    return int(found.group(1))


def measured(figure, environment):
    # Its native code is in the cache behind this.
    subprocess.run(list(map(str, figure.short)), capture_output=True, env=environment, check=True)
    return instructions(figure.long, environment) - instructions(figure.short, environment)


def measure(build, only, jobs):
    """Rows of the three columns."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        compiler = folder / "cc"
        compiler.write_text(COMPILER, encoding="utf-8")
        compiler.chmod(0o755)
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "CC": str(compiler),
                       "XDG_CACHE_HOME": str(folder / "cache")}
        wanted = [figure for figure in figures(build, folder) if only in figure.name]

        def row(figure):
            count = measured(figure, environment)
            print(f"{figure.name} {figure.integrator}: {count}", flush=True)
            return figure.name, figure.integrator, count

        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            return list(pool.map(row, wanted))


def compare_choices(rows, bound):
    """Prints what the choice costs; returns the exit code."""
    counts = {(name, integrator): count for name, integrator, count in rows if name.startswith("choice: ")}
    ratios = {name: counts[name, "auto"] / counts[name, CHOSEN] for name, _ in counts}
    for name, ratio in ratios.items():
        print(f"{ratio:7.4f}  {name}: auto / {CHOSEN}")
    return 1 if any(ratio > bound for ratio in ratios.values()) else 0


def write(file, rows):
    with file.open("w", encoding="utf-8", newline="") as stream:
        stream.write(f"{HEAD}\n# {contenders.machine()}\n")
        csv.writer(stream, lineterminator="\n").writerows([COLUMNS, *rows])


def read(file):
    lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return {(row["name"], row["integrator"]): int(row["instructions"]) for row in csv.DictReader(lines)}


def compare(rows, recorded, bound):
    """Prints ratios; returns the exit code."""
    ratios = []
    for name, integrator, count in rows:
        before = recorded.get((name, integrator))
        if before is None:
            print(f"{name} {integrator}: not recorded")
            continue
        ratios.append((count / before, f"{name} {integrator}"))
        print(f"{ratios[-1][0]:7.4f}  {name} {integrator}: {before} became {count}")
    if not ratios:
        print("nothing to compare")
        return 1
    beyond = [name for ratio, name in ratios if ratio > bound]
    print(f"median {statistics.median(ratio for ratio, _ in ratios):.4f}, largest {max(ratios)[0]:.4f} ({max(ratios)[1]}); "
          f"{len(beyond)} of {len(ratios)} beyond {bound}")
    return 1 if beyond else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--record", action="store_true", help="write results/instructions.csv")
    parser.add_argument("--out", type=Path, help="write another file")
    parser.add_argument("--against", type=Path, nargs="?", const=RECORDED, help="compare with a file")
    parser.add_argument("--bound", type=float, default=1.02)
    parser.add_argument("--only", default="", help="figures with this in their name")
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    if shutil.which("valgrind") is None:
        sys.exit("instructions.py: valgrind is missing: apt-get install valgrind")
    recorded = read(arguments.against) if arguments.against else None
    rows = measure(arguments.build.resolve(), arguments.only, arguments.jobs)
    file = RECORDED if arguments.record else arguments.out
    if file:
        write(file, rows)
    failed = compare_choices(rows, arguments.bound)
    return max(failed, compare(rows, recorded, arguments.bound)) if recorded is not None else failed


if __name__ == "__main__":
    sys.exit(main())
