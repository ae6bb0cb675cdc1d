"""Models stated in Python."""

from __future__ import annotations

import collections.abc
import functools
import html
import typing

import numpy as np

from . import _array
from ._entries import input_entry, one_of, points
from ._errors import ModelError
from ._expression import Expression, Operand, called, number, refuse
from ._model import Model, Start
from ._names import entries
from ._result import Result
from ._settings import Settings, has_times, is_result, states_the_problem
from ._signature import with_options
from ._statement import Rates, given
from ._structure import Structure
from ._sweep import Sweep

if typing.TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import OptimizeOptions, SweepCall

#: What the names of an array begin with, or these names.
Names = typing.Union[str, collections.abc.Sequence[str]]
Entries = typing.Union[np.ndarray[typing.Any, typing.Any], list[typing.Any], tuple[typing.Any, ...]]


Arguments = typing.ParamSpec("Arguments")
Returned = typing.TypeVar("Returned")


def of_model(
    method: typing.Callable[typing.Concatenate[Model, Arguments], Returned],
) -> typing.Callable[typing.Concatenate[Builder, Arguments], Returned]:
    """The method of the model that a builder states."""

    @functools.wraps(method)
    def of_builder(self: Builder, *arguments: Arguments.args, **keywords: Arguments.kwargs) -> Returned:
        model = self.model()
        self._need_end(arguments[0] if arguments else keywords.get("until"), keywords)
        return method(model, *arguments, **keywords)

    return typing.cast(typing.Any, of_builder)  # type: ignore[no-any-return]


