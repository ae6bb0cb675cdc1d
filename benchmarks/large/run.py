#!/usr/bin/env python3
"""Measures large models and writes results/large.md: run.py TOOL [--sizes 10 100 1000] [--limit SECONDS]

For every model and size: `saltus check` (reading and building), `saltus simulate` from file to table, its peak memory,
and what the run counted. A run beyond the limit is given up, and so are larger sizes of its model.
"""
import argparse
import os
import pathlib
import re
import subprocess
import tempfile
import time

import large_models

HERE = pathlib.Path(__file__).resolve().parent


def measured(command, limit, output):
    """Seconds and peak memory in MB, or None beyond the limit. A child starts with the memory of this program, so that
    nothing large may be read here."""
    start = time.monotonic()
    with open(output, "w", encoding="utf-8") as written:
        process = subprocess.Popen(command, stdout=written, stderr=subprocess.DEVNULL)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid != 0:
                process.returncode = os.waitstatus_to_exitcode(status)
                return time.monotonic() - start, usage.ru_maxrss / 1024, process.returncode
            if time.monotonic() - start > limit:
                process.kill()
                process.wait()
                return None
            time.sleep(0.002)


def row(tool, kind, n, limit, folder):
    model = folder / f"{kind}-{n}.toml"
    model.write_text(large_models.text(kind, n), encoding="utf-8")
    table = folder / "table.txt"
    check = measured([tool, "check", model], limit, table)
    # Once for the cache of native code: what counts is the second run.
    words = [tool, "simulate", model]
    first = measured(words, limit, table)
    again = measured(words, limit, table) if first else None
    if not check or not again:
        return f"| {kind} | {n} | {'%.2f' % check[0] if check else f'> {limit:g}'} | > {limit:g} | | | | |", False
    counts = re.search(r"(\d+) steps, \d+ rejected, (\d+) evaluations", table.read_text(encoding="utf-8"))
    steps, evaluations = map(int, counts.groups()) if counts else (0, 0)
    per_step = 1e6 * again[0] / (steps * n) if steps else 0.0
    return (f"| {kind} | {n} | {check[0]:.2f} | {first[0]:.2f} | {again[0]:.2f} | {again[1]:.0f} | {steps} / "
            f"{evaluations} | {per_step:.2f} |"), True


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 100, 1000, 10000])
    parser.add_argument("--models", nargs="+", default=sorted(large_models.MODELS))
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--note", default="", help="of the machine, and what was left out")
    parser.add_argument("-o", "--output", default=str(HERE.parent / "results" / "large.md"))
    arguments = parser.parse_args()
    lines = ["# Large models", "",
             "Written by `benchmarks/large/run.py`. Wall times in seconds with default options; `first` without, "
             "`again` with native code in the cache. `check` leaves out complementarity systems beyond 100 "
             "switching functions.", "", *([arguments.note, ""] if arguments.note else []),
             "| model | N | check | first | again | MB | steps / evaluations | µs per step and N |",
             "|---|---|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as folder:
        os.environ["SALTUS_CACHE"] = os.path.join(folder, "cache")
        for kind in arguments.models:
            for n in arguments.sizes:
                line, ended = row(os.path.abspath(arguments.tool), kind, n, arguments.limit, pathlib.Path(folder))
                print(line, flush=True)
                lines.append(line)
                pathlib.Path(arguments.output).write_text("\n".join(lines) + "\n", encoding="utf-8")
                if not ended:
                    break


if __name__ == "__main__":
    main()
