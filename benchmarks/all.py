#!/usr/bin/env python3
"""Repeats every public figure: `make benchmarks`, or `make benchmarks ONLY="creep fesd"`.

    python3 benchmarks/all.py --list            names, what each compares, how long it takes
    python3 benchmarks/all.py creep fesd        these only

Each writes its page in benchmarks/results, with machine, day and load. What is not installed is a row there (scripts/install_benchmarks.sh).
"""

import argparse
import dataclasses
import os
import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent


@dataclasses.dataclass(frozen=True)
class Benchmark:
    name: str
    script: str
    minutes: float  # on an idle machine
    says: str
    arguments: tuple = ()


def benchmarks(mpcc):
    build = ROOT / "build" / "release"
    return [
        Benchmark("compare", "compare/run.py", 15, "simulation: by hand in C++, CVODE, SciPy, Siconos"),
        Benchmark("fesd", "compare/fesd.py", 15, "finite elements: nosnoc"),
        Benchmark("optimal_control", "compare/optimal_control.py", 5, "optimal control: nosnoc, a plain homotopy"),
        Benchmark("mpcc", "mpcc/run.py", 10, "B1, foreign MPCCs: a plain homotopy, mpecss", (mpcc,)),
        Benchmark("crisp", "peers/crisp.py", 2, "B2, contact-implicit problems: a plain homotopy, mpecss"),
        Benchmark("soft-walls", "peers/soft_walls.py", 3, "B3, control between soft walls: ADMM over OSQP, branch and bound over HiGHS"),
        Benchmark("mpc", "peers/mpc.py", 2, "B4, closed loops: a warm-started homotopy"),
        Benchmark("creep", "peers/creep.py", 1, "B5, bodies at rest: MuJoCo, Drake"),
        Benchmark("contact-precision", "peers/contact_precision.py", 1, "B6, error over time with contacts: MuJoCo, SciPy"),
        Benchmark("gradients", "peers/gradients.py", 1, "B7, derivatives through switches: diffrax, jaxonomy"),
        Benchmark("large", "large/run.py", 5, "models of any size", (build / "bin" / "saltus",)),
        Benchmark("random_optima", "random_optima/run.py", 60, "random problems: a plain homotopy, eight starts", ("--switches", "60", "--contacts", "15")),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--mpcc", type=pathlib.Path, default=ROOT / "examples" / "mpcc", help="folder of .nl and JSON files for `mpcc`")
    arguments = parser.parse_args()
    known = benchmarks(arguments.mpcc)
    unknown = set(arguments.names) - {one.name for one in known}
    if unknown:
        parser.error(f"no benchmark is called {', '.join(sorted(unknown))}; there are {', '.join(one.name for one in known)}")
    if arguments.list:
        for one in known:
            print(f"{one.name:18} {one.minutes:4g} min  {one.says}")
        return 0
    failed = []
    for one in known:
        if arguments.names and one.name not in arguments.names:
            continue
        print(f"\n== {one.name}: {one.says}", flush=True)
        begin = time.monotonic()
        done = subprocess.run([sys.executable, HERE / one.script, *map(str, one.arguments)], cwd=ROOT, check=False,
                              env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"})
        print(f"== {one.name}: {time.monotonic() - begin:.0f} s", flush=True)
        if done.returncode:
            failed.append(one.name)
    print(f"\nfailed: {', '.join(failed)}" if failed else "\nall done: the pages are in benchmarks/results")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
