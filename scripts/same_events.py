"""Compares the results of two builds of the tool: the same events, and numbers within a tenth of the tolerance of the run.

usage: same_events.py OLD NEW [--only WORD] [--engine event|fesd] [--seconds S] [--tests]

Runs what same_bits.py runs. Two results are the same if these are equal: the status, the events by kind, name and surfaces,
whether each is unique and which modes it might go on with, modes, regions and modes of contacts at events, in rows and at
the end; and if these are within a tenth of a tolerance: times and states of events, rows and end. The tolerance of a state
is rtol |x| + atol with the options of the run and the largest |x| that this state has along the old run; that of a time is
rtol max(|t|, 1) + atol. Selections, outputs and statistics are not compared. Prints what differs, and the largest
difference of all runs in tolerances; exit code 1 if anything is beyond.
"""

import itertools
import sys

import two_builds

LIMIT = 0.1  # tolerances
OF_EVENT = ("kind", "name", "surfaces", "unique", "mode_before", "mode_after", "regions_before", "regions_after",
            "contact_modes_before", "contact_modes_after")
OF_ROW = ("mode", "regions", "contact_modes")


def decisions(old, new):
    """The first thing that is decided otherwise, or None."""
    if (old["status"]["termination"], new["status"]["termination"]) != (old["status"]["termination"],) * 2:
        return f"status: {old['status']['termination']} became {new['status']['termination']}"
    for number, (one, other) in enumerate(itertools.zip_longest(old["events"], new["events"])):
        if one is None or other is None:
            event = one or other
            return (f"{len(old['events'])} events became {len(new['events'])}: {'no' if other is None else 'a new'} "
                    f"{event['kind']} at t = {event['t']}")
        for key in OF_EVENT:
            if one.get(key) != other.get(key):
                return f"event {number} at t = {one['t']}: {key} {one.get(key)} became {other.get(key)}"
        modes = [[(to.get("mode"), to.get("regions")) for to in event.get("alternatives", ())] for event in (one, other)]
        if modes[0] != modes[1]:
            return f"event {number} at t = {one['t']}: alternatives {modes[0]} became {modes[1]}"
    times = old["trajectory"]["t"]
    if len(times) != len(new["trajectory"]["t"]):
        return f"{len(times)} rows became {len(new['trajectory']['t'])}"
    for key in OF_ROW:
        if old["final"].get(key) != new["final"].get(key):
            return f"{key} at the end: {old['final'].get(key)} became {new['final'].get(key)}"
        rows = [result["trajectory"].get(key) or [] for result in (old, new)]
        for number, (one, other) in enumerate(itertools.zip_longest(*rows)):
            if one != other:
                return f"{key} of row {number} at t = {times[number]}: {one} became {other}"
    return None


def moments(result):
    """Name, time and pairs of a state's name and value: of every row, of both sides of every event and of the end."""
    names = result["states"]
    kept = result["kept_columns"]["states"] if "kept_columns" in result else names
    for number, (t, x) in enumerate(zip(result["trajectory"]["t"], result["trajectory"]["x"])):
        yield f"row {number}", t, list(zip(kept, x))
    for number, event in enumerate(result["events"]):
        yield f"event {number}", event["t"], list(zip(names, event["x"]))
        yield f"event {number}", event["t"], list(zip(names, event["x_after"]))
    yield "end", result["final"]["t"], list(zip(names, result["final"]["x"]))


def is_number(value):
    return isinstance(value, (int, float)) and value == value


def sizes(result):
    """The largest absolute value of every state, by its name."""
    largest = dict.fromkeys(result["states"], 0.0)
    for _, _, states in moments(result):
        for name, value in states:
            if is_number(value) and abs(value) > largest[name]:
                largest[name] = abs(value)
    return largest


def distances(old, new):
    """Differences in tolerances with what differs, of results with the same decisions."""
    rtol, atol = old["options"]["simulate.rtol"], old["options"]["simulate.atol"]
    scales = {name: rtol * size + atol for name, size in sizes(old).items()}
    for (place, t, states), (_, t_new, states_new) in zip(moments(old), moments(new)):
        yield abs(t - t_new) / (rtol * max(abs(t), 1.0) + atol), f"time of {place}, t = {t}"
        for (name, one), (_, other) in zip(states, states_new):
            equal = one == other or repr(one) == repr(other)  # infinities, NaN
            comparable = is_number(one) and is_number(other) and scales[name] < float("inf")
            distance = 0.0 if equal else abs(one - other) / scales[name] if comparable else float("inf")
            yield distance, f"{name} of {place}, t = {t}"


def compared(old, new):
    """A pair: what is decided otherwise or None; the largest difference in tolerances, with what differs by it."""
    nothing = (0.0, "")
    if "exit" in old or "exit" in new:
        return (None if old == new else f"{old.get('message', 'a result')} became {new.get('message', 'a result')}"), nothing
    decided = decisions(old, new)
    if decided:
        return decided, nothing
    largest = max(distances(old, new), default=nothing)
    branches = [result.get("branches") or [] for result in (old, new)]
    if len(branches[0]) != len(branches[1]):
        return f"{len(branches[0])} branches became {len(branches[1])}", largest
    for number, (one, other) in enumerate(zip(*branches)):
        options = {"options": old["options"], "states": old["states"]}
        decided, distance = compared(options | one, options | other)
        if decided:
            return f"branch {number}: {decided}", largest
        largest = max(largest, distance)
    return None, largest


def main():
    arguments = two_builds.arguments_of(__doc__)
    worst = []

    def difference(run, old, new):
        decided, largest = compared(old, new)
        worst.append((*largest, " ".join([run[0], *run[1]])))
        return decided or (f"{largest[0]:.2g} tolerances: {largest[1]}" if not largest[0] <= LIMIT else None)

    code = two_builds.compare(arguments, difference)
    if worst and max(worst)[0] > 0.0:
        size, place, run = max(worst)
        print(f"largest difference where events are the same: {size:.2g} tolerances ({run}: {place})")
    return code


if __name__ == "__main__":
    sys.exit(main())
