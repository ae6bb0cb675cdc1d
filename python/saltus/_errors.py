"""Exceptions and warnings, and packages that are wanted for a part of this one only."""

from __future__ import annotations

import importlib
import sys
import typing
import warnings

from . import _core
from ._spelling import at_option, in_python, is_option, keywords

class ModelError(ValueError):
    """Bad input: a model, a setting or an option that states nothing, with its place and a remedy.

    The text is that of the tool, with its options spelt as keywords. ``message`` says what was expected and found,
    ``remedy`` what to do, ``file``, ``line`` and ``column`` where (counted from 1; 0 or empty: unknown), ``code`` which
    kind of mistake it is.

    >>> import saltus
    >>> try:
    ...     saltus.Model.from_text('[model]\\nname = "m"\\n[states]\\nx = "1 +"\\n', "m.toml")
    ... except saltus.ModelError as error:
    ...     print(error.line, error.column)
    4 9
    """

    def __init__(
        self,
        text: str,
        message: str = "",
        remedy: str = "",
        file: str = "",
        line: int = 0,
        column: int = 0,
        code: str = "",
    ) -> None:
        if is_option(file):
            text, file, line, column = at_option(text, file), "", 0, 0
        text, message, remedy = in_python(text.removeprefix("error: ")), in_python(message), in_python(remedy)
        if not file:
            text, message, remedy = keywords(text), keywords(message), keywords(remedy)
        super().__init__(text, message, remedy, file, line, column, code)
        self.message = message or text
        self.remedy = remedy
        self.file = file
        self.line = line
        self.column = column
        self.code = code

    def __str__(self) -> str:
        return str(self.args[0])


class ModelWarning(UserWarning):
    """What the tool prints as a warning: unused names, options without effect.

    >>> import saltus, warnings
    >>> with warnings.catch_warnings(record=True) as warned:
    ...     warnings.simplefilter("always")
    ...     r = saltus.catalogue("stick-slip").simulate(until=1, epsilon=0.1)
    >>> warned[0].category.__name__
    'ModelWarning'
    """


def warn(messages: typing.Iterable[str]) -> None:
    """Warns where the package was called, however deep that is."""
    depth, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("saltus"):
        depth, frame = depth + 1, frame.f_back
    for message in _core.told_together(list(messages)):
        warnings.warn(in_python(message), ModelWarning, stacklevel=depth)


_PACKAGES = {"plot": "matplotlib", "data": "pandas xarray pyarrow"}  #: of the extras of this package


def needed(package: str, extra: str) -> typing.Any:
    """The package, or what to install."""
    try:
        return importlib.import_module(package)
    except ImportError as error:
        raise ImportError(f"this needs {package}: pip install {_PACKAGES[extra]}") from error
