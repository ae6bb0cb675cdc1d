"""How a run ended: status, end, derivatives of the end."""

from __future__ import annotations

import typing

import numpy as np

from . import _core
from ._expression import Expression
from ._names import several
from ._spelling import in_python, keywords

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]


class Status(str):
    """Why a run ended, as a text: ``"completed"``, ``"iteration_limit"``, …; with the reason and what to try.

    ``done`` says whether it did what was asked, ``time_reached`` how far it came, ``message`` the reason.

    >>> status = saltus.catalogue("stick-slip").simulate(until=5, max_steps=9).status
    >>> status, status.done, status.time_reached < 5
    ('iteration_limit', False, True)
    """

    message: str
    time_reached: float
    done: bool

    @classmethod
    def _of(cls, run: _core.Run) -> Status:
        status = cls(run.termination)
        status.message = keywords(in_python(run.message))
        status.time_reached, status.done = run.time_reached, run.done
        return status


class Final:
    """The end of a run: ``t``, ``x``, ``mode``, ``alpha``, ``outputs``, ``regions``, ``theta``, ``contact_modes``, and every value by its name, ``final["v"]``.

    >>> final = saltus.catalogue("stick-slip").simulate(until=4).final
    >>> final.t, final.mode, round(final["v"], 6)
    (4.0, [0], 0.2)
    """

    def __init__(self, run: _core.Run) -> None:
        values = run.final
        self.t: float = values["t"]
        self.x: Array = values["x"]
        self.mode: list[int] = values["mode"]
        self.alpha: Array = values["alpha"]
        self.outputs: Array = values["outputs"]
        self.regions: list[list[str]] = values["regions"]
        self.theta: Array = values["theta"]
        self.contact_modes: list[str] = values["contact_modes"]
        self._named = dict(zip(run.output_names, self.outputs.tolist()))
        self._named.update(zip(run.states, self.x.tolist()))
        self._states = dict(zip(run.states, self.x.tolist()))
        self._parameters = [parameter for parameter, _ in run.parameters]

    def __getitem__(self, name: typing.Any) -> typing.Any:
        """A state or an output by its name; of an array x1, x2, … ``"x"`` has all, and so has a pattern, ``"x*"``.

        >>> saltus.catalogue("bouncing-ball").simulate(until=1).final["y"] > 0
        True
        """
        name = name.text if isinstance(name, Expression) else name
        names = several(name, self._named)
        if names is not None:
            return np.array([self[one] for one in names.flat], dtype=float).reshape(names.shape)
        if name not in self._named:
            raise unknown(name, list(self._named), parameters=self._parameters)
        return float(self._named[name])

    def keys(self) -> list[str]:
        """Names of states and outputs, so that ``dict(r.final)`` has their values.

        >>> list(dict(saltus.catalogue("bouncing-ball").simulate(until=1).final))
        ['y', 'v']
        """
        return list(self._named)

    def states(self) -> dict[str, float]:
        """The states alone: what ``m.simulate(set=r.final)`` takes of it.

        >>> r = saltus.catalogue("welander").simulate(until=1)
        >>> list(r.final), list(r.final.states())
        (['density', 'T', 'S'], ['T', 'S'])
        """
        return dict(self._states)

    def __iter__(self) -> typing.Iterator[str]:
        return iter(self._named)

    def __len__(self) -> int:
        return len(self._named)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._named)

    def __repr__(self) -> str:
        values = ", ".join(f"{name} = {value:.6g}" for name, value in self._named.items())
        return f"<t = {self.t:.6g}: {values}>"


class Sensitivities(typing.NamedTuple):
    """Derivatives of the end state by the initial state (``x0``) and by parameters (``p``); rows are states.

    >>> m = saltus.Builder("decay")
    >>> x, k = m.state("x", 2), m.parameter("k", 1)
    >>> m.rate(x, -k*x)
    >>> found = m.simulate(until=1, method="fesd", stages=3, steps=10, sensitivities=True).sensitivities
    >>> found.x0.round(6).tolist(), found.p.round(6).tolist(), found.parameters
    ([[0.367879]], [[-0.735759]], ['k'])
    """

    x0: Array
    p: Array
    parameters: list[str]


class Intervals:
    """The controls of an optimum, constant in every interval: ``ends`` of the intervals (one more than there are),
    ``u`` (a row for every interval), and the values of one control by its name.

    >>> m = saltus.catalogue("voice-coil-time")
    >>> found = m.optimize(control_intervals=4).intervals
    >>> found.u.shape, found["u"].shape, found.ends.shape
    ((4, 1), (4,), (5,))
    """

    def __init__(self, ends: list[float], u: list[list[float]], names: list[str]) -> None:
        self.ends: Array = np.array(ends, dtype=float)
        self.u: Array = np.array(u, dtype=float).reshape(len(ends) - 1, len(names))
        self._names = names

    def __getitem__(self, name: typing.Any) -> Array:
        """The values of one control.

        >>> len(saltus.catalogue("voice-coil-time").optimize(control_intervals=4).intervals["u"])
        4
        """
        name = name.text if isinstance(name, Expression) else name
        if name not in self._names:
            raise unknown(name, self._names, "the optimum")
        return self.u[:, self._names.index(name)]

    def keys(self) -> list[str]:
        """Names of the controls.

        >>> saltus.catalogue("voice-coil-time").optimize(control_intervals=4).intervals.keys()
        ['u']
        """
        return list(self._names)

    def __repr__(self) -> str:
        return f"<{len(self.u)} intervals of {', '.join(self._names) or 'no control'}>"


class Kept(typing.NamedTuple):
    """What a sweep kept of a run ("final", "events" or "trajectory"), and how many events happened."""

    what: str
    events: int


def unknown(
    name: str, known: list[str], what: str = "the result", parameters: typing.Iterable[str] = ()
) -> KeyError:
    """A name that is not there, with those that are near."""
    if name in parameters:
        return KeyError(f"{name!r} is a parameter: r.parameters[{name!r}]")
    import difflib

    near = difflib.get_close_matches(str(name), known, 3)
    hint = f"did you mean {' or '.join(map(repr, near))}?" if near else f"known: {', '.join(known)}"
    return KeyError(f"{what} has no {name!r}; {hint}")
