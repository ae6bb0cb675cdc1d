"""What a builder states beside rates: jumps, hysteresis, mechanics, contacts, optimal control."""

from __future__ import annotations

import collections.abc
import typing

import numpy as np

from ._array import entries_of, is_sparse
from ._entries import least_squares, one_of
from ._expression import Expression, Operand, is_foreign, refuse
from ._statement import WORDS, Entries, Rates, Statement, given, vector_of

#: By state, or in the order of the states that are meant.
Coefficients = typing.Any


class Structure(Statement):
    """The part of :class:`saltus.Builder` for what has rules of its own."""

    def jump(
        self,
        when: Expression | None = None,
        set: Rates = {},
        *,
        direction: str | None = None,
        at: typing.Sequence[Operand] | Operand | None = None,
        every: Operand = None,
        name: str | None = None,
        at_start: bool = False,
        priority: Operand = None,
        delay: Operand = None,
        persistent: bool = True,
        values: str | None = None,
    ) -> None:
        """Gives states new values, all at once: when a condition becomes true, when an expression passes 0 in a
        `direction`, `at` given times, or `every` so often. All keys: docs/model-file.md.

        >>> m = saltus.Builder("ball")
        >>> y, v = m.state("y", 1), m.state("v", 0)
        >>> m.rate(y, v)
        >>> m.rate(v, -9.81)
        >>> m.jump(y, {v: -0.8*v}, direction="down", name="bounce")
        >>> m.simulate(until=0.5).events[0]
        <jump of bounce at t = 0.451523641>
        """
        if not isinstance(set, typing.Mapping):
            raise refuse(f"set={set}: expected a dict of states and their new values", "m.jump(x > 1, {x: 0})")
        if not set:
            raise refuse("the jump changes nothing", "say which states get which values: m.jump(x > 1, {x: 0})")
        one_of("direction", direction, "up", "down", "both")
        if sum(cause is not None for cause in (when, at, every)) != 1:
            raise refuse("when the jump happens is not clear", "give one of: a condition, at=[t1, t2], every=T")
        entry = {
            "when": self._own_or_none(when),
            "direction": direction,
            "at": None if at is None else [self._own(time) for time in (at if np.ndim(at) else [at])],
            "every": self._own_or_none(every),
            "set": self._rates(set),
            "name": self._named(name),
            "at_start": at_start or None,
            "priority": self._own_or_none(priority),
            "delay": self._own_or_none(delay),
            "persistent": None if persistent else False,
            "values": values,
        }
        self._lists["jumps"].append(given(entry))

    def hysteresis(
        self, name: str, input: Operand, *, on: Operand, off: Operand, initial: Operand = None
    ) -> Expression:
        """A name that is 0 or 1: it becomes 1 where `input` rises through `on`, and 0 where it falls through `off`.

        With `on` below `off` it is the other way round: 1 where `input` falls through `on`, as a thermostat, and 0 where
        it rises through `off`. Each change is an event "jump" of this name.

        >>> m = saltus.Builder("room")
        >>> T = m.state("T", 15)
        >>> heats = m.hysteresis("heats", T, on=18, off=20, initial=1)
        >>> m.rate(T, 10*heats - 0.1*T)
        >>> m.simulate(until=10).events[0]
        <jump of heats off at t = 0.606246218>
        """
        entry = given({"input": input, "on": on, "off": off, "initial": initial})
        owned = {key: self._own(value) for key, value in entry.items()}
        self._take(name)
        self._lists["hysteresis"].append({"name": name, **owned})
        return Expression(name, owner=self)

    def mechanics(
        self,
        positions: typing.Any,
        velocities: typing.Any,
        *,
        mass: typing.Any = None,
        force: Coefficients | None = None,
        potential: Operand = None,
        coriolis: str | None = None,
        draw: typing.Sequence[typing.Mapping[str, typing.Any]] | None = None,
    ) -> None:
        """Moves positions and velocities by M(q) v' = force - grad potential; `force` by velocity, or a vector in their
        order. Without `mass` M is the identity; it is a list of rows, or a matrix of NumPy, CasADi, SymPy or scipy.sparse;
        positions and velocities may be vectors of these, too. ``coriolis="auto"`` adds the terms of a mass matrix that depends on positions. `draw` lists lines
        and discs for the page of a report: ``[{"point": [0, y], "radius": 0.1}]``.

        >>> m = saltus.Builder("ball")
        >>> y, v = m.state("y", 1), m.state("v", 0)
        >>> m.mechanics([y], [v], force={v: -9.81})
        >>> m.contact("ground", gap=y, restitution=0.5)
        >>> m.simulate(until=0.5).events[0]
        <impact of ground at t = 0.451523641>
        """
        if self._mechanics:
            raise refuse("the mechanics are stated twice", "state all positions and velocities at once")
        one_of("coriolis", coriolis, "auto", "none")
        moving = self._states(velocities)
        entry = {
            "positions": self._states(positions),
            "velocities": moving,
            "mass": None if mass is None else self._matrix(mass, len(moving)),
            "force": None if force is None else self._by_state("force", force, moving),
            "potential": self._own_or_none(potential),
            "coriolis": coriolis,
            "draw": None if draw is None else self._own_all(draw),
        }
        self._mechanics = given(entry)

    def contact(
        self,
        name: str,
        gap: Operand,
        *,
        tangent: Coefficients | None = None,
        tangents: typing.Any = None,
        friction: Operand = None,
        restitution: Operand = None,
    ) -> None:
        """Bodies of :meth:`mechanics` that touch where `gap` is 0.

        `tangent` has the coefficients of velocities by position, or is a vector in the order of the positions, as the
        Jacobian of the point that touches; in space there are two of them, `tangents`, a list or the rows of a matrix.

        >>> m = saltus.Builder("block")
        >>> x, y, u, v = m.state("x", 0), m.state("y", 0), m.state("u", 2), m.state("v", 0)
        >>> m.mechanics([x, y], [u, v], force={v: -10})
        >>> m.contact("ground", gap=y, tangent={x: 1}, friction=0.5)
        >>> m.simulate(until=1).events[0]
        <stick of ground at t = 0.4>
        """
        positions = self._mechanics.get("positions", [])
        rows = None if tangents is None else entries_of(tangents)
        entry = {
            "name": name,
            "gap": self._own(gap),
            "tangent": None if tangent is None else self._by_state("tangent", tangent, positions),
            "tangents": None
            if tangents is None
            else [self._by_state("tangents", one, positions) for one in (tangents if rows is None else rows)],
            "friction": self._own_or_none(friction),
            "restitution": self._own_or_none(restitution),
        }
        self._take(name, reserved=WORDS)
        self._lists["contacts"].append(given(entry))

    def _by_state(self, what: str, value: Coefficients, states: list[str]) -> dict[str, Expression]:
        """Expressions by state; those of a vector, but for zeros, in the order of these states."""
        if isinstance(value, collections.abc.Mapping):
            return self._rates(value)
        if not (isinstance(value, (list, tuple, np.ndarray)) or is_sparse(value) or is_foreign(value)):
            raise refuse(f"{what}: expected a dict by states, or a vector in their order, found {value!r}", "e.g. {x: 1}")
        if not states:
            raise refuse(f"{what}: whose entries these are is not known", "state m.mechanics first, or give a dict: {x: 1}")
        entries = [self._own(entry) for entry in vector_of(value)]
        if len(entries) != len(states):
            raise refuse(f"{what} has {len(entries)} entries", f"expected one for each of {', '.join(states)}, or a dict: {{{states[0]}: 1}}")
        return {name: entry for name, entry in zip(states, entries) if entry.text.lstrip("-") not in ("0", "0.0")}

    def _matrix(self, mass: typing.Any, size: int) -> list[list[Expression]]:
        found = entries_of(mass)
        rows = list(mass if found is None else found)
        if size == 1 and len(rows) == 1 and not isinstance(rows[0], (list, tuple, np.ndarray)):
            rows = [rows]
        lengths = {len(row) if isinstance(row, (list, tuple, np.ndarray)) else 0 for row in rows}
        if len(rows) != size or lengths != {size}:
            shown = f"{len(rows)} rows of {' and '.join(map(str, sorted(lengths)))} entries"
            raise refuse(f"mass: expected {size} rows of {size} entries, found {shown}", "a row and a column per velocity")
        return [[self._own(value) for value in row] for row in rows]

    def optimal_control(self, **problem: typing.Any) -> None:
        """What is to be optimised, with the keys of [optimize]: expressions, conditions, lists and dicts of them.

        Measurements are in memory, or in a file: ``least_squares=[{"of": [x], "reference": (times, values)}]``.

        >>> m = saltus.Builder("car")
        >>> q, v, u = m.state("q", 0), m.state("v", 0), m.control("u", lower=-1, upper=1)
        >>> m.rate(q, v)
        >>> m.rate(v, u)
        >>> m.optimal_control(
        ...     horizon={"free": True, "initial": 2.5, "lower": 1, "upper": 5}, minimize_time=True, control_intervals=4,
        ...     terminal_constraints=[q == 1, v == 0],
        ... )
        >>> round(m.optimize().objective, 6)
        2.0
        """
        if self._optimize:
            raise refuse("the problem of optimal control is stated twice", "state all of its keys at once")
        if not problem:
            raise refuse("the problem of optimal control has no keys", "e.g. horizon=1, objective=x**2")
        self._optimize = self._problem(problem)

    def time_freezing(self, **keys: typing.Any) -> None:
        """How time stands still at contacts and hysteresis, with the keys of [time_freezing] (docs/model-file.md).

        >>> m = saltus.Builder("ball")
        >>> y, v = m.state("y", 1), m.state("v", 0)
        >>> m.mechanics([y], [v], force={v: -9.81})
        >>> m.contact("ground", gap=y)
        >>> m.time_freezing(a_n=20)
        >>> abs(m.simulate(until=1, method="fesd", steps=20).final["y"]) < 1e-6
        True
        """
        self._time_freezing = self._keys(keys)

    def simulation(self, **options: typing.Any) -> None:
        """Options that the model file is to have, with the keys of [simulate]; those of :meth:`simulate` come later.

        >>> m = saltus.Builder("decay")
        >>> x = m.state("x", 1)
        >>> m.rate(x, -x)
        >>> m.simulation(until=3, output={"points": 4})
        >>> m.simulate().t.tolist()
        [0.0, 1.0, 2.0, 3.0]
        """
        self._simulate = self._keys(options)

    def _problem(self, keys: Entries) -> Entries:
        parts = keys.get("least_squares")
        return self._keys(keys if parts is None else {**keys, "least_squares": least_squares(parts)})

    def _keys(self, keys: Entries) -> Entries:
        return {name.rstrip("_"): self._own_all(value) for name, value in given(keys).items()}
