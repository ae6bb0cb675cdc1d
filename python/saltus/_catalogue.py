"""The shipped models, and methods of models as functions."""

from __future__ import annotations

import typing

from . import _core
from ._model import Model
from ._result import Result
from ._settings import Settings
from ._signature import with_options

if typing.TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import OrderOptions, SimulateOptions


def models() -> list[str]:
    """Names of the shipped models.

    >>> "stick-slip" in saltus.models()
    True
    """
    return _core.models()


def catalogue(name: str, **sizes: int) -> Model:
    """A shipped model; of one that there is in any size, with the numbers of its parts.

    >>> saltus.catalogue("stick-slip")
    <saltus.Model 'stick-slip'>
    >>> saltus.catalogue("spring-block", blocks=100)
    <saltus.Model 'spring-block-100'>
    """
    text = _core.sized_model(name, sizes)
    if text is not None:
        return Model.from_text(text, f"{name}.toml")
    if sizes:
        raise TypeError(f"{name!r} has one size; values are changed where it is run: simulate(set={{...}})")
    return Model(_core.find_catalogue(name))


@with_options("simulate")
def compare(
    model: Model, until: float | None = None, *, set: Settings | None = None, **options: Unpack[SimulateOptions]
) -> Result:
    """:meth:`Model.compare` as a function.

    >>> saltus.compare(saltus.catalogue("stick-slip"), until=1).comparison["runs"][0]["method"]
    'event'
    """
    return _stated(model).compare(until, set=set, **options)


@with_options("simulate")
def order(
    model: Model,
    until: float | None = None,
    *,
    schemes: typing.Iterable[tuple[str, int]] = (),
    steps: typing.Iterable[int] = (),
    set: Settings | None = None,
    **options: Unpack[OrderOptions],
) -> Result:
    """:meth:`Model.order` as a function.

    >>> study = saltus.order(saltus.catalogue("stick-slip"), until=1, schemes=[("radau_iia", 2)], steps=[10, 20])
    >>> study.order["series"][0]["stages"]
    2
    """
    return _stated(model).order(until, schemes=schemes, steps=steps, set=set, **options)


def _stated(model: typing.Any) -> Model:
    if isinstance(model, str):
        raise TypeError(f'expected a model, found the text {model!r}; write saltus.catalogue("{model}") for a shipped one')
    return typing.cast(Model, model)