class Builder(Structure):
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
        super().__init__(name, description, inclusion)

    # Names ---------------------------------------------------------------------------------------------------------

    def parameter(
        self,
        name: str,
        value: Operand,
        *,
        lower: Operand = None,
        upper: Operand = None,
        free: bool = False,
        unit: str | None = None,
        label: str | None = None,
    ) -> Expression:
        """A constant that ``set`` may change; a `free` one is chosen by :meth:`optimize` within its bounds. `unit` and
        `label` are shown in tables and pictures.

        >>> m = saltus.Builder("decay")
        >>> k = m.parameter("k", 2, unit="1/s")
        >>> x = m.state("x", 1)
        >>> m.rate(x, -k*x)
        >>> m.simulate(until=1, set={"k": 0}).final["x"]
        1.0
        """
        beside = {"lower": lower, "upper": upper, "free": free or None, "unit": unit, "label": label}
        return self._declare("parameters", name, self._value("initial", value, beside))

    def state(
        self,
        name: str,
        initial: Operand,
        *,
        lower: Operand = None,
        upper: Operand = None,
        free: bool = False,
        unit: str | None = None,
        label: str | None = None,
    ) -> Expression:
        """A state with its initial value. Bounds, and an initial value that is `free`, matter to :meth:`optimize` only;
        `unit` and `label` are shown in tables and pictures.

        >>> m = saltus.Builder("fall")
        >>> h = m.state("h", 10, unit="m", label="height")
        >>> m.rate(h, -1)
        >>> m.simulate(until=4).final["h"]
        6.0
        """
        beside = {"lower": lower, "upper": upper, "free": free or None, "unit": unit, "label": label}
        return self._declare("states", name, self._value("initial", initial, beside))

    def states(self, name: Names, initial: typing.Any, **beside: typing.Any) -> _array.Array:
        """Several states as an array of the shape of the initial values: NAME1, NAME2, …; of two axes NAME1_1, NAME1_2, …;
        or with names of their own, a list of them.

        What is given beside them, as to :meth:`state`, is one value for all of them, or an array. Results know the array,
        too: ``r["x"]``, ``r.final["x"]``, ``r.plot(["x"])``, ``set={"x": [1, 0, 0]}``.

        >>> saltus.Builder("m").states("x", [1, 0, 0])
        Array([x1, x2, x3], dtype=object)
        >>> x, z = saltus.Builder("m").states(["x", "z"], [0, 1])
        >>> x + z
        x+z
        >>> saltus.Builder("m").states("T", np.zeros((2, 2)), unit="K")
        Array([[T1_1, T1_2],
               [T2_1, T2_2]], dtype=object)
        """
        return self._array(self.state, name, initial, beside, "initial values", "[0] * 3")

    def parameters(self, name: Names, values: typing.Any, **beside: typing.Any) -> _array.Array:
        """Several parameters as an array, named as :meth:`states` are.

        >>> m = saltus.Builder("m")
        >>> k = m.parameters("k", [1, 2])
        >>> k @ m.states("x", [1, 0])
        k1*x1+k2*x2
        """
        return self._array(self.parameter, name, values, beside, "values", "[1, 2]")

    def controls(self, name: Names, initial: typing.Any, **beside: typing.Any) -> _array.Array:
        """Several controls as an array, named as :meth:`states` are.

        >>> saltus.Builder("m").controls("u", [0, 0], lower=-1, upper=[1, 2])
        Array([u1, u2], dtype=object)
        """
        return self._array(self.control, name, initial, beside, "initial values", "[0] * 3")

    def _array(
        self,
        declare: typing.Callable[..., Expression],
        name: Names,
        values: typing.Any,
        beside: dict[str, typing.Any],
        what: str,
        example: str,
    ) -> _array.Array:
        if not isinstance(name, str) and np.shape(values) == ():
            values = [values] * len(name)
        shape = np.shape(values)
        if not isinstance(name, str) and shape != (len(name),):
            raise refuse(f"{len(name)} names and {what} of shape {shape}", "one value for each name, or one for all of them")
        if len(shape) not in (1, 2) or 0 in shape:
            raise refuse(
                f"{values!r} is no list of {what}, nor an array of one or two axes", f'm.{declare.__name__}s("{name}", {example})'
            )
        given = np.array(values, dtype=object)
        try:
            more = {key: np.broadcast_to(np.array(value, dtype=object), shape) for key, value in beside.items()}
        except ValueError:
            wrong = next(key for key, value in beside.items() if np.shape(value) not in ((), shape))
            raise refuse(f"{wrong} has the shape {np.shape(beside[wrong])}", f"expected one value, or the shape {shape}") from None
        made = np.empty(shape, dtype=object)
        names = entries(name, shape) if isinstance(name, str) else np.array(name, dtype=object)
        with self._all_or_nothing():
            for place in np.ndindex(*shape):
                of_one = {key: value[place] for key, value in more.items()}
                made[place] = declare(names[place], given[place], **of_one)
        return made.view(_array.Array)

    def control(
        self,
        name: str,
        initial: Operand = 0,
        *,
        lower: Operand = None,
        upper: Operand = None,
        unit: str | None = None,
        label: str | None = None,
    ) -> Expression:
        """A control: constant in simulations unless it has an :meth:`input`, chosen by :meth:`optimize`.

        >>> m = saltus.Builder("cart")
        >>> x, u = m.state("x", 0), m.control("u", 1, lower=-1, upper=1)
        >>> m.rate(x, u)
        >>> m.simulate(until=2, set={"u": 0.5})["u"][0].item()
        0.5
        """
        beside = {"lower": lower, "upper": upper, "unit": unit, "label": label}
        return self._declare("controls", name, self._value("initial", initial, beside))

    def define(self, name: str, value: Operand) -> Expression:
        """A name for an expression.

        >>> m = saltus.Builder("m")
        >>> x = m.state("x", 1)
        >>> force = m.define("force", -2*x)
        >>> force + 1
        force+1
        """
        return self._declare("definitions", name, self._own(value))

    def switching(self, name: str, psi: Operand) -> Expression:
        """A name for a switching function: that of its column in results, and of psi in expressions.

        >>> m = saltus.Builder("relay")
        >>> x = m.state("x", 1)
        >>> error = m.switching("error", x - 0.5)
        >>> m.rate(x, -saltus.sign(error))
        >>> m.simulate(until=1).events[0]
        <enter_sliding of error at t = 0.5>
        """
        return self._declare("switching", name, self._own(psi))

    def table(
        self,
        name: str,
        x: typing.Any = None,
        y: typing.Any = None,
        kind: str = "linear",
        *,
        file: str | None = None,
    ) -> typing.Callable[[Operand], typing.Any]:
        """A function through points, "linear" or "cubic" between them, constant outside. The points are two lists,
        one array or DataFrame of two columns, or those of a `file`.

        >>> m = saltus.Builder("m")
        >>> road = m.table("road", [0, 1, 2], [0, 0.1, 0])
        >>> road(m.state("s", 0))
        road(s)
        """
        if (file is None) == (x is None) or x is None and y is not None:
            raise refuse(f"the points of the table '{name}' are not clear", 'give x and y, or file="points.csv"')
        one_of("kind", kind, "linear", "cubic")
        stated = {"file": file} if file is not None else points(name, x, y, kind)
        self._declare("tables", name, {**stated, "kind": kind})

        def value(argument: Operand) -> typing.Any:
            if isinstance(argument, np.ndarray) and argument.ndim > 0:
                return _array.own(np.frompyfunc(value, 1, 1)(argument))
            made = called(name, self._own(number(argument)))
            made.owner = self
            return made

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
                column = values.ndim == 2 and states.ndim == 1 and states.size in values.shape
                remedy = "one for every state" + "; of a column B, an array of two axes, write B[:, 0]*u" * column
                raise refuse(f"rates of shape {values.shape} for states of shape {states.shape}", remedy)
            with self._all_or_nothing():
                for one, its in zip(states.flat, np.broadcast_to(values, states.shape).flat):
                    self.rate(one, its)
            return
        name = self._state(state)
        if name in self._parts["dynamics"]:
            raise refuse(f"the state '{name}' has two rates", "add them: m.rate(x, a + b)")
        self._parts["dynamics"][name] = self._own(number(value))

    def output(
        self, name: str | Expression, value: Operand = None, *, unit: str | None = None, label: str | None = None
    ) -> None:
        """A quantity that results have beside the states; without a value one that is defined, under its name.

        >>> m = saltus.Builder("fall")
        >>> h, v = m.state("h", 10), m.state("v", 0)
        >>> m.rate(h, v)
        >>> m.rate(v, -9.81)
        >>> m.output("energy", 9.81*h + v**2/2, unit="J")
        >>> r = m.simulate(until=1)
        >>> bool(abs(r["energy"][-1] - r["energy"][0]) < 1e-9)
        True
        """
        if isinstance(name, Expression):
            name = self._name_in("definitions", name)
        value = Expression(name, owner=self) if value is None else value
        self._declare("outputs", name, self._value("value", value, {"unit": unit, "label": label}))

    def input(self, control: Expression | str, value: Operand) -> None:
        """A control during simulations: an expression of time and parameters; or piecewise constant data, ``(times, values)``,
        a DataFrame, an earlier result, or a file, ``{"file": "u.csv"}``, whose columns are t and the control.

        >>> m = saltus.Builder("cart")
        >>> x, u = m.state("x", 0), m.control("u")
        >>> m.rate(x, u)
        >>> m.input(u, 2*saltus.t)
        >>> round(m.simulate(until=3).final["x"], 6)
        9.0
        """
        name = self._name_in("controls", control)
        if name in self._inputs:
            raise refuse(f"the control '{name}' has two inputs", "add them: m.input(u, a + b)")
        self._inputs[name] = input_entry(name, value, self._own)

    def event(
        self, when: Expression, *, name: str | None = None, direction: str | None = None, stop: bool = False
    ) -> None:
        """Records the zeros of an expression, or the edges of a condition; `direction` is "up", "down" or "both". With
        `stop` the run ends there.

        >>> m = saltus.Builder("fall")
        >>> h = m.state("h", 10)
        >>> m.rate(h, -2)
        >>> m.event(h - 4, name="low", direction="down", stop=True)
        >>> r = m.simulate(until=10)
        >>> r.status, r.events[0]
        ('stopped_by_event', <user of low at t = 3>)
        """
        one_of("direction", direction, "up", "down", "both")
        entry = {"when": self._own(when), "name": self._named(name), "direction": direction, "stop": stop or None}
        self._lists["events"].append(given(entry))

    def mode(self, when: Expression, rates: Rates, *, group: str | None = None) -> None:
        """Rates that hold, added to others, where a condition does; the modes of a group cover everything once.

        >>> m = saltus.Builder("relay")
        >>> x = m.state("x", 1)
        >>> m.mode(x > 0.5, {x: -1})
        >>> m.otherwise({x: 2})
        >>> m.simulate(until=1).final["x"]
        0.5
        """
        self._lists["modes"].append(given({"when": self._own(when), "group": group, "dynamics": self._rates(rates)}))

    def otherwise(self, rates: Rates, *, group: str | None = None) -> None:
        """The mode that holds where no other one of its group does.

        >>> m = saltus.Builder("gene")
        >>> a, b = m.state("a", 0.2), m.state("b", 0.9)
        >>> m.mode((a > 0.5) & (b > 0.5), {a: -a, b: -b})
        >>> m.otherwise({a: 1 - a, b: 1 - b})
        >>> round(m.simulate(until=5).final["a"], 6)
        0.5
        """
        self._lists["modes"].append(given({"when": "otherwise", "group": group, "dynamics": self._rates(rates)}))

    def region(
        self, indicator: Operand, rates: Rates, *, name: str | None = None, group: str | None = None
    ) -> None:
        """A mode that holds where its indicator is the smallest one of its group.

        >>> m = saltus.Builder("nearest")
        >>> x = m.state("x", 0.2)
        >>> m.region((x - 1)**2, {x: 1}, name="right")
        >>> m.region((x + 1)**2, {x: -1}, name="left")
        >>> m.simulate(until=1).final.regions
        [['right']]
        """
        entry = {"name": name, "indicator": self._own(indicator), "group": group, "dynamics": self._rates(rates)}
        self._lists["modes"].append(given(entry))

    # What becomes of it --------------------------------------------------------------------------------------------

    def model(self) -> Model:
        """The model, to be simulated. Raises :class:`ModelError` for what is missing.

        >>> m = saltus.Builder("decay")
        >>> x = m.state("x", 1)
        >>> m.rate(x, -x)
        >>> m.model()
        <saltus.Model 'decay'>
        """
        if not self._parts["states"] and not self._lists["jumps"]:
            raise refuse("the model has no states", 'state one: x = m.state("x", 0), and its rate: m.rate(x, -x)')
        moved = {name for entry in self._lists["modes"] for name in entry["dynamics"]}
        moved.update(self._mechanics.get("positions", []), self._mechanics.get("velocities", []))
        for name in self._parts["states"]:
            if name not in self._parts["dynamics"] and name not in moved:
                raise refuse(f"the state '{name}' has no rate", f"state it: m.rate({name}, …)")
        return Model.from_text(self.to_toml(), f"<{self.name}>")

    simulate = of_model(Model.simulate)
    compare = of_model(Model.compare)
    order = of_model(Model.order)

    @typing.overload
    def sweep(self, over: Settings | None = None, **keywords: Unpack[SweepCall]) -> Sweep: ...
    @typing.overload
    def sweep(self, over: Settings | None = None, **keywords: typing.Any) -> Sweep: ...
    @functools.wraps(Model.sweep)
    def sweep(self, over: Settings | None = None, **keywords: typing.Any) -> Sweep:
        return self.model().sweep(over, **keywords)

    @with_options("optimize")
    def optimize(
        self,
        *,
        set: Settings | None = None,
        start: Start | None = None,
        progress: bool = False,
        **options: Unpack[OptimizeOptions],
    ) -> Result:
        """:meth:`Model.optimize` of :meth:`model`. What is to be optimised is said here, or by :meth:`optimal_control`.

        >>> m = saltus.Builder("car")
        >>> q, u = m.state("q", 0), m.control("u", lower=-1, upper=1)
        >>> m.rate(q, u)
        >>> m.optimal_control(horizon=2, running_cost=u**2, control_intervals=4)
        >>> m.optimize(terminal_constraints=[q == 1]).u[:, 0].round(6).tolist()[0]
        0.5
        """
        known = {*self._parts["states"], *self._parts["parameters"]}
        stated: dict[str, typing.Any] = {**options}
        problem = {
            name: stated.pop(name)
            for name in list(stated)
            if states_the_problem(name) and name not in known and not is_result(stated[name])
        }
        if not self._optimize and not problem:
            raise refuse("no problem of optimal control is stated", "state it: m.optimal_control(horizon=…, …)")
        before = self._optimize
        self._optimize = {**before, **self._problem(problem)}
        try:
            model = self.model()
        finally:
            self._optimize = before
        return model.optimize(set=set, start=start, progress=progress, **stated)

    def check(self) -> str:
        """:meth:`Model.check` of :meth:`model`.

        >>> m = saltus.Builder("decay")
        >>> x = m.state("x", 1)
        >>> m.rate(x, -x)
        >>> "x' = -x" in m.check()
        True
        """
        return self.model().check()

    def _need_end(self, until: object, options: typing.Mapping[str, typing.Any]) -> None:
        if until is None and not has_times(options) and "until" not in self._simulate and "simulate.until" not in (options.get("set") or {}):
            raise refuse("no end time", "say how long: m.simulate(until=10), or m.simulation(until=10) for all runs")

    def _repr_html_(self) -> str:
        try:
            return self.model()._repr_html_()
        except ModelError as error:
            # In a notebook a builder is looked at before it is complete.
            return f"<div>{html.escape(repr(self))}<br>not yet a model: {html.escape(error.message)}</div>"
