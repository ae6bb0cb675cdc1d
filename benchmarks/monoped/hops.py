"""Hops of the monoped one behind the other: a start for a longer way whose sides are right.

python3 benchmarks/monoped/hops.py RESULT.json RESULT.json … --out START.json [--points S]

Every result is one of `saltus optimize` that begins and ends at rest, leg straight, with equally long intervals and the
same number of elements. A hop may be there several times: the robot moves the same wherever it stands.
--points: the elements get that many stages, on the polynomials of theirs. Sides stay what they are, while a result that
is sampled (as --start does where numbers of stages differ) loses elements in which time stands still.
"""

import argparse
import json
import pathlib

STATES = 9  # of the frozen system: positions, velocities, clock
CLOCK = 8
GROUPS = [STATES, 3, 1, 6]  # of a stage in the step form: states, selections, lifted products, multipliers
RADAU = {2: [1 / 3, 1], 3: [(4 - 6**0.5) / 10, (4 + 6**0.5) / 10, 1],
         4: [0.08858795951270395, 0.4094668644407347, 0.787659461760847, 1],
         5: [0.05710419611451768, 0.2768430136381238, 0.5835904323689168, 0.8602401356562195, 1]}


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


def joined(hops):
    """A result to start from."""
    start = json.loads(json.dumps(hops[0]))
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
    arguments = parser.parse_args()
    hops = [json.loads(pathlib.Path(name).read_text(encoding="utf-8")) for name in arguments.hops]
    start = joined(hops)
    if arguments.points:
        start = with_points(start, arguments.points)
    pathlib.Path(arguments.out).write_text(json.dumps(start), encoding="utf-8")


if __name__ == "__main__":
    main()
