#!/usr/bin/env python3
"""Reference solutions of the catalogue, to far more digits than a double holds.

Writes references.json beside this file. It shares nothing with Saltus: the equations are written down again here, the
arithmetic is mpmath's with 40 digits, a step is a Taylor polynomial of degree 40 whose coefficients come from the
recursion of the right-hand side, and events are roots of the polynomial psi(x(t)) or alpha(t), found to full precision.
Every problem is solved twice (degree 40 with 40 digits, degree 52 with 50 digits); a number is written to the digits on
which both agree, at most 20. Where a closed form exists it is compared, too (`closed_forms`).

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install mpmath gmpy2
    /tmp/venv/bin/python tests/problems/make_references.py            writes references.json
    /tmp/venv/bin/python tests/problems/make_references.py --check    compares with the stored file instead
"""

import json
import pathlib
import sys

import catalogue_problems
import classic_problems
import contact_problems
import controlled_problems
import intersection_problems
import higher_order_problems
import jump_problems
import mpmath
import phased_problems
import region_problems
from mpmath import mp, mpf
from taylor_events import solve

HERE = pathlib.Path(__file__).parent
OUTPUT = HERE / "references.json"
DIGITS = 20  # written at most


# ----------------------------------------------------------------------------------------------------------------- output
def agreement(a, b):
    """Significant digits (of numbers below 1: digits behind the point) on which two runs agree."""
    return mp.dps if a == b else float(-mpmath.log10(abs(a - b) / max(1, abs(a), abs(b))))


def numbers_of(solution):
    for event in solution["events"]:
        yield event["t"]
        yield from event["x"]
        yield from event.get("x_after", [])
    yield from solution["final"]["x"]
    yield from (alpha for alpha in solution["final"]["alpha"] if alpha is not None)
    yield from solution["final"].get("theta", [])


class Raw(float):
    """A float that json writes with the digits we want."""

    def __new__(cls, value):
        text = mpmath.nstr(value, DIGITS, min_fixed=-6, max_fixed=DIGITS) if abs(value) > mpf(10) ** -25 else "0.0"
        raw = super().__new__(cls, float(text))
        raw.text = text
        return raw

    def __repr__(self):
        return self.text


def written(value):
    if isinstance(value, mpf):
        return Raw(value)
    if isinstance(value, dict):
        return {key: written(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [written(item) for item in value]
    return value


def entry_of(problem):
    mp.dps = 40
    run = getattr(problem, "solve", lambda degree: solve(problem, degree))
    first = run(40)
    mp.dps = 50
    second = run(52)
    assert [e["kind"] for e in first["events"]] == [e["kind"] for e in second["events"]], problem.model
    digits = min(agreement(a, b) for a, b in zip(numbers_of(first), numbers_of(second)))
    assert digits > DIGITS, f"{problem.model}: only {digits:.1f} digits"
    entry = dict(model=problem.model, case=problem.case, overrides=problem.overrides,
                 initial_mode=problem.initial_mode, until=second["final"]["t"], digits=DIGITS, how=problem.source,
                 events=second["events"], final=second["final"])
    return {key: value for key, value in entry.items() if value not in ("", {})}, digits


def dump(entries):
    """json.dumps writes floats by float.__repr__, which loses Raw's digits: substitute them afterwards."""
    texts = []

    def mark(value):
        if isinstance(value, Raw):
            texts.append(value.text)
            return f"@{len(texts) - 1}@"
        if isinstance(value, dict):
            return {key: mark(item) for key, item in value.items()}
        return [mark(item) for item in value] if isinstance(value, list) else value

    lines = []
    for entry in entries:
        entry = mark(written(entry))
        head = {k: v for k, v in entry.items() if k not in ("events", "final")}
        events = ",\n".join("        " + json.dumps(event) for event in entry["events"])
        events = f"[\n{events}\n      ]" if events else "[]"
        lines.append(
            "    { " + json.dumps(head)[1:-1] + f',\n      "events": {events},\n      "final": {json.dumps(entry["final"])} }}'
        )
    text = '{ "format": "saltus-references/1",\n  "problems": [\n' + ",\n".join(lines) + "\n  ] }\n"
    for i, number in enumerate(texts):
        text = text.replace(f'"@{i}@"', number, 1)
    return text


def jump_entries():
    """Models with jumps, with 40 and 50 digits like the others."""
    mp.dps = 40
    first = jump_problems.entries()
    mp.dps = 50
    for a, b in zip(first, jump_problems.entries()):
        digits = min(agreement(p, q) for p, q in zip(numbers_of(a), numbers_of(b), strict=True))
        assert digits > DIGITS, f"{a['model']}: only {digits:.1f} digits"
        print(f"{a['model']}: {len(b['events'])} jumps, both runs agree to {digits:.1f} digits", file=sys.stderr)
        yield {**{key: b[key] for key in ("model", "until")}, "digits": DIGITS, "how": b["how"],
               "events": b["events"], "final": b["final"]}


def report_on(problem, entries):
    entry, digits = entry_of(problem)
    entries.append(entry)
    counted = sum(e["kind"] != "start" for e in entry["events"])
    print(f"{problem.model} {problem.case}: {counted} events, both runs agree to {digits:.1f} digits", file=sys.stderr)
    return entry


def main():
    entries = []
    for problem in [*catalogue_problems.problems(), *classic_problems.classics()]:
        entry = report_on(problem, entries)
        closed = {**catalogue_problems.closed_forms(), **classic_problems.closed_forms()}
        catalogue_problems.compare_with_closed_form(problem, entry, closed)
    entries += jump_entries()
    for problem in phased_problems.problems():
        phased_problems.compare_with_literature(problem, report_on(problem, entries))
    for problem in intersection_problems.problems():
        intersection_problems.compare_with_literature(problem, report_on(problem, entries))
    for problem in region_problems.problems():
        report_on(problem, entries)
    for problem in [*higher_order_problems.problems(), *controlled_problems.problems(), *contact_problems.problems()]:
        report_on(problem, entries)
    text = dump(entries)
    json.loads(text)
    if "--check" in sys.argv:
        sys.exit(0 if OUTPUT.read_text() == text else "references.json differs from what this program computes")
    OUTPUT.write_text(text)


if __name__ == "__main__":
    main()
