"""Hops of the monoped one behind the other: a start for a longer way whose sides are right.

python3 benchmarks/monoped/hops.py RESULT.json RESULT.json … --out START.json [--points S] [--intervals N]
    [--stewart]

Every result is one of `saltus optimize` that begins and ends at rest, leg straight, with equally long intervals and the
same number of elements. A hop may be there several times: the robot moves the same wherever it stands.
--points: the elements get that many stages, on the polynomials of theirs. Sides stay what they are, while a result that
is sampled (as --start does where numbers of stages differ) loses elements in which time stands still.
--intervals: the same motion, its elements cut where the N intervals end; none is left with length zero.
--stewart: selections and multipliers as in Stewart's form; behind the other changes, which know the step form only.
"""

import argparse
import itertools
import json
import math
import pathlib

STATES = 9  # of the frozen system: positions, velocities, clock
CLOCK = 8
EMPTY = 1e-5  # relative length
GROUPS = [STATES, 3, 1, 6]  # of a stage in the step form: states, selections, lifted products, multipliers


def legendre(degree, x):
    before, value = 0.0, 1.0
    for n in range(degree):
        before, value = value, ((2 * n + 1) * x * value - n * before) / (n + 1)
    return value


def radau(count):
    """Nodes of Radau IIA: where Legendre polynomials of two degrees meet; the last is 1."""
    def difference(x):
        return legendre(count, 2 * x - 1) - legendre(count - 1, 2 * x - 1)

    nodes, steps = [], 1000
    for i in range(steps - 1):
        low, high = i / steps, (i + 1) / steps
        if difference(low) * difference(high) > 0:
            continue
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if difference(low) * difference(middle) > 0 else (low, middle)
        nodes.append(0.5 * (low + high))
    return [*nodes, 1.0]


RADAU = {count: radau(count) for count in range(2, 8)}


def shifted(result, x, t):
    """The variables of all intervals, elsewhere and later. Of an interval: torques, speed of time, lengths, elements; of an
    element: the states of its stages, selections, multipliers."""
    intervals, elements = len(result["u"]), len(result["h"][0])
    primal = list(result["start_values"]["primal"])
    block = len(primal) // intervals
    assert block * intervals == len(primal), "states, parameters or the horizon are free"
    own = len(result["u"][0]) + 1 + elements
    size = (block - own) // elements
    for k in range(intervals):
        for n in range(elements):
            first = k * block + own + n * size
            for stage in range(stages(result)):
                primal[first + stage * STATES] += x
                primal[first + stage * STATES + CLOCK] += t
    return primal


def stages(result):
    return int(result["options"]["optimize.stages"])


def interpolated(nodes, values, at):
    """Rows of values at the nodes: the polynomial through them at one point more."""
    weights = []
    for i, node in enumerate(nodes):
        weight = 1.0
        for j, other in enumerate(nodes):
            weight *= (at - other) / (node - other) if j != i else 1.0
        weights.append(weight)
    return [sum(weight * row[i] for weight, row in zip(weights, values)) for i in range(len(values[0]))]


class Elements:
    """Of one interval: local lengths (their sum is 1), and blocks of variables by stage."""

    def __init__(self, values, controls, count, stages):
        first = controls + 1
        self.lengths = values[first : first + count]
        self.stages, self.head, self.blocks = stages, values[:first], []
        at = first + count
        for _ in range(count):
            block = []
            for group in GROUPS:
                block.append([values[at + i * group : at + (i + 1) * group] for i in range(stages)])
                at += stages * group
            self.blocks.append(block)


def sampled(elements, group, time, stages):
    """Variables at a time since the start of the first element; an element: length, states at its start, block."""
    for number, (length, left, block) in enumerate(elements):
        if time <= length * (1 + 1e-12) or number == len(elements) - 1:
            local = min(time / length, 1.0)
            if group == 0:
                return interpolated([0.0, *RADAU[stages]], [left, *block[0]], local)
            return [max(value, 0.0) for value in interpolated(RADAU[stages], block[group], local)]
        time -= length
    raise AssertionError


def with_points(start, points):
    """A result with other stages: states on the polynomial of each element, the rest on that of its stages."""
    before, values = stages(start), start["start_values"]
    intervals, elements, old = len(start["u"]), len(start["h"][0]), values["primal"]
    own = len(start["u"][0]) + 1 + elements
    size = before * sum(GROUPS)
    assert intervals * (own + elements * size) == len(old), "not the step form"
    nodes, primal, left = RADAU[before], [], [*start["trajectory"]["x"][0][:CLOCK], 0.0]
    for k in range(intervals):
        first = k * (own + elements * size)
        primal += old[first : first + own]
        for n in range(elements):
            at = first + own + n * size
            for group in GROUPS:
                rows = [old[at + i * group : at + (i + 1) * group] for i in range(before)]
                at += before * group
                if group == STATES:
                    for node in RADAU[points]:
                        primal += interpolated([0.0, *nodes], [left, *rows], node)
                    left = rows[-1]
                else:
                    for node in RADAU[points]:
                        primal += [max(value, 0.0) for value in interpolated(nodes, rows, node)]
    options = {**start["options"], "optimize.stages": points}
    return {**start, "options": options, "start_values": {**values, "primal": primal}}


