"""What a notebook shows of a result: a card with a picture, without scripts."""

from __future__ import annotations

import html
import typing

import numpy as np

from ._shape import as_drawn, broken_at_jumps, corners, is_stepwise, sliding_spans, thinned

from ._events import Event
from ._recorded import Recorded


class Model(typing.Protocol):
    """What a card shows of a model."""

    @property
    def name(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def states(self) -> dict[str, float]: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    def equations(self, *, latex: bool = False) -> list[tuple[str, str, str]]: ...


class Sweep(typing.Protocol):
    """What a card shows of a sweep."""

    @property
    def table(self) -> dict[str, typing.Any]: ...


#: Of a picture, and of a panel of it, with room above for its caption.
WIDTH, HEIGHT, LEFT, ABOVE = 520, 56, 46, 18
MOST_ROWS = 6
MOST_POINTS = 600
#: Ticks of events are that far apart.
LEAST_DISTANCE = 3
MOST_EVENTS = 8
MOST_EQUATIONS = 40
MOST_COLUMNS = 12


def card(r: Recorded) -> str:
    """At most some tens of kilobytes of HTML."""
    colour = "#1b7f4b" if r.status.done else "#b3261e"
    message = f"<div style='color:{colour}'>{html.escape(r.status.message)}</div>" if r.status.message else ""
    return (
        "<div style='font:13px/1.45 system-ui,sans-serif;max-width:580px'>"
        f"<b>{html.escape(r.model)}</b> &nbsp; {html.escape(r.method)} &nbsp; "
        f"<span style='color:{colour}'>{html.escape(str(r.status))}</span>{r._reached(6)} &nbsp; "
        f"{r._counts}{message}{_optimum(r)}{_picture(r)}{_events(r)}</div>"
    )


#: What stands before a sentence, and its colour.
_MARKS = {"good": ("✓", "#1b7f4b"), "neutral": ("·", "inherit"), "bad": ("✗", "#b3261e")}


def _optimum(r: Recorded) -> str:
    """Of an optimum its objective, and what the certificate and the simulation that verifies it say."""
    found = r.optimization
    if found is None:
        return ""
    chosen = "".join(f", {html.escape(name)} = {value:.8g}" for name, value in found.get("parameters", {}).items())
    lines = [f"<div>objective <b>{found['objective']:.10g}</b>, horizon {found['horizon']:.8g}{chosen}</div>"]
    about = ""
    for kind, tone, text in r._run.said():
        if kind != about:
            lines.append(f"<div style='opacity:0.7'>{kind}</div>")
            about = kind
        mark, colour = _MARKS[tone]
        lines.append(f"<div><span style='color:{colour}'>{mark}</span> {html.escape(text)}</div>")
    return "".join(lines)


def table_card(title: str, text: str) -> str:
    """What the tool prints, below a title."""
    return (
        "<div style='font:13px/1.45 system-ui,sans-serif;max-width:900px'>"
        f"<b>{html.escape(title)}</b><pre style='white-space:pre;overflow-x:auto;font-family:monospace'>{html.escape(text.rstrip())}</pre></div>"
    )


def sweep_card(s: Sweep) -> str:
    """How the runs ended, and the first rows of the table."""
    names = list(s.table)[:MOST_COLUMNS]
    columns = [s.table[name][:MOST_EVENTS].tolist() for name in names]
    head = "".join(f"<th>{html.escape(name)}</th>" for name in names) + "<th>…</th>" * (len(s.table) > len(names))
    body = "".join(
        "<tr>" + "".join(f"<td>{_short(value if isinstance(value, str) else f'{value:.6g}')}</td>" for value in row) + "</tr>"
        for row in zip(*columns)
    )
    more = len(s.table[names[0]]) - MOST_EVENTS
    rest = f"<div>and {more} more row{'s' * (more > 1)}: s.frame(), s.plot()</div>" if more > 0 else ""
    return (
        "<div style='font:13px/1.45 system-ui,sans-serif;max-width:900px;overflow-x:auto'>"
        f"<b>{html.escape(repr(s).strip('<>'))}</b><table><tr>{head}</tr>{body}</table>{rest}</div>"
    )


def model_card(model: Model) -> str:
    """Equations in LaTeX, which a notebook typesets, initial values and parameters."""
    equations = model.equations(latex=True)
    rows = "".join(
        f"<tr><td style='text-align:right'>${left}$</td><td style='text-align:left'>$= {html.escape(right)}$</td>"
        f"<td style='text-align:left;opacity:0.7'>{html.escape(where)}</td></tr>"
        for left, right, where in equations[:MOST_EQUATIONS]
    )
    more = len(equations) - MOST_EQUATIONS
    rest = f"<div>and {more} more equations</div>" if more > 0 else ""
    described = f" &nbsp; {html.escape(model.description)}" if model.description else ""
    return (
        "<div style='font:13px/1.45 system-ui,sans-serif;max-width:720px'>"
        f"<b>{html.escape(model.name)}</b>{described}<table>{rows}</table>{rest}"
        f"{_values('starts at', model.states)}{_values('parameters', model.parameters)}</div>"
    )


def _values(title: str, values: dict[str, float]) -> str:
    if not values:
        return ""
    shown = ", ".join(f"{html.escape(name)} = {value:.6g}" for name, value in list(values.items())[:MOST_EQUATIONS])
    more = ", …" if len(values) > MOST_EQUATIONS else ""
    return f"<div>{title}: {shown}{more}</div>"


def _shown(r: Recorded) -> tuple[list[str], int]:
    """The first columns, at least half of them outputs if there are so many, and how many others there are."""
    moved, outputs = [*r._run.states_in_rows, *r.controls], r.output_names
    room = max(MOST_ROWS // 2, MOST_ROWS - len(outputs))
    shown = [*moved[:room], *outputs][:MOST_ROWS]
    return shown, len(moved) + len(outputs) - len(shown)


def _picture(r: Recorded) -> str:
    names, left_out = _shown(r)
    if len(r.t) < 2 or not names:
        return ""
    r = as_drawn(r)
    begin, end = float(r.t[0]), float(r.t[-1])
    if not end > begin:
        return ""
    height = len(names) * (HEIGHT + ABOVE) + 16
    parts = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {height}' width='100%' "
        "style='font:10px system-ui,sans-serif' fill='currentColor' role='img'>"
    ]

    def across(t: typing.Any) -> typing.Any:
        return LEFT + (t - begin) / (end - begin) * (WIDTH - LEFT - 4)

    ticks = _ticks([across(event.t) for event in r.events])
    spans = _joined([(across(a), across(b)) for a, b in sliding_spans(r)])
    for number, name in enumerate(names):
        top = number * (HEIGHT + ABOVE) + ABOVE
        if spans:
            shaded = "".join(f"M{a:.1f} {top}H{b:.1f}v{HEIGHT}H{a:.1f}z" for a, b in spans)
            parts.append(f"<path class='sliding' d='{shaded}' fill='#d95f02' opacity='0.15'/>")
        if ticks:
            marks = "".join(f"M{x:.1f} {top}v4" for x in ticks)
            parts.append(f"<path class='events' d='{marks}' stroke='#888' fill='none'/>")
        parts.append(_curve(r, name, across, top))
    parts.append(f"<text x='{LEFT}' y='{height - 3}'>t = {begin:.4g}</text>")
    if len(ticks) < len(r.events):
        middle = (LEFT + WIDTH - 4) / 2
        said = f"ticks: {len(ticks)} of {len(r.events)} events"
        parts.append(f"<text x='{middle}' y='{height - 3}' text-anchor='middle' opacity='0.7'>{said}</text>")
    parts.append(f"<text x='{WIDTH - 4}' y='{height - 3}' text-anchor='end'>{end:.4g}</text></svg>")
    if left_out:
        parts.append(f"<div>and {left_out} more column{'s' * (left_out > 1)}: r.plot()</div>")
    return "".join(parts)


def _ticks(places: list[float]) -> list[float]:
    """Those that can be told apart, so that of many events some are there everywhere."""
    chosen: list[float] = []
    for place in places:
        if not chosen or place - chosen[-1] >= LEAST_DISTANCE:
            chosen.append(place)
    return chosen


def _joined(spans: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Spans on the paper, of which those that nobody sees apart are one."""
    joined: list[tuple[float, float]] = []
    for a, b in spans:
        if joined and a - joined[-1][1] < 1:
            joined[-1] = joined[-1][0], b
        else:
            joined.append((a, max(b, a + 0.3)))
    return joined


def _curve(r: Recorded, name: str, across: typing.Callable[[typing.Any], typing.Any], top: int) -> str:
    stepwise = is_stepwise(r.t, r[name])
    t, y = corners(r.t, r[name].astype(float)) if stepwise else broken_at_jumps(r, r.t, r[name])
    t, y = thinned(t, y, MOST_POINTS * (1 + stepwise))
    finite = y[np.isfinite(y)]
    if len(finite) == 0:
        return ""
    low, high = float(finite.min()), float(finite.max())
    scale = (HEIGHT - 6) / (high - low) if high > low else 0.0
    path = _path([f"{x:.1f}" for x in across(t)], [_number(top + HEIGHT - 3 - (v - low) * scale) for v in y])
    return (
        f"<path class='curve' d='{path}' fill='none' stroke='#1f77b4' stroke-width='1.3' stroke-linecap='round'/>"
        f"{_caption(r, name, top - 5)}"
        f"<text x='{LEFT - 3}' y='{top + 9}' text-anchor='end'>{high + 0.0:.3g}</text>"
        f"<text x='{LEFT - 3}' y='{top + HEIGHT}' text-anchor='end'>{low + 0.0:.3g}</text>"
    )


def _number(value: float) -> str:
    return f"{value:.1f}" if np.isfinite(value) else ""


def _path(across: list[str], up: list[str]) -> str:
    """Lines of SVG; none leads to a point without height."""
    parts: list[str] = []
    before = ("", "")
    for x, y in zip(across, up):
        if not y:
            before = ("", "")
        elif not before[1]:
            # Of no length, so that a point between two gaps is seen by the round ends of its line.
            parts.append(f"M{x} {y}h0")
            before = (x, y)
        else:
            parts.append(f"H{x}" if y == before[1] else f"V{y}" if x == before[0] else f"L{x} {y}")
            before = (x, y)
    return "".join(parts)


def _caption(r: Recorded, name: str, y: int) -> str:
    """Above a panel: the name, and the unit and label that the model gives."""
    caption = r._captions.get(name, {})
    unit, label = caption.get("unit", ""), caption.get("label", "")
    beside = f" [{unit}]" * bool(unit) + f" {label}" * bool(label)
    return f"<text x='{LEFT}' y='{y}'><tspan font-weight='bold'>{_short(name)}</tspan>{_short(beside)}</text>"


def _what(event: Event) -> str:
    """Surfaces or name; of a hysteresis with what it turned to."""
    return (", ".join(event.surfaces) or event.name or "") + f" {event.turned}" * bool(event.turned)


def _short(text: str, most: int = 50) -> str:
    return html.escape(text if len(text) <= most else text[: most - 1] + "…")


def _events(r: Recorded) -> str:
    if r._lost_events or not r.events:
        return ""
    rows = "".join(
        f"<tr><td style='text-align:right'>{event.t:.8g}</td><td style='text-align:left'>{html.escape(event.kind)}</td>"
        f"<td style='text-align:left'>{html.escape(_what(event))}</td>"
        f"<td style='text-align:left'>{'not unique' if event.unique is False else ''}</td></tr>"
        for event in r.events[:MOST_EVENTS]
    )
    more = len(r.events) - MOST_EVENTS
    rest = f"<div>and {more} more events</div>" if more > 0 else ""
    return f"<details><summary>events</summary><table>{rows}</table>{rest}</details>"
