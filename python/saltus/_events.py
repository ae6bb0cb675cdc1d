"""Events of a run: their list, and how they pickle and copy."""

from __future__ import annotations

import copyreg
import json
import math
import typing

import numpy as np

from . import _core
from ._errors import needed
from ._names import several
from ._outcome import unknown

Event = _core.Event
Alternative = _core.Alternative
Intersection = _core.Intersection
Json = dict[str, typing.Any]
Array = np.ndarray[typing.Any, np.dtype[typing.Any]]

Event.__doc__ = """A change of mode, a jump, an impact, or an event of the user, at time ``t``.

``kind`` is "start", "crossing", "enter_sliding", "leave_sliding", "change_sliding", "jump", "impact", "accumulation",
"contact", "lift_off", "stick", "slip" or "user"; ``name`` of a jump or an event, ``surfaces`` that changed. ``turned`` of
the jump of a hysteresis is "on" or "off". ``x`` and
``x_after`` are the state on both sides, in the order of ``states``, so are ``mode_before`` and ``mode_after``, ``alpha_…``, ``regions_…`` and
``contact_modes_…``; ``event["v"]`` and ``event["v(after)"]`` are one of the states. ``impulse`` of an impact by contact. ``unique`` says whether the solution goes on in one way only
(None: not decided), ``alternatives`` how else, ``reason`` why it went on as it did; ``intersection`` what was decided at
where two surfaces that influence each other met.

>>> event = saltus.catalogue("bouncing-ball").simulate(until=2).events[0]
>>> event
<jump of bounce at t = 1.42857143>
>>> round(event["v"], 6), round(event["v(after)"], 6)
(-14.0, 12.6)
"""
Alternative.__doc__ = """A continuation that was possible at an event: ``mode``, ``alpha`` and ``regions`` behind it.

>>> event = saltus.catalogue("part-ways").simulate().events[0]
>>> event.unique, event.mode_after, event.alternatives[0]
(False, [0, 0], <alternative: mode [-1, 0], alpha [0, 0.1875]>)
"""

Intersection.__doc__ = """Where the modes of two ``surfaces`` that influence each other were decided together.

``velocities`` of each of them along the fields of the regions with selections (0, 0), (1, 0), (0, 1), (1, 1);
``alpha_before`` and ``alpha_after`` are the selections with which the solution comes (None at a start) and goes on.

>>> [met] = [e.intersection for e in saltus.catalogue("slide-and-hide").simulate().events if e.intersection]
>>> len(met.surfaces), len(met.velocities[0])
(2, 4)
"""


def _of_event(event: Event, name: str) -> typing.Any:
    """What a state is at an event: ``event["x"]`` before it, ``event["x(after)"]`` behind; of an array all of its entries."""
    text = getattr(name, "text", name)
    after = isinstance(text, str) and text.endswith("(after)")
    values, name = (event.x_after, text.removesuffix("(after)")) if after else (event.x, text)
    if name in event.states:
        return float(values[event.states.index(name)])
    names = several(name, event.states)
    if names is None:
        raise unknown(name, event.states, "the event")
    return np.array([values[event.states.index(one)] for one in names.flat]).reshape(names.shape)


Event.__getitem__ = _of_event  # type: ignore[method-assign]

_OF_EVENT = "t kind name surfaces mode_before mode_after alpha_before alpha_after x x_after unique reason".split()
_IF_THERE = "turned regions_before regions_after contact_modes_before contact_modes_after impulse".split()

_OF_INTERSECTION = "surfaces velocities alpha_before alpha_after".split()


