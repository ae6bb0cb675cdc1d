#!/usr/bin/env python3
"""Measures large models and writes results/large.md with its plot: run.py TOOL [--sizes 10 100 1000] [--limit SECONDS]

For every model and size: `saltus check` (reading and building), `saltus simulate` from file to table, its peak memory,
and what the run counted. A run beyond the limit is given up, and so are larger sizes of its model.
"""
import argparse
import datetime
import math
import os
import pathlib
import platform
import re
import subprocess
import tempfile
import time

import large_models

HERE = pathlib.Path(__file__).resolve().parent


def machine():
    """Processor and day of this run."""
    try:
        model = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    except OSError:
        model = None
    return f"{model.group(1).strip() if model else platform.processor()}, {os.cpu_count()} processors, {datetime.date.today()}"


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
    model.write_text(large_models.text(tool, kind, n), encoding="utf-8")
    table = folder / "table.txt"
    check = measured([tool, "check", model], limit, table)
    # Once for the cache of native code: what counts is the second run.
    words = [tool, "simulate", model]
    first = measured(words, limit, table)
    again = measured(words, limit, table) if first else None
    figures = {"build": check[0] if check else None, "simulate": again[0] if again else None,
               "memory": again[1] if again else None}
    if not check or not again:
        cell = "%.2f" % check[0] if check else f"> {limit:g}"
        return f"| {kind} | {n} | {cell} | > {limit:g} | | | | |", figures
    counts = re.search(r"(\d+) steps, \d+ rejected, (\d+) evaluations", table.read_text(encoding="utf-8"))
    steps, evaluations = map(int, counts.groups()) if counts else (0, 0)
    per_step = 1e6 * again[0] / (steps * n) if steps else 0.0
    return (f"| {kind} | {n} | {check[0]:.2f} | {first[0]:.2f} | {again[0]:.2f} | {again[1]:.0f} | {steps} / "
            f"{evaluations} | {per_step:.2f} |"), figures


UNITS = {"build": "s", "simulate": "s", "memory": "MB"}


def slopes(figures):
    """A table: of each quantity the slope in log-log from one size to the next."""
    lines = ["| model | quantity | " + " | ".join(["slope"] * 3) + " |", "|---|---|---|---|---|"]
    for kind, by_size in figures.items():
        for quantity in UNITS:
            sizes = sorted(n for n, row_ in by_size.items() if row_[quantity])
            cells = []
            for a, b in zip(sizes, sizes[1:]):
                slope = math.log(by_size[b][quantity] / by_size[a][quantity]) / math.log(b / a)
                cells.append(f"{slope:.2f} ({a} to {b})")
            lines.append(f"| {kind} | {quantity} | " + " | ".join(cells + [""] * (3 - len(cells))) + " |")
    return lines


def plot(figures, path):
    """Seconds and MB over N, both axes logarithmic, a panel for each quantity; dashed: slope 1."""
    width, height, left, top = 300, 240, 50, 30
    colours = ["#1f77b4", "#ff7f0e", "#2ca02c", "#d62728"]
    sizes = sorted({n for by_size in figures.values() for n in by_size})
    low, high = math.log10(sizes[0]), max(math.log10(sizes[-1]), math.log10(sizes[0]) + 1)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{3 * (width + left) + 20}" height="{height + 80}" '
             'font-family="sans-serif" font-size="11">', '<rect width="100%" height="100%" fill="white"/>']
    for panel, (quantity, unit) in enumerate(UNITS.items()):
        values = [row_[quantity] for by_size in figures.values() for row_ in by_size.values() if row_[quantity]]
        if not values:
            continue
        bottom, up = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)) + 1e-9)
        x0, y0 = left + panel * (width + left), top + height

        def x_of(n, x0=x0):
            return x0 + (width - 20) * (math.log10(n) - low) / (high - low)

        def y_of(value, bottom=bottom, up=up, y0=y0):
            return y0 - height * (math.log10(value) - bottom) / (up - bottom)

        parts.append(f'<text x="{x0}" y="{top - 10}">{quantity} [{unit}] over N</text>')
        for n in sizes:
            parts.append(f'<path d="M{x_of(n):.1f} {top}V{y0}" stroke="#ddd"/>'
                         f'<text x="{x_of(n):.1f}" y="{y0 + 15}" text-anchor="middle">{n}</text>')
        for power in range(bottom, up + 1):
            parts.append(f'<path d="M{x0} {y_of(10.0 ** power):.1f}h{width - 20}" stroke="#ddd"/>'
                         f'<text x="{x0 - 4}" y="{y_of(10.0 ** power) + 4:.1f}" text-anchor="end">1e{power}</text>')
        decades = min(high - low, up - bottom)
        parts.append(f'<path d="M{x_of(10 ** low):.1f} {y_of(10.0 ** bottom):.1f}L{x_of(10 ** (low + decades)):.1f} '
                     f'{y_of(10.0 ** (bottom + decades)):.1f}" stroke="#888" stroke-dasharray="4"/>')
        for colour, by_size in zip(colours, figures.values()):
            points = [(x_of(n), y_of(row_[quantity])) for n, row_ in sorted(by_size.items()) if row_[quantity]]
            parts.append('<polyline fill="none" stroke="%s" points="%s"/>' % (
                colour, " ".join(f"{x:.1f},{y:.1f}" for x, y in points)))
            parts += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}"/>' for x, y in points]
    for place, (colour, kind) in enumerate(zip(colours, figures)):
        parts.append(f'<text x="{left + 90 * place}" y="{height + 70}" fill="{colour}">{kind}</text>')
    path.write_text("\n".join(parts + ["</svg>"]) + "\n", encoding="utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--sizes", type=int, nargs="+", default=[10, 100, 1000, 10000])
    parser.add_argument("--models", nargs="+", default=sorted(large_models.NAMES))
    parser.add_argument("--limit", type=float, default=60.0)
    parser.add_argument("--note", default="", help="of the machine, and what was left out")
    parser.add_argument("-o", "--output", default=str(HERE.parent / "results" / "large.md"))
    arguments = parser.parse_args()
    lines = ["# Large models", "",
             f"Written by `benchmarks/large/run.py` on {machine()}. Wall times in seconds with default options; `first` without, "
             "`again` with native code in the cache. `check` leaves out complementarity systems beyond 100 "
             "switching functions.", "", *([arguments.note, ""] if arguments.note else []),
             "| model | N | check | first | again | MB | steps / evaluations | µs per step and N |",
             "|---|---|---|---|---|---|---|---|"]
    output = pathlib.Path(arguments.output)
    figures = {}
    with tempfile.TemporaryDirectory() as folder:
        os.environ["SALTUS_CACHE"] = os.path.join(folder, "cache")
        for kind in arguments.models:
            for n in arguments.sizes:
                line, found = row(os.path.abspath(arguments.tool), kind, n, arguments.limit, pathlib.Path(folder))
                print(line, flush=True)
                lines.append(line)
                figures.setdefault(kind, {})[n] = found
                plot(figures, output.with_suffix(".svg"))
                text = [*lines, "", "Slopes in log-log:", "", *slopes(figures), "",
                        f"![The same over N]({output.with_suffix('.svg').name})"]
                output.write_text("\n".join(text) + "\n", encoding="utf-8")
                if not found["simulate"]:
                    break


if __name__ == "__main__":
    main()
