"""The Python side of protocol.hpp: arguments, timing, one JSON object a line."""

import json
import statistics
import sys
import time


def request():
    if len(sys.argv) < 6:
        sys.exit(f"usage: {sys.argv[0]} PROBLEM METHOD VARIANT SECONDS TOLERANCE…")
    problem, method, variant, seconds = sys.argv[1:5]
    return {"problem": problem, "method": method, "variant": variant}, float(seconds), [float(t) for t in sys.argv[5:]]


def median_time(seconds, body):
    """Median CPU time of calls of `body` until the seconds are used up, and how often it ran; at least once."""
    times = []
    start = time.process_time()
    while not times or (time.process_time() - start < seconds and len(times) < 201):
        begin = time.process_time()
        body()
        times.append(time.process_time() - begin)
    return statistics.median(times), len(times)


def report(case, tolerance, timing, run):
    seconds, repeats = timing
    print(json.dumps({**case, "tolerance": tolerance, "seconds": seconds, "repeats": repeats, **run}), flush=True)