class Events(list[_core.Event]):
    """The events of a run, in their order: a list that knows their times, those of one sort, and their table.

    >>> r = saltus.catalogue("stick-slip").simulate(until=10)
    >>> r.events.t.round(3), r.events["leave_sliding"]
    (array([0.245, 4.932, 9.636]), [<leave_sliding of slip at t = 4.93219998>])
    """

    @property
    def t(self) -> Array:
        """Times of all events, ascending, (events,).

        >>> saltus.catalogue("bouncing-ball").simulate(until=5).events.t.round(4)
        array([1.4286, 4.    ])
        """
        return np.array([event.t for event in self], dtype=float)

    @property
    def kind(self) -> list[str]:
        """The kind of every event.

        >>> saltus.catalogue("stick-slip").simulate(until=5).events.kind
        ['enter_sliding', 'leave_sliding']
        """
        return [event.kind for event in self]

    @property
    def name(self) -> list[str | None]:
        """Names of jumps and of events of the user; None of others.

        >>> saltus.catalogue("bouncing-ball").simulate(until=2).events.name
        ['bounce']
        """
        return [event.name for event in self]

    @property
    def x(self) -> Array:
        """States before every event, (events, n_x).

        >>> saltus.catalogue("bouncing-ball").simulate(until=2).events.x[:, 1].round(6).tolist()
        [-14.0]
        """
        return _rows([event.x for event in self])

    @property
    def x_after(self) -> Array:
        """States after every event, (events, n_x).

        >>> saltus.catalogue("bouncing-ball").simulate(until=2).events.x_after[:, 1].round(6).tolist()
        [12.6]
        """
        return _rows([event.x_after for event in self])

    def table(self) -> typing.Any:
        """A table of pandas: a row for every event, with the states before and after it (``v``, ``v(after)``).

        >>> r = saltus.catalogue("stick-slip").simulate(until=10)
        >>> r.events.table()["kind"].tolist()[:2]
        ['enter_sliding', 'leave_sliding']
        """
        pandas = needed("pandas", "data")
        columns: dict[str, typing.Any] = {
            "t": [event.t for event in self],
            "kind": [event.kind for event in self],
            "name": [event.name for event in self],
            "turned": [event.turned for event in self],
            "surfaces": [", ".join(event.surfaces) for event in self],
            "unique": [event.unique for event in self],
            "reason": [event.reason for event in self],
        }
        states = list(dict.fromkeys(name for event in self for name in event.states))
        for after, sides in ("", [event.x for event in self]), ("(after)", [event.x_after for event in self]):
            rows = [dict(zip(event.states, side.tolist())) for event, side in zip(self, sides)]
            for name in states:
                column = name + after if name + after not in columns else f"{name}{after} (model)"
                columns[column] = [row.get(name, math.nan) for row in rows]
        return pandas.DataFrame(columns)

    @typing.overload
    def __getitem__(self, which: typing.SupportsIndex) -> _core.Event: ...
    @typing.overload
    def __getitem__(self, which: slice | str) -> Events: ...
    def __getitem__(self, which: typing.Any) -> typing.Any:
        """An event by its number; several of them by a slice, or by a kind, a name or a surface, as a list of this sort.

        >>> events = saltus.catalogue("stick-slip").simulate(until=10).events
        >>> events[:1].table()["name"].tolist(), events["enter_sliding"].t.round(3)
        ([None], array([0.245, 9.636]))
        """
        if isinstance(which, str):
            found = Events(event for event in self if which in _words_of(event))
            if not found and which not in KINDS:
                raise unknown(which, self._ipython_key_completions_(), "the list of events")
            return found
        one = super().__getitem__(which)
        return Events(one) if isinstance(which, slice) else one

    def _ipython_key_completions_(self) -> list[str]:
        return list(dict.fromkeys(word for event in self for word in _words_of(event)))

    def __reduce__(self) -> tuple[typing.Any, ...]:
        return _restored_events, (_stored(self),)

    def __copy__(self) -> Events:
        return Events(self)


#: All kinds of events.
KINDS = (
    "start crossing enter_sliding leave_sliding change_sliding jump impact accumulation contact lift_off stick slip user"
).split()


def _words_of(event: _core.Event) -> list[str]:
    """What an event may be called."""
    return [word for word in (event.kind, event.name, *event.surfaces) if word]


def _rows(states: list[Array]) -> Array:
    return np.array(states) if states else np.empty((0, 0))


