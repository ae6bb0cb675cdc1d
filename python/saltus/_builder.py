"""Models stated in Python."""

from __future__ import annotations

import collections.abc
import json
import typing

import numpy as np

from . import _array
from ._expression import Expression, Operand, expression, owner_of, refuse
from ._model import Model
from ._result import Result
from ._settings import Value
from ._sweep import Sweep

Rates = typing.Mapping[typing.Any, Operand]
Entries = typing.Union[np.ndarray, list[typing.Any], tuple[typing.Any, ...]]


class Builder:
    """States a model step by step, in the names and rules of model files.

    >>> m = saltus.Builder("brake")
    >>> mu = m.parameter("mu", 2)
    >>> x, v = m.state("x", 0), m.state("v", 3)
    >>> m.rate(x, v)
    >>> m.rate(v, -0.4*x - mu*saltus.sign(v))
    >>> r = m.simulate(until=6)
    >>> r.status, [e.kind for e in r.events]
    ('completed', ['enter_sliding'])

    What is stated is the text of a model file: :meth:`to_toml`. Expressions that switch are functions of this package
    (``saltus.sign``, ``saltus.if_``, ``saltus.max``), conditions are joined by ``& | ~``.
    """

    def __init__(self, name: str, description: str = "", inclusion: str | None = None) -> None:
        self.name = name
        self._model: dict[str, Value] = {"name": name}
        if description:
            self._model["description"] = description
        if inclusion is not None:
            self._model["inclusion"] = inclusion
        self._taken: set[str] = set()
        self._parts: dict[str, dict[str, typing.Any]] = {
            part: {}
            for part in ("parameters", "states", "controls", "definitions", "switching", "dynamics", "outputs", "tables")
        }
        self._modes: list[dict[str, typing.Any]] = []
        self._jumps: list[dict[str, typing.Any]] = []
        self._events: list[dict[str, typing.Any]] = []
        self._inputs: dict[str, Expression] = {}
        self._hysteresis: list[dict[str, typing.Any]] = []
        self._contacts: list[dict[str, typing.Any]] = []
        self._mechanics: dict[str, typing.Any] = {}
        self._optimize: dict[str, typing.Any] = {}

    # Names ---------------------------------------------------------------------------------------------------------

    def parameter(self, name: str, value: Operand) -> Expression:
        """A constant that ``set`` may change."""
        return self._declare("parameters", name, self._own(value))

    def state(
        self,
        name: str,
        initial: Operand,
        *,
        lower: Operand = None,
        upper: Operand = None,
        unit: str | None = None,
        label: str | None = None,
    ) -> Expression:
        """A state with its initial value; bounds matter to optimisation only. `unit` and `label` are for axes."""
        return self._declare("states", name, self._bounded(initial, lower, upper, _given({"unit": unit, "label": label})))

    def states(self, name: str, initial: typing.Sequence[Operand]) -> _array.Array:
        """Several states as an array, NAME1, NAME2, …, with a list of initial values.

        >>> saltus.Builder("m").states("x", [1, 0, 0])
        Array([x1, x2, x3], dtype=object)
        """
        return _array.array([self.state(f"{name}{i + 1}", value) for i, value in enumerate(initial)])

    def control(self, name: str, initial: Operand = 0, *, lower: Operand = None, upper: Operand = None) -> Expression:
        """A control, constant unless it has an :meth:`input`."""
        return self._declare("controls", name, self._bounded(initial, lower, upper))

    def define(self, name: str, value: Operand) -> Expression:
        """A name for an expression."""
        return self._declare("definitions", name, self._own(value))

    def switching(self, name: str, psi: Operand) -> Expression:
        """A name for a switching function: that of its column in results, and of psi in expressions."""
        return self._declare("switching", name, self._own(psi))

    def table(
        self, name: str, x: typing.Sequence[float], y: typing.Sequence[float], kind: str = "linear"
    ) -> typing.Callable[[Operand], Expression]:
        """A function through points, "linear" or "cubic" between them, constant outside.

        >>> m = saltus.Builder("m")
        >>> road = m.table("road", [0, 1, 2], [0, 0.1, 0])
        >>> road(m.state("s", 0))
        road(s)
        """
        self._declare("tables", name, {"x": [float(v) for v in x], "y": [float(v) for v in y], "kind": kind})

        def value(argument: Operand) -> Expression:
            made = self._own(argument)
            return Expression(f"{name}({made.text})", owner=self)

        return value

    # What happens --------------------------------------------------------------------------------------------------

    def rate(self, state: Expression | str | Entries, value: Operand) -> None:
        """The derivative of a state with respect to time; once for every state. Of an array entry by entry.

        >>> m = saltus.Builder("chain")
        >>> X = m.states("x", [1, 0, 0])
        >>> m.rate(X, np.roll(X, 1) - X)
        >>> m.simulate(until=1).final["x3"] > 0.1
        True
        """
        if isinstance(state, (np.ndarray, list, tuple)):
            states, values = _array.array(state), _array.array(value)
            if values.shape not in ((), states.shape):
                raise refuse(f"rates of shape {values.shape} for states of shape {states.shape}", "one for every state")
            for one, its in zip(states.flat, np.broadcast_to(values, states.shape).flat):
                self.rate(one, its)
            return
        name = self._state(state)
        if name in self._parts["dynamics"]:
            raise refuse(f"the state '{name}' has two rates", "add them: m.rate(x, a + b)")
        self._parts["dynamics"][name] = self._own(value)

    def output(self, name: str, value: Operand) -> None:
        """A quantity that results have beside the states."""
        self._declare("outputs", name, self._own(value))

    def input(self, control: Expression | str, value: Operand) -> None:
        """A control during simulations, an expression of time and parameters."""
        self._inputs[self._name_in("controls", control)] = self._own(value)

    def event(
        self, when: Expression, *, name: str | None = None, direction: str | None = None, stop: bool = False
    ) -> None:
        """Records the zeros of an expression, or the edges of a condition; `direction` is "up", "down" or "both"."""
        entry = {"when": self._own(when), "name": name, "direction": direction, "stop": stop or None}
        self._events.append(_given(entry))

    def mode(self, when: Expression, rates: Rates, *, group: str | None = None) -> None:
        """Rates that hold, added to others, where a condition does; the modes of a group cover everything once."""
        self._modes.append(_given({"when": self._own(when), "group": group, "dynamics": self._rates(rates)}))

    def otherwise(self, rates: Rates, *, group: str | None = None) -> None:
        """The mode that holds where no other one of its group does."""
        self._modes.append(_given({"when": "otherwise", "group": group, "dynamics": self._rates(rates)}))

    def region(
        self, indicator: Operand, rates: Rates, *, name: str | None = None, group: str | None = None
    ) -> None:
        """A mode that holds where its indicator is the smallest one of its group."""
        entry = {"name": name, "indicator": self._own(indicator), "group": group, "dynamics": self._rates(rates)}
        self._modes.append(_given(entry))

    def jump(
        self,
        when: Expression | None = None,
        set: Rates = {},
        *,
        direction: str | None = None,
        at: typing.Sequence[Operand] | None = None,
        every: Operand = None,
        name: str | None = None,
        at_start: bool = False,
        priority: Operand = None,
        delay: Operand = None,
        persistent: bool = True,
        values: str | None = None,
    ) -> None:
        """Gives states new values, all at once: when a condition becomes true, when an expression passes 0 in a
        `direction`, `at` given times, or `every` so often. All keys: docs/model-file.md."""
        entry = {
            "when": None if when is None else self._own(when),
            "direction": direction,
            "at": None if at is None else [self._own(time) for time in at],
            "every": None if every is None else self._own(every),
            "set": self._rates(set),
            "name": name,
            "at_start": at_start or None,
            "priority": None if priority is None else self._own(priority),
            "delay": None if delay is None else self._own(delay),
            "persistent": None if persistent else False,
            "values": values,
        }
        self._jumps.append(_given(entry))

    def hysteresis(
        self, name: str, input: Operand, *, on: Operand, off: Operand, initial: Operand = None
    ) -> Expression:
        """A name that is 0 or 1: it becomes 1 where `input` rises through `on`, and 0 where it falls through `off`.

        >>> m = saltus.Builder("room")
        >>> T = m.state("T", 15)
        >>> heats = m.hysteresis("heats", -T, on=-18, off=-20, initial=1)
        >>> m.rate(T, 10*heats - 0.1*T)
        >>> len(m.simulate(until=10).events) > 5
        True
        """
        self._take(name)
        entry = {"name": name, "input": input, "on": on, "off": off, "initial": initial}
        self._hysteresis.append({key: value if key == "name" else self._own(value) for key, value in _given(entry).items()})
        return Expression(name, owner=self)

    def mechanics(
        self,
        positions: typing.Sequence[Expression | str],
        velocities: typing.Sequence[Expression | str],
        *,
        mass: typing.Sequence[typing.Sequence[Operand]] | None = None,
        force: Rates | None = None,
        potential: Operand = None,
        coriolis: str | None = None,
    ) -> None:
        """Moves positions and velocities by M(q) v' = force - grad potential; `force` by velocity. Without `mass` M is
        the identity; ``coriolis="auto"`` adds the terms of a mass matrix that depends on positions.

        >>> m = saltus.Builder("ball")
        >>> y, v = m.state("y", 1), m.state("v", 0)
        >>> m.mechanics([y], [v], force={v: -9.81})
        >>> m.contact("ground", gap=y, restitution=0.5)
        >>> m.simulate(until=0.5).events[0]
        <impact of ground at t = 0.451523641>
        """
        if self._mechanics:
            raise refuse("the mechanics are stated twice", "state all positions and velocities at once")
        entry = {
            "positions": [self._state(name) for name in positions],
            "velocities": [self._state(name) for name in velocities],
            "mass": None if mass is None else [[self._own(value) for value in row] for row in mass],
            "force": None if force is None else self._rates(force),
            "potential": None if potential is None else self._own(potential),
            "coriolis": coriolis,
        }
        self._mechanics = _given(entry)

    def contact(
        self,
        name: str,
        gap: Operand,
        *,
        tangent: Rates | None = None,
        tangents: collections.abc.Sequence[Rates] | None = None,
        friction: Operand = None,
        restitution: Operand = None,
    ) -> None:
        """Bodies that touch where `gap` is 0.

        `tangent` has the coefficients of velocities by position; in space there are two of them, `tangents`.
        """
        self._take(name)
        entry = {
            "name": name,
            "gap": self._own(gap),
            "tangent": None if tangent is None else self._rates(tangent),
            "tangents": None if tangents is None else [self._rates(one) for one in tangents],
            "friction": None if friction is None else self._own(friction),
            "restitution": None if restitution is None else self._own(restitution),
        }
        self._contacts.append(_given(entry))

    def optimal_control(self, **problem: typing.Any) -> None:
        """What is to be optimised, with the keys of [optimize]: expressions, conditions, lists and dicts of them.

        >>> m = saltus.Builder("car")
        >>> q, v, u = m.state("q", 0), m.state("v", 0), m.control("u", lower=-1, upper=1)
        >>> m.rate(q, v)
        >>> m.rate(v, u)
        >>> m.optimal_control(
        ...     horizon={"free": True, "initial": 2.5, "lower": 1, "upper": 5}, minimize_time=True, control_intervals=4,
        ...     terminal_constraints=[q == 1, v == 0],
        ... )
        >>> round(m.optimize().optimization["objective"], 6)
        2.0
        """
        if self._optimize:
            raise refuse("the problem of optimal control is stated twice", "state all of its keys at once")
        if not problem:
            raise refuse("the problem of optimal control has no keys", "e.g. horizon=1, objective=x**2")
        self._optimize = {name: self._own_all(value) for name, value in problem.items()}

    # What becomes of it --------------------------------------------------------------------------------------------

    def to_toml(self) -> str:
        """The model file that states the same."""
        parts = [f"[model]\n{_lines(self._model)}"]
        for part in ("parameters", "states", "controls", "definitions", "switching", "dynamics"):
            if self._parts[part]:
                parts.append(f"[{part}]\n{_lines(self._parts[part])}")
        if self._mechanics:
            parts.append(f"[mechanics]\n{_lines(self._mechanics)}")
        lists = {
            "contacts": self._contacts,
            "hysteresis": self._hysteresis,
            "modes": self._modes,
            "jumps": self._jumps,
            "events": self._events,
        }
        for part, entries in lists.items():
            parts.extend(f"[[{part}]]\n{_lines(entry)}" for entry in entries)
        if self._parts["outputs"]:
            parts.append(f"[outputs]\n{_lines(self._parts['outputs'])}")
        parts.extend(f"[tables.{name}]\n{_lines(table)}" for name, table in self._parts["tables"].items())
        if self._inputs:
            parts.append(f"[simulate]\n{_lines({'inputs': self._inputs})}")
        if self._optimize:
            parts.append(f"[optimize]\n{_lines(self._optimize)}")
        return "\n".join(parts)

    def model(self) -> Model:
        """The model, to be simulated. Raises :class:`ModelError` for what is missing."""
        moved = {name for entry in self._modes for name in entry["dynamics"]}
        moved.update(self._mechanics.get("positions", []), self._mechanics.get("velocities", []))
        for name in self._parts["states"]:
            if name not in self._parts["dynamics"] and name not in moved:
                raise refuse(f"the state '{name}' has no rate", f"state it: m.rate({name}, …)")
        return Model.from_text(self.to_toml(), f"<{self.name}>")

    def simulate(self, until: float | None = None, **options: typing.Any) -> Result:
        """:meth:`Model.simulate` of :meth:`model`."""
        return self.model().simulate(until, **options)

    def optimize(self, **options: typing.Any) -> Result:
        """:meth:`Model.optimize` of :meth:`model`, whose problem is :meth:`optimal_control`."""
        if not self._optimize:
            raise refuse("no problem of optimal control is stated", "state it: m.optimal_control(horizon=…, …)")
        return self.model().optimize(**options)

    def sweep(self, **arguments: typing.Any) -> Sweep:
        """:meth:`Model.sweep` of :meth:`model`."""
        return self.model().sweep(**arguments)

    def compare(self, until: float | None = None, **options: typing.Any) -> Result:
        """:meth:`Model.compare` of :meth:`model`."""
        return self.model().compare(until, **options)

    def order(self, until: float | None = None, **options: typing.Any) -> Result:
        """:meth:`Model.order` of :meth:`model`."""
        return self.model().order(until, **options)

    def check(self) -> str:
        """:meth:`Model.check` of :meth:`model`."""
        return self.model().check()

    def _repr_html_(self) -> str:
        return self.model()._repr_html_()

    # Checks --------------------------------------------------------------------------------------------------------

    def _take(self, name: str) -> None:
        if not isinstance(name, str) or not name.isidentifier() or not name.isascii():
            raise refuse(f"{name!r} is no name", "letters, digits and _, with a letter first: \"x1\"")
        if name in self._taken:
            raise refuse(f"the name '{name}' is taken", "every name of a model is declared once")
        self._taken.add(name)

    def _declare(self, part: str, name: str, value: typing.Any) -> Expression:
        if part != "outputs":
            self._take(name)
        self._taken.add(name)
        self._parts[part][name] = value
        return Expression(name, owner=self)

    def _own(self, value: Operand) -> Expression:
        made = expression(value)
        owner_of(Expression("", owner=self), made)
        return made

    def _bounded(
        self, initial: Operand, lower: Operand, upper: Operand, words: typing.Mapping[str, str] = {}
    ) -> typing.Any:
        if lower is None and upper is None and not words:
            return self._own(initial)
        given = _given({"initial": initial, "lower": lower, "upper": upper})
        return {**{name: self._own(value) for name, value in given.items()}, **words}

    def _own_all(self, value: typing.Any) -> typing.Any:
        if isinstance(value, typing.Mapping):
            return {name: self._own_all(entry) for name, entry in value.items()}
        if isinstance(value, (list, tuple)):
            return [self._own_all(entry) for entry in value]
        return self._own(value) if isinstance(value, Expression) else value

    def _name_in(self, part: str, name: Expression | str) -> str:
        text = name.text if isinstance(name, Expression) else name
        if isinstance(name, Expression):
            self._own(name)
        if text not in self._parts[part]:
            known = ", ".join(self._parts[part]) or "none"
            raise refuse(f"'{text}' is none of the {part} of this builder", f"known: {known}")
        return text

    def _state(self, state: Expression | str) -> str:
        return self._name_in("states", state)

    def _rates(self, rates: Rates) -> dict[str, Expression]:
        return {self._state(state): self._own(value) for state, value in rates.items()}

    def __repr__(self) -> str:
        return f"<saltus.Builder {self.name!r}: {', '.join(self._parts['states'])}>"


def _given(entries: dict[str, typing.Any]) -> dict[str, typing.Any]:
    return {name: value for name, value in entries.items() if value is not None}


def _lines(entries: typing.Mapping[str, typing.Any]) -> str:
    return "".join(f"{name} = {_toml(value)}\n" for name, value in entries.items())


def _toml(value: typing.Any) -> str:
    if isinstance(value, Expression):
        return json.dumps(value.text, ensure_ascii=False)
    if isinstance(value, typing.Mapping):
        return "{ " + ", ".join(f"{name} = {_toml(entry)}" for name, entry in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(entry) for entry in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    return json.dumps(str(value), ensure_ascii=False)