def pieces_of(start):
    """All elements one behind the other: duration in frozen time, states at the start, blocks by stage, torques."""
    values, controls, count = start["start_values"]["primal"], len(start["u"][0]), len(start["h"][0])
    left, step = [*start["trajectory"]["x"][0][:CLOCK], 0.0], start["horizon"] / len(start["u"])
    block = len(values) // len(start["u"])
    for k in range(len(start["u"])):
        one = values[k * block : (k + 1) * block]
        elements = Elements(one, controls, count, stages(start))
        for length, rows in zip(elements.lengths, elements.blocks):
            if length > EMPTY:
                yield length * one[controls] * step, left, rows, one[:controls]
            left = rows[0][-1]


def part(piece, first, last, points):
    """Of a piece, between two parts of its duration."""
    duration, left, rows, torques = piece
    whole = [(1.0, left, rows)]
    times = [first + (last - first) * node for node in RADAU[points]]
    blocks = [[sampled(whole, group, time, points) for time in times] for group in range(len(GROUPS))]
    return duration * (last - first), sampled(whole, 0, first, points) if first > 0 else left, blocks, torques


def cut_at(piece, time, points):
    """The part of its duration at which the clock of a piece shows a time."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sampled([(1.0, piece[1], piece[2])], 0, middle, points)[CLOCK] < time else (low, middle)
    return low


def with_intervals(start, intervals):
    """A result with other intervals: torques are those that act longest in each."""
    points, count, step = stages(start), len(start["h"][0]), start["horizon"] / intervals
    rest, primal, torques = list(pieces_of(start)), [], []
    for k in range(intervals):
        own, end = [], (k + 1) * step
        while rest and rest[0][2][0][-1][CLOCK] <= end + 1e-9:
            own.append(rest.pop(0))
        if rest and k < intervals - 1:
            cut = cut_at(rest[0], end, points)
            if cut > 1e-4:
                own.append(part(rest[0], 0.0, cut, points))
                rest[0] = part(rest[0], cut, 1.0, points)
        while len(own) > count:
            own.remove(min(own, key=lambda piece: piece[0]))
        parts = [1] * len(own)
        while sum(parts) < count:
            parts[max(range(len(own)), key=lambda n: own[n][0] / parts[n])] += 1
        elements = [part(piece, i / n, (i + 1) / n, points) for piece, n in zip(own, parts) for i in range(n)]
        total = math.fsum(piece[0] for piece in elements)
        torques.append(max(own, key=lambda piece: piece[0])[3])
        primal += [*torques[-1], total / step, *[piece[0] / total for piece in elements]]
        primal += [value for piece in elements for group in piece[2] for row in group for value in row]
    options = {**start["options"], "optimize.control_intervals": intervals}
    return {**start, "options": options, "u": torques, "h": [[step / count] * count] * intervals,
            "grid": [k * step for k in range(intervals + 1)], "speed_of_time": [1.0] * intervals,
            "start_values": {**start["start_values"], "primal": primal}}


def of_regions(selections, multipliers):
    """Stewart's theta, lambda and mu of a stage from selections and the signed values (two multipliers each) of gap, rate, slip."""
    psi = [multipliers[2 * j + 1] - multipliers[2 * j] for j in range(len(selections))]
    theta, distance = [], []
    for signs in itertools.product((1, -1), repeat=len(psi)):
        theta.append(math.prod(alpha if sign > 0 else 1 - alpha for alpha, sign in zip(selections, signs)))
        distance.append(sum(abs(value) - sign * value for value, sign in zip(psi, signs)))
    return theta, distance, [-sum(abs(value) for value in psi)]


def with_regions(start):
    """A result in Stewart's form."""
    values, controls, count = start["start_values"]["primal"], len(start["u"][0]), len(start["h"][0])
    block, primal = len(values) // len(start["u"]), []
    for first in range(0, len(values), block):
        one = values[first : first + block]
        primal += one[: controls + 1 + count]
        for states, selections, _, multipliers in Elements(one, controls, count, stages(start)).blocks:
            regions = zip(*[of_regions(*stage) for stage in zip(selections, multipliers)])
            primal += [value for group in (states, *regions) for row in group for value in row]
    options = {**start["options"], "optimize.reformulation": "stewart"}
    return {**start, "options": options, "start_values": {**start["start_values"], "primal": primal}}


def joined(hops):
    """A result to start from."""
    start = json.loads(json.dumps(hops[0]))
    start.pop("record_sha256", None)  # of the result that it was
    values = start["start_values"] = {**start["start_values"], "primal": [], "dual_rows": [], "dual_lower": [], "dual_upper": []}
    rows = {key: [] for key, column in start["trajectory"].items() if isinstance(column, list)}
    x = t = 0.0
    for hop in hops:
        values["primal"] += shifted(hop, x, t)
        trajectory = {**hop["trajectory"], "t": [t + value for value in hop["trajectory"]["t"]],
                      "x": [[row[0] + x, *row[1:]] for row in hop["trajectory"]["x"]]}
        for key, column in rows.items():
            column += trajectory[key]
        x += hop["final"]["x"][0]
        t += hop["horizon"]
    start["trajectory"] = {**start["trajectory"], **rows}
    return start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("hops", nargs="+")
    parser.add_argument("--out", required=True)
    parser.add_argument("--points", type=int, help="stages")
    parser.add_argument("--intervals", type=int)
    parser.add_argument("--stewart", action="store_true")
    arguments = parser.parse_args()
    hops = [json.loads(pathlib.Path(name).read_text(encoding="utf-8")) for name in arguments.hops]
    start = joined(hops)
    if arguments.points:
        start = with_points(start, arguments.points)
    if arguments.intervals:
        start = with_intervals(start, arguments.intervals)
    if arguments.stewart:
        start = with_regions(start)
    pathlib.Path(arguments.out).write_text(json.dumps(start), encoding="utf-8")


if __name__ == "__main__":
    main()
