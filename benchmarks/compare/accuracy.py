"""Errors against the references, and the time a contender needs for a given error."""

import math

import references

# What an error is measured in: sizes of the components along the trajectory, and the time scale of the problem for the
# times of the events.
SIZES = {"irma": (0.02, 3.7, 0.37, 0.4, 0.026), "stick-slip": (1.0, 1.0), "relay-feedback": (1.0, 1.0, 1.0),
         "gene-ring": (1.0,) * 10, "gene-ring-active": (1.0,) * 10}
TIME_SCALE = {"irma": 20.0, "stick-slip": 1.0, "relay-feedback": 1.0, "gene-ring": 1.0, "gene-ring-active": 1.0}
_REFERENCES = {}


def reference(problem):
    if problem not in _REFERENCES:
        _REFERENCES[problem] = references.reference(problem)
    return _REFERENCES[problem]


def judge(problem, point, time_stepping):
    """Adds end_error, time_error, error and expected (number of events) to a point of a sweep."""
    exact = reference(problem)
    point["time_stepping"] = time_stepping
    point["expected"] = len(exact["events"])
    point["found"] = len(point["events"])
    point["end_error"] = max(abs(own - true) / size for own, true, size in zip(point["x"], exact["x"], SIZES[problem]))
    complete = point["found"] == point["expected"] and point["status"] == "completed"
    differences = [abs(own - true) for own, true in zip(point["events"], exact["events"])]
    point["time_error"] = max(differences, default=0.0) / TIME_SCALE[problem] if complete else math.nan
    # Time stepping has no event times, only the step in which something changed.
    if time_stepping:
        point["error"] = point["end_error"]
    else:
        point["error"] = max(point["end_error"], point["time_error"]) if complete else math.nan
    return point


def at_error(points, target, key):
    """(value of `key` at an error of `target`, how), by interpolation in log-log between neighbours of a sweep.

    how: "" interpolated; "<" even the loosest setting is more accurate; "~" extrapolated by at most two decades; "≈" from
    the finest step of a time stepping by the order seen last, at least 1; "-" not reached.
    """
    usable = [p for p in points if math.isfinite(p["error"]) and p["error"] > 0.0]
    if not usable:
        return math.nan, "-"
    between = [along(loose, tight, target, key) for loose, tight in zip(usable, usable[1:])
               if loose["error"] > target >= tight["error"]]
    if between:
        return min(between), ""
    if all(p["error"] <= target for p in usable):
        return min(p[key] for p in usable), "<"
    best = min(usable, key=lambda p: p["error"])
    if usable[-1]["time_stepping"] and len(usable) >= 2:
        coarse, finest = usable[-2:]
        order = max(1.0, math.log(coarse["error"] / finest["error"]) / math.log(finest[key] / coarse[key]))
        return finest[key] * (finest["error"] / target) ** (1.0 / order), "≈"
    if target >= 0.01 * best["error"] < 0.01 * usable[0]["error"]:
        return along(usable[0], best, target, key), "~"
    return math.nan, "-"


def along(loose, tight, target, key):
    share = math.log(loose["error"] / target) / math.log(loose["error"] / tight["error"])
    return math.exp(math.log(loose[key]) + share * math.log(tight[key] / loose[key]))