def _stored(events: typing.Sequence[_core.Event]) -> list[Json]:
    return [_stored_event(event) for event in events]


def _stored_event(event: _core.Event) -> Json:
    entries = {name: _number(getattr(event, name)) for name in _OF_EVENT}
    entries["alternatives"] = [_stored_alternative(other) for other in event.alternatives]
    entries["states"] = event.states
    for name in _IF_THERE:
        value = getattr(event, name)
        if value:
            entries[name] = _number(value)
    if event.intersection is not None:
        entries["intersection"] = {name: getattr(event.intersection, name) for name in _OF_INTERSECTION}
    return entries


def _stored_alternative(alternative: _core.Alternative) -> Json:
    entries = {"mode": alternative.mode, "alpha": _number(alternative.alpha)}
    return {**entries, "regions": alternative.regions} if alternative.regions else entries


def _number(value: typing.Any) -> typing.Any:
    """As it is written in a stored result: what is not finite is null."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list):
        return [_number(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _restored_events(stored: list[Json]) -> Events:
    """Events by the reader of stored results: each is the one of a result that has nothing else."""
    return Events(_restored_event(entries) for entries in stored)


def _restored_event(entries: Json) -> _core.Event:
    (event,) = _core.parse_result(json.dumps(_result_with(entries))).events
    return event


def _restored_alternative(entries: Json) -> _core.Alternative:
    width, regions = len(entries["mode"]), entries.get("regions", [])
    event = dict.fromkeys(_OF_EVENT) | {"t": 0.0, "kind": "crossing", "surfaces": [], "x": [], "x_after": [], "reason": ""}
    event |= {"mode_after": [0] * width, "alternatives": [entries]}
    if regions:
        event["regions_after"] = regions
    (alternative,) = _restored_event(event).alternatives
    return alternative


def _result_with(event: Json) -> Json:
    """The smallest result in which an event can stand."""
    columns = next((len(event[name]) for name in _OF_EVENT[4:8] if event[name] is not None), 0)
    contacts = event.get("contact_modes_after", [])
    states = event.pop("states", [])  # that of its name tells which way a hysteresis turned
    rows: Json = {name: [] for name in ("t", "x", "u", "alpha", "mode", "outputs")}
    final = {"t": 0.0, "x": [0.0] * len(states), "mode": [0] * columns, "alpha": [0.0] * columns, "outputs": []}
    result = {
        "format": "saltus-result/1",
        "model": {"name": "", "sha256": "", "parameters": {}},
        "command": "simulate",
        "method": "event",
        "status": {"termination": "completed", "message": "", "time_reached": 0.0},
        "states": states,
        "controls": [],
        "switching_functions": [str(i) for i in range(columns)],
        "outputs": [],
        "final": final,
        "events": [event],
        "trajectory": rows,
        "statistics": {"steps": 0, "rejected": 0, "rhs_evaluations": 0, "wall_seconds": 0.0},
        "options": {},
    }
    if contacts:
        result["contacts"] = [str(i) for i in range(len(contacts))]
        final["contact_modes"] = contacts
    groups = _region_groups(event)
    if groups:
        result["region_groups"] = groups
        final["regions"] = [group["modes"] for group in groups]
        final["theta"] = [0.0] * sum(len(group["modes"]) for group in groups)
    return result


def _region_groups(event: Json) -> list[Json]:
    """Of every group the modes that the event names."""
    lists = [event.get("regions_before"), event.get("regions_after")]
    lists += [other.get("regions") for other in event["alternatives"]]
    named = [regions for regions in lists if regions]
    if not named:
        return []
    return [
        {"name": str(group), "modes": list(dict.fromkeys(mode for regions in named for mode in regions[group]))}
        for group in range(len(named[0]))
    ]


copyreg.pickle(_core.Event, lambda event: (_restored_event, (_stored_event(event),)))
copyreg.pickle(_core.Alternative, lambda other: (_restored_alternative, (_stored_alternative(other),)))
