#!/usr/bin/env python3
"""Bodies that touch: Saltus against C++ by hand with the same modes, at equal achieved error, in one run.

    python3 benchmarks/compare/bodies.py FOLDER [--rounds 3] [--seconds 0.3]

FOLDER has compare_saltus and compare_hand (a build with -DSALTUS_BENCHMARKS=ON: benchmarks/compare in it). Errors are those of the
end state against DOP853 by hand at 1e-13, whose events must be the same in number.
"""

import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile

import accuracy

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOLERANCES = [10.0 ** -k for k in range(6, 12)]
STATES = {"pile-of-balls": 16, "hops": 4}
WANTED = 1e-9


def model(problem, folder):
    """The model of Saltus with the end of the problem by hand."""
    if problem == "hops":
        return ROOT / "benchmarks" / "compare" / "hops.toml"
    file = pathlib.Path(folder) / "pile-of-balls.toml"
    text = (ROOT / "models" / "pile-of-balls.toml").read_text(encoding="utf-8")
    file.write_text(text.replace("until = 1.0", "until = 0.085"), encoding="utf-8")
    return file


def runs(program, problem, method, variant, seconds, tolerances):
    out = subprocess.run([program, problem, method, variant, str(seconds), *map(str, tolerances)],
                         capture_output=True, text=True, check=True).stdout
    return [json.loads(line) for line in out.splitlines()]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=0.3)
    arguments = parser.parse_args()
    print(f"| problem | method | by hand, error {WANTED:g} | Saltus | ratio | steps by hand, Saltus at 1e-8 |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for problem, states in STATES.items():
            exact = runs(arguments.folder / "compare_hand", problem, "dop853", "-", 0.01, [1e-13])[0]
            for method in ("dopri5", "dop853"):
                times, steps = {}, {}
                for who, name, variant in (("compare_hand", problem, "-"),
                                           ("compare_saltus", model(problem, folder), "native")):
                    rounds = [runs(arguments.folder / who, str(name), method, variant, arguments.seconds, TOLERANCES)
                              for _ in range(arguments.rounds)]
                    points = []
                    for run in zip(*rounds):
                        assert len(run[0]["events"]) == len(exact["events"]), (problem, who, run[0]["tolerance"])
                        error = max(abs(a - b) for a, b in zip(run[0]["x"][:states], exact["x"]))
                        points.append({"error": error, "seconds": statistics.median(one["seconds"] for one in run),
                                       "time_stepping": False})
                    times[who], _ = accuracy.at_error(points, WANTED, "seconds")
                    steps[who] = rounds[0][2]["steps"]
                hand, saltus = times["compare_hand"], times["compare_saltus"]
                print(f"| {problem} | {method} | {1e3 * hand:.3g} ms | {1e3 * saltus:.3g} ms | {saltus / hand:.2g} | "
                      f"{steps['compare_hand']}, {steps['compare_saltus']} |", flush=True)


if __name__ == "__main__":
    main()
