"""Hops of the monoped one behind the other: a start for a longer way whose sides are right.

python3 benchmarks/monoped/hops.py RESULT.json RESULT.json … --out START.json

Every result is one of `saltus optimize` that begins and ends at rest, leg straight, with equally long intervals and the
same number of elements. A hop may be there several times: the robot moves the same wherever it stands.
"""

import argparse
import json
import pathlib

STATES = 9  # of the frozen system: positions, velocities, clock
CLOCK = 8


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
    arguments = parser.parse_args()
    hops = [json.loads(pathlib.Path(name).read_text(encoding="utf-8")) for name in arguments.hops]
    pathlib.Path(arguments.out).write_text(json.dumps(joined(hops)), encoding="utf-8")


if __name__ == "__main__":
    main()
