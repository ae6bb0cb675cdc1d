"""What a notebook shows of a result: a card with a picture, without scripts."""

from __future__ import annotations

import html
import typing

import numpy as np

from ._shape import as_drawn, broken_at_jumps, sliding_spans, thinned

if typing.TYPE_CHECKING:
    from ._model import Model
    from ._result import Result

WIDTH, HEIGHT, LEFT, GAP = 520, 56, 46, 8
MOST_ROWS = 6
MOST_POINTS = 600
MOST_EVENTS = 8
MOST_EQUATIONS = 40


def card(r: Result) -> str:
    """At most some tens of kilobytes of HTML."""
    shown = [*r._run.states_in_rows, *r.controls][:MOST_ROWS]
    colour = "#1b7f4b" if r.status.done else "#b3261e"
    message = f"<div style='color:{colour}'>{html.escape(r.status.message)}</div>" if r.status.message else ""
    return (
        "<div style='font:13px/1.45 system-ui,sans-serif;max-width:580px'>"
        f"<b>{html.escape(r.model)}</b> &nbsp; {html.escape(r.method)} &nbsp; "
        f"<span style='color:{colour}'>{html.escape(str(r.status))}</span> at t = {r.status.time_reached:.6g} &nbsp; "
        f"{r._counts}{message}{_picture(r, shown)}{_events(r)}</div>"
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


def _picture(r: Result, names: list[str]) -> str:
    if len(r.t) < 2 or not names:
        return ""
    r = as_drawn(r)
    begin, end = float(r.t[0]), float(r.t[-1])
    if not end > begin:
        return ""
    height = len(names) * (HEIGHT + GAP) + 16
    parts = [
        f"<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {height}' width='100%' "
        "style='font:10px system-ui,sans-serif' fill='currentColor' role='img'>"
    ]

    def across(t: typing.Any) -> typing.Any:
        return LEFT + (t - begin) / (end - begin) * (WIDTH - LEFT - 4)

    for number, name in enumerate(names):
        top = number * (HEIGHT + GAP)
        for a, b in sliding_spans(r)[:200]:
            parts.append(
                f"<rect x='{across(a):.1f}' y='{top}' width='{max(across(b) - across(a), 0.3):.1f}' height='{HEIGHT}' "
                "fill='#d95f02' opacity='0.15'/>"
            )
        parts.append(_curve(r, name, across, top))
    parts.append(f"<text x='{LEFT}' y='{height - 3}'>t = {begin:.4g}</text>")
    parts.append(f"<text x='{WIDTH - 4}' y='{height - 3}' text-anchor='end'>{end:.4g}</text></svg>")
    return "".join(parts)


def _curve(r: Result, name: str, across: typing.Callable[[typing.Any], typing.Any], top: int) -> str:
    t, y = broken_at_jumps(r, r.t, r[name])
    t, y = thinned(t, y, MOST_POINTS)
    finite = y[np.isfinite(y)]
    if len(finite) == 0:
        return ""
    low, high = float(finite.min()), float(finite.max())
    scale = (HEIGHT - 6) / (high - low) if high > low else 0.0
    path: list[str] = []
    # Of no length, so that a point between two gaps is seen by the round ends of its line.
    pen, point = "M", "h0"
    for x, v in zip(across(t), y):
        if not np.isfinite(v):
            pen, point = "M", "h0"
            continue
        path.append(f"{pen}{x:.1f} {top + HEIGHT - 3 - (v - low) * scale:.1f}{point}")
        pen, point = "L", ""
    marks = "".join(
        f"<line x1='{across(event.t):.1f}' x2='{across(event.t):.1f}' y1='{top}' y2='{top + 4}' stroke='#888'/>"
        for event in r.events[:100]
    )
    return (
        f"{marks}<path d='{''.join(path)}' fill='none' stroke='#1f77b4' stroke-width='1.3' stroke-linecap='round'/>"
        f"<text x='0' y='{top + HEIGHT / 2:.0f}' font-weight='bold'>{html.escape(name[:12])}</text>"
        f"<text x='{LEFT - 3}' y='{top + 9}' text-anchor='end'>{high:.3g}</text>"
        f"<text x='{LEFT - 3}' y='{top + HEIGHT}' text-anchor='end'>{low:.3g}</text>"
    )


def _events(r: Result) -> str:
    if r._lost_events or not r.events:
        return ""
    rows = "".join(
        f"<tr><td style='text-align:right'>{event.t:.8g}</td><td style='text-align:left'>{html.escape(event.kind)}</td>"
        f"<td style='text-align:left'>{html.escape(', '.join(event.surfaces) or event.name or '')}</td>"
        f"<td style='text-align:left'>{'not unique' if event.unique is False else ''}</td></tr>"
        for event in r.events[:MOST_EVENTS]
    )
    more = len(r.events) - MOST_EVENTS
    rest = f"<div>and {more} more events</div>" if more > 0 else ""
    return f"<details><summary>events</summary><table>{rows}</table>{rest}</details>"
