#!/usr/bin/env python3
"""Saltus against other ways to the same solution: time at equal achieved error, in one run.

    python3 benchmarks/compare/run.py             installs the competitors, builds, measures, writes benchmarks/results/
    python3 benchmarks/compare/run.py --help

Needs nothing but Python; the competitors that cannot be installed become rows "not installed".
"""

import argparse
import os
import pathlib
import shutil
import statistics
import subprocess
import sys

import accuracy
import contenders
import table

EVENT_TOLERANCES = tuple(10.0 ** (-3 - 9 * k / 40) for k in range(41))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=3, help="repetitions of the whole comparison (default 3)")
    parser.add_argument("--seconds", type=float, default=0.05, help="per contender, tolerance and round (default 0.05)")
    parser.add_argument("--timeout", type=float, default=300.0, help="per contender, problem and round (default 300)")
    parser.add_argument("--problems", nargs="+", default=list(contenders.PROBLEMS), choices=contenders.PROBLEMS)
    parser.add_argument("--contenders", nargs="+", help="names to keep, e.g. Saltus 'by hand'")
    parser.add_argument("--build", type=pathlib.Path, default=contenders.BUILD / "cmake", help="build folder")
    parser.add_argument("--output", type=pathlib.Path, default=contenders.ROOT / "benchmarks" / "results")
    parser.add_argument("--no-install", action="store_true", help="take what is installed")
    return parser.parse_args()


def merged(rounds):
    """The points of one sweep: medians of the rounds' times, everything else from the first round."""
    points = [dict(point) for point in rounds[0]]
    for k, point in enumerate(points):
        for key in ("seconds", "build_seconds", "compile_seconds"):
            values = [one[k][key] for one in rounds if k < len(one) and key in one[k]]
            if values:
                point[key] = statistics.median(values)
                point[f"first_{key}"] = values[0]
    return points


def compare(options, lineup):
    """{problem: [(contender, points)]}. The contenders take turns within each round: the machine changes for all."""
    problems = list(options.problems) + (["gene-ring-active"] if "gene-ring" in options.problems else [])
    results = {}
    for problem in problems:
        like = "gene-ring" if problem == "gene-ring-active" else problem
        entries = [c for c in lineup if like in c.problems and not (problem != like and c.time_stepping)]
        sweeps = {c: [] for c in entries}
        for turn in range(options.rounds):
            for contender in entries:
                if contender.missing or (contender.name in ("SciPy", "Siconos") and turn > 0):
                    continue  # their times are four orders of magnitude away: one round tells enough
                print(f"{problem}: {contender.name} {contender.method} {contender.variant}, round {turn + 1}",
                      file=sys.stderr, flush=True)
                sweeps[contender].append(contender.run(problem, options.seconds, contender.sweep(problem),
                                                       options.timeout))
        results[problem] = []
        for contender in entries:
            points = merged(sweeps[contender]) if sweeps[contender] else []
            results[problem].append((contender, [accuracy.judge(problem, p, contender.time_stepping) for p in points]))
    return results


def count_events(options, lineup):
    counts = []
    for contender in lineup:
        if "relay-feedback" not in contender.problems or contender.time_stepping or contender.variant in (
                "trajectory", "interpreted"):
            continue
        points = [] if contender.missing else contender.run("relay-feedback", 0.0, EVENT_TOLERANCES, options.timeout)
        counts.append((contender, [accuracy.judge("relay-feedback", p, False) for p in points]))
    return counts


def page(options, results, counts, loads):
    parts = ["# Comparison: time at equal achieved error\n",
             f"Made by `benchmarks/compare/run.py --rounds {options.rounds} --seconds {options.seconds} "
             f"--timeout {options.timeout:g}` on {contenders.machine()}. "
             f"Processes that wanted to run meanwhile (load average before and behind): {loads[0]:.1f}, {loads[1]:.1f}. "
             "How to read it: "
             "[benchmarks/README.md](../README.md).\n",
             table.markdown(table.main_table(results)),
             "`<`: the loosest setting is already more accurate; `~`: extrapolated by at most two decades; `≈`: from the "
             "finest step by the order seen last, at least 1; –: not reached. What the timeout "
             "cut short has fewer points (of 9, or 4 for time stepping).\n",
             "## Events of relay feedback at 41 tolerances between 1e-3 and 1e-12 (34 each)\n",
             table.markdown(table.event_table(counts)) if counts else "Not measured.\n",
             "## What an inactive threshold costs\n", table.markdown(table.threshold_table(results)),
             "## Parts of Saltus' time before the integration\n", table.markdown(table.startup_table(results))]
    return "\n".join(parts)


def main():
    options = arguments()
    if not options.no_install:
        subprocess.run([contenders.ROOT / "scripts" / "install.sh"], check=True)
        subprocess.run([contenders.ROOT / "scripts" / "install_benchmarks.sh"], check=False)
    programs = contenders.build(options.build)
    contenders.write_models()
    shutil.rmtree(contenders.CACHE, ignore_errors=True)
    lineup = contenders.line_up(programs)
    if options.contenders:
        lineup = [c for c in lineup if c.name in options.contenders]
    load_before = os.getloadavg()[2]
    results = compare(options, lineup)
    counts = count_events(options, lineup) if "relay-feedback" in options.problems else []
    options.output.mkdir(parents=True, exist_ok=True)
    text = page(options, results, counts, (load_before, os.getloadavg()[2]))
    (options.output / "compare.md").write_text(text)
    table.write_csv(options.output / "compare.csv", results)
    print(text)
    failed = [f"{problem}: {c.name} {c.method} {c.variant}" for problem, entries in results.items()
              for c, points in entries if not c.missing and not table.passes(c, points)]
    if failed:
        sys.exit("These do not reproduce the reference: " + "; ".join(failed))


if __name__ == "__main__":
    main()
