#!/usr/bin/env python3
"""Cost of an element of the method fesd by the size of a chain of blocks: fesd.py TOOL [TOOL...] [--sizes 5 10 …]

Prints a table for results/large.md: per tool processor time per element, without what building the model takes (a run
of one step); the smallest of some runs, of the tools in turn. Slope: of that time in
log-log from one size to the next.
"""
import argparse
import json
import math
import pathlib
import resource
import subprocess
import tempfile

import large_models


def run(tool, model, until, steps, limit):
    """Processor time in seconds, elements and events, or None beyond the limit."""
    result = model.with_suffix(".json")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        subprocess.run([tool, "simulate", model, "--quiet", "--method", "fesd", "--set", "simulate.native=off", "--set",
                        f"simulate.fesd.steps={steps}", "--until", str(until), "--out", result], timeout=limit, check=True, stdout=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    written = json.loads(result.read_text(encoding="utf-8"))
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return seconds, written["statistics"]["steps"], len(written["events"])


def cost(tool, model, arguments):
    """Milliseconds per element, elements and events."""
    short, whole = [], []
    for _ in range(arguments.repeats):
        for runs, until, steps in ((short, arguments.until / arguments.steps, 1), (whole, arguments.until, arguments.steps)):
            runs.append(run(tool, model, until, steps, arguments.limit))
            if not runs[-1]:
                return None
    seconds = min(whole)[0] - min(short)[0]
    return 1e3 * seconds / (whole[0][1] - short[0][1]), whole[0][1], whole[0][2]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tools", nargs="+")
    parser.add_argument("--sizes", nargs="+", type=int, default=[5, 10, 20, 40, 80, 160, 320])
    parser.add_argument("--until", type=float, default=2.0)
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--limit", type=float, default=120.0)
    parser.add_argument("--repeats", type=int, default=3)
    arguments = parser.parse_args()
    print("| N | " + " | ".join(f"tool {k + 1}: elements / events | ms per element | µs per element and N | slope"
                                for k in range(len(arguments.tools))) + " |")
    print("|---" * (1 + 4 * len(arguments.tools)) + "|")
    before = [None] * len(arguments.tools)
    with tempfile.TemporaryDirectory() as folder:
        for n in arguments.sizes:
            model = pathlib.Path(folder) / f"chain-{n}.toml"
            model.write_text(large_models.text(arguments.tools[0], "chain", n), encoding="utf-8")
            cells = []
            for k, tool in enumerate(arguments.tools):
                found = cost(tool, model, arguments)
                if not found:
                    cells.append(f"| > {arguments.limit:g} s | | ")
                    before[k] = None
                    continue
                each, elements, events = found
                slope = f"{math.log(each / before[k][1]) / math.log(n / before[k][0]):.2f}" if before[k] else ""
                before[k] = (n, each)
                cells.append(f"{elements} / {events} | {each:.3g} | {1e3 * each / n:.3g} | {slope}")
            print(f"| {n} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
