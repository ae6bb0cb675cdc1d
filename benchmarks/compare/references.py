"""Reference solutions of the four problems, independent of every competitor.

IRMA and relay feedback: tests/problems/references.json (Taylor series with 50 digits). Stick-slip: the same file,
continued from t = 40 by its exact period (every slip starts at q = 1, v = 0.2). Gene ring: closed form between
switches, in decimal arithmetic with 50 digits.
"""

import decimal
import json
import pathlib
from decimal import Decimal

import gene_ring

ROOT = pathlib.Path(__file__).resolve().parents[2]
FILE = ROOT / "tests" / "problems" / "references.json"


def stored(model, until):
    with FILE.open() as file:
        problems = json.load(file, parse_float=Decimal)["problems"]
    found = [p for p in problems if p["model"] == model and p["until"] == until and "case" not in p]
    if len(found) != 1:
        raise LookupError(f"{FILE} has no reference of {model} to {until}")
    return found[0]


def switches(problem):
    return [event["t"] for event in problem["events"] if event["kind"] != "start"]


def of_file(model, until):
    problem = stored(model, until)
    return {"x": problem["final"]["x"], "events": switches(problem)}


def stick_slip(until):
    """Sticks, slips, sticks, slips, …: from the first slip on everything repeats."""
    problem = stored("stick-slip", Decimal(40))
    first = switches(problem)
    slip, stick, next_slip = first[1:4]
    period = next_slip - slip
    events = [first[0]]
    for turn in range(int(until / period) + 2):
        events += [slip + turn * period, stick + turn * period]
    events = [t for t in events if t < until]
    sticking = len(events) % 2 == 1
    if not sticking:
        raise ValueError("the end of stick-slip must lie in a sticking phase: only there it is known in closed form")
    exit_time = slip + period * (len(events) // 2)
    return {"x": [1 - (exit_time - until) / 5, Decimal("0.2")], "events": events}


def gene_network(until):
    """x_i = focus_i + (x_i - focus_i) exp(-decay_i t): the next switch is the earliest of n logarithms."""
    with decimal.localcontext() as context:
        context.prec = 50
        network = gene_ring.Network(inactive_each_side=gene_ring.INACTIVE)
        x = [Decimal(number) / 1000 for number in network.start]
        t = Decimal(0)
        events = []
        levels = network.levels_of(x)
        while True:
            focus = [production / decay for production, decay in zip(network.production(levels), network.decay)]
            crossings = []
            for i, (own, target) in enumerate(zip(x, focus)):
                threshold = network.next_threshold(i, levels[i], target > own)
                if threshold is not None and (threshold < target if target > own else threshold > target):
                    crossings.append((-((threshold - target) / (own - target)).ln() / network.decay[i], i, threshold))
            step, who, threshold = min(crossings)
            if t + step >= until:
                step, who = until - t, None
            x = [target + (own - target) * (-decay * step).exp() for own, target, decay in zip(x, focus, network.decay)]
            t += step
            if who is None:
                return {"x": x, "events": events}
            levels[who] += 1 if focus[who] > x[who] else -1
            x[who] = threshold
            events.append(t)


def reference(problem):
    """End state and times of all switches, as floats."""
    exact = {
        "irma": lambda: of_file("irma", Decimal(1000)),
        "stick-slip": lambda: stick_slip(Decimal(1000)),
        "relay-feedback": lambda: of_file("relay-feedback", Decimal(10)),
        "gene-ring": lambda: gene_network(Decimal(100)),
        "gene-ring-active": lambda: gene_network(Decimal(100)),
    }[problem]()
    return {"x": [float(value) for value in exact["x"]], "events": [float(t) for t in exact["events"]]}
