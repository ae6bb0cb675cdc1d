"""The arrays of a result, and their names."""

from __future__ import annotations

import functools
import typing

import numpy as np

from . import _core
from ._expression import Expression
from ._names import several
from ._outcome import unknown

Array = np.ndarray[typing.Any, np.dtype[typing.Any]]


class Columns:
    """What a result has row by row: read-only views of what the library holds."""

    def __init__(self, run: _core.Run) -> None:
        self._run = run

    @property
    def t(self) -> Array:
        """Times of all rows, ascending; two of one value at every event.

        >>> saltus.catalogue("bouncing-ball").simulate(until=1, points=3).t.tolist()
        [0.0, 0.5, 1.0]
        """
        return self._run.t

    @property
    def x(self) -> Array:
        """States, (rows, n_x), in the order of ``states``; of a run with ``output={"states": …}`` only those.

        >>> r = saltus.catalogue("bouncing-ball").simulate(until=1, points=3)
        >>> r.x.shape, r.x[0].tolist()
        ((3, 2), [10.0, 0.0])
        """
        return self._run.x

    @property
    def u(self) -> Array:
        """Controls, (rows, n_u).

        >>> saltus.catalogue("bouncing-ball").simulate(until=1, points=3).u.shape
        (3, 0)
        """
        return self._run.u

    @property
    def alpha(self) -> Array:
        """Step selections, (rows, n_psi), in the order of ``switching_functions``; NaN where one is not determined.

        >>> bool(0 < saltus.catalogue("stick-slip").simulate(until=4).alpha[-1, 0] < 1)
        True
        """
        return self._run.alpha

    @property
    def mode(self) -> Array:
        """Signs of the switching functions, (rows, n_psi); 0 while the solution slides on the surface.

        >>> saltus.catalogue("stick-slip").simulate(until=4).mode[[0, -1], 0].tolist()
        [-1, 0]
        """
        return self._run.mode

    @property
    def outputs(self) -> Array:
        """[outputs] of the model, (rows, n_y).

        >>> r = saltus.catalogue("welander").simulate(until=1, points=3)
        >>> r.output_names, r.outputs.shape[1]
        (['density'], 1)
        """
        return self._run.outputs

    @property
    def states(self) -> list[str]:
        """Names of the states.

        >>> saltus.catalogue("stick-slip").simulate(until=1).states
        ['q', 'v']
        """
        return self._run.states

    @property
    def controls(self) -> list[str]:
        """Names of the controls.

        >>> saltus.catalogue("cart-pole").simulate(until=1).controls
        ['u']
        """
        return self._run.controls

    @property
    def switching_functions(self) -> list[str]:
        """Names of the switching functions.

        >>> saltus.catalogue("stick-slip").simulate(until=1).switching_functions
        ['slip']
        """
        return self._run.switching_functions

    @property
    def output_names(self) -> list[str]:
        """Names of the outputs.

        >>> saltus.catalogue("welander").simulate(until=1).output_names
        ['density']
        """
        return self._run.output_names

    @property
    def names(self) -> list[str]:
        """All names of columns: ``t``, states, controls, outputs, modes and selections.

        >>> saltus.catalogue("stick-slip").simulate(until=1).names
        ['t', 'q', 'v', 'mode(slip)', 'alpha(slip)']
        """
        return list(self._columns)

    def __getitem__(self, name: str | Expression | Array) -> Array:
        """A column by its name: ``"t"``, a state, a control, an output, ``"alpha(slip)"`` or ``"mode(slip)"``; also by what
        a Builder gave for it. Of an array x1, x2, … ``"x"`` has the columns of all, of the shape (rows, …); so do
        patterns, ``"x*"``.

        >>> r = saltus.catalogue("stick-slip").simulate(until=4)
        >>> r["v"][0].item(), r["mode(slip)"][-1].item()
        (-0.01, 0)
        """
        columns = self._columns
        if isinstance(name, Expression):
            name = name.text
        names = several(name, columns)
        if names is not None:
            return np.stack([self[one] for one in names.flat], axis=-1).reshape(-1, *names.shape)
        if not isinstance(name, str):
            raise TypeError(f"r[{name!r}]: a column is taken by its name, e.g. r['t']; a row of all states is r.x[i]")
        if name not in columns:
            raise unknown(name, list(columns), parameters=[parameter for parameter, _ in self._run.parameters])
        block, index = columns[name]
        found: Array = self.t if index is None else getattr(self._run, block)[:, index]
        return found

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._columns)

    @functools.cached_property
    def _columns(self) -> dict[str, tuple[str, int | None]]:
        columns: dict[str, tuple[str, int | None]] = {"t": ("t", None)}
        for block, names in (
            ("x", self._run.states_in_rows),
            ("u", self.controls),
            ("outputs", self.output_names),
            ("mode", [f"mode({name})" for name in self._run.functions_in_rows]),
            ("alpha", [f"alpha({name})" for name in self._run.functions_in_rows]),
            ("theta", [f"theta({name})" for name in self._run.regions]),
        ):
            for index, name in enumerate(names):
                columns.setdefault(name, (block, index))
        return columns
