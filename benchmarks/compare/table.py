"""Points of all sweeps -> one Markdown page and one CSV file."""

import csv
import math
import statistics

import accuracy

TARGETS = (1e-6, 1e-8, 1e-10)
MAIN = 1e-8
# A contender must reproduce the reference at its tightest setting; time stepping of order 1 cannot get closer.
REQUIRED = {False: 3e-8, True: 2e-1}
COLUMNS = ("problem", "contender", "method", "variant", "tolerance", "seconds", "repeats", "steps", "evaluations",
           "found", "expected", "end_error", "time_error", "error", "status", "build_seconds", "compile_seconds")


def duration(seconds):
    if not math.isfinite(seconds):
        return "–"
    if seconds >= 1000.0:
        return f"{seconds:.1e} s"
    for unit, factor in (("s", 1.0), ("ms", 1e3), ("µs", 1e6)):
        if seconds * factor >= 1.0:
            break
    digits = max(0, 2 - int(math.floor(math.log10(seconds * factor))))
    return f"{seconds * factor:.{digits}f} {unit}"


def number(value):
    if not math.isfinite(value):
        return "–"
    return f"{value:.1e}" if value >= 1e6 else f"{value:.0f}" if value >= 100 else f"{value:.2g}"


def passes(contender, points):
    """Whether the most accurate point is close enough to the reference, with all events (time stepping: without)."""
    errors = [point["error"] for point in points if math.isfinite(point["error"])]
    return bool(errors) and min(errors) <= REQUIRED[contender.time_stepping]


def best(results, problem, name, target=MAIN):
    """Smallest time at the target error among the rows of a contender; extrapolations do not count."""
    times = []
    for contender, points in results[problem]:
        if contender.name == name:
            value, how = accuracy.at_error(points, target, "seconds")
            if how in ("", "<"):
                times.append(value)
    return min(times, default=math.nan)


def row(problem, contender, points, saltus, hand):
    title = [problem, contender.name, contender.method, contender.variant]
    if contender.missing:
        return [*title, contender.missing, *["–"] * 7]
    cells = []
    for target in TARGETS:
        value, how = accuracy.at_error(points, target, "seconds")
        cells.append("–" if how == "-" else f"{how} {duration(value)}".strip())
    time, how = accuracy.at_error(points, MAIN, "seconds")
    work, _ = accuracy.at_error(points, MAIN, "evaluations")
    mark = f"{how} " if how in ("~", "≈") else ""
    complete = sum(p["found"] == p["expected"] for p in points)
    check = "yes" if passes(contender, points) else "**NO**"
    return [*title, *cells, f"{mark}{number(time / hand)}", f"{mark}{number(time / saltus)}", f"{mark}{number(work)}",
            f"{complete} of {len(points)}", check]


def main_table(results):
    head = ["problem", "contender", "method", "variant", *[f"time at {target:.0e}" for target in TARGETS],
            f"/ by hand at {MAIN:.0e}", f"/ Saltus at {MAIN:.0e}", f"evaluations at {MAIN:.0e}", "all events found",
            "meets reference"]
    lines = [head, ["---"] * len(head)]
    for problem, entries in results.items():
        if problem == "gene-ring-active":
            continue
        saltus = best(results, problem, "Saltus")
        hand = best(results, problem, "by hand")
        lines += [row(problem, contender, points, saltus, hand) for contender, points in entries]
    return lines


def startup_table(results):
    """Native code is compiled in the first sweep of a problem (the cache was emptied) and loaded in all others."""
    lines = [["problem", "read and build", "interpreter", "native code, compiled", "native code, cached",
              "integration at 1e-8, dop853, native"], ["---"] * 6]
    for problem, entries in results.items():
        points = {(c.method, c.variant): p for c, p in entries if c.name == "Saltus" and p}
        if not {("dopri5", "native"), ("dop853", "native"), ("dop853", "interpreted")} <= points.keys():
            continue
        native = points["dop853", "native"]
        near = min(native, key=lambda p: abs(math.log(p["tolerance"] / MAIN)))
        lines.append([problem, *[duration(seconds) for seconds in (
            native[0]["build_seconds"], points["dop853", "interpreted"][0]["compile_seconds"],
            points["dopri5", "native"][0]["first_compile_seconds"], native[0]["compile_seconds"], near["seconds"])]])
    return lines


def threshold_table(results):
    """(time with 500 thresholds - time with 20) / 480 as a line over the steps: its slope, its value at 0 per event."""
    lines = [["contender", "method", "variant", "20 thresholds", "500 thresholds", "per step and inactive threshold",
              "per event and inactive threshold"], ["---"] * 7]
    few = {(c.name, c.method, c.variant): points for c, points in results.get("gene-ring-active", [])}
    for contender, points in results.get("gene-ring", []):
        start = {p["tolerance"]: p for p in few.get((contender.name, contender.method, contender.variant), [])}
        pairs = [(start[p["tolerance"]], p) for p in points if p["tolerance"] in start]
        shown = [pair for pair in pairs if math.isclose(pair[0]["tolerance"], 1e-8)]
        if not shown or len(pairs) < 3:
            continue
        extra = [(p["seconds"] - q["seconds"]) / 480 for q, p in pairs]
        steps = [p["steps"] for _, p in pairs]
        if max(steps) > min(steps):
            line = statistics.linear_regression(steps, extra)
            per_step, rest = f"{1e9 * line.slope:.2f} ns", line.intercept
        else:  # every step ends at an event, whatever the tolerance: nothing tells steps and events apart
            per_step, rest = "–", statistics.median(extra)
        lines.append([contender.name, contender.method, contender.variant, duration(shown[0][0]["seconds"]),
                      duration(shown[0][1]["seconds"]), per_step, f"{1e9 * rest / shown[0][1]['expected']:.1f} ns"])
    return lines


def event_table(counts):
    """Relay feedback at 41 tolerances: how many of them find all 34 events."""
    lines = [["contender", "method", "tolerances with all events", "fewest", "most"], ["---"] * 5]
    for contender, points in counts:
        if contender.missing:
            lines.append([contender.name, contender.method, contender.missing, "–", "–"])
            continue
        found = [p["found"] for p in points]
        right = sum(p["found"] == p["expected"] and p["error"] < 1.0 for p in points)
        lines.append([contender.name, contender.method, f"{right} of {len(points)}", str(min(found)), str(max(found))])
    return lines


def markdown(lines):
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def write_csv(file, results):
    with file.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, COLUMNS, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        for problem, entries in results.items():
            for contender, points in entries:
                for point in points:
                    writer.writerow({**point, "problem": problem, "contender": contender.name})
