"""Values and keywords of Python as the settings of the tool."""

from __future__ import annotations

import difflib
import math
import numbers
import os
import re
import typing

import numpy as np

from . import _core, _samples
from ._expression import Expression, refuse
from ._names import entries
from ._outcome import Final

#: What other programs call what has another name here.
_ELSEWHERE = {
    **dict.fromkeys(("t_eval", "saveat", "teval"), "times=[…], or points=100, or every=0.1"),
    **dict.fromkeys(("t_span", "tspan", "tmax", "t_end", "tend", "T"), "until=10, and from_=0 where it begins"),
    **dict.fromkeys(("y0", "x0", "u0", "args", "p", "params", "parameters"), 'set={"name": value}, of parameters and states'),
    **dict.fromkeys(("dt", "step", "stepsize"), "every=0.1 for rows, max_step=0.1 for steps"),
    **dict.fromkeys(("reltol", "tol", "RelTol"), "rtol=1e-8"),
    **dict.fromkeys(("abstol", "AbsTol"), "atol=1e-10"),
    **dict.fromkeys(("solver", "alg", "engine"), 'integrator="dopri5", or method="fesd"'),
}
#: The same of an optimisation.
_ELSEWHERE_IN_OPTIMIZE = {
    **dict.fromkeys(("intervals", "N", "n_intervals", "nodes"), "control_intervals=20"),
    **dict.fromkeys(("until", "T", "t_end", "tf", "duration"), "horizon=2; where it is chosen the model states its bounds"),
    **dict.fromkeys(("objective", "cost"), "running_cost and terminal_cost in the model"),
}
#: How a Builder states entries of a table of the model.
_STATED = {
    "events": ": b.event(x - 1, name=…)",
    "jumps": ": b.jump(x > 1, {x: 0})",
    "hysteresis": ": b.hysteresis(name, x, on=…, off=…)",
    "modes": ": b.mode(x > 0, {x: -1})",
    "contacts": ": b.contact(name, gap=…)",
}
Value = typing.Any  #: a number, a text (an expression, a word), a list of numbers, a dict of these
#: What `set` changes, by names; the end of a run are its states.
Settings = typing.Union[typing.Mapping[typing.Any, typing.Any], Final]
Option = tuple[str, str, str]
_DISTRIBUTION = re.compile(r"\s*(normal|uniform|lognormal)\s*\(")
_TABLES = ("output", "event", "smoothed", "fesd", "timestepping")
_SIMULATE = frozenset(_core.simulate_keys())
_OPTIMIZE = frozenset(_core.optimize_keys())


def text_of(value: Value, name: str = "") -> str:
    """A value as the tool reads it behind --set.

    >>> text_of(0.1), text_of(True), text_of([1, 2.5]), text_of("2*mu")
    ('0.1', 'true', '[1, 2.5]', '2*mu')
    """
    if isinstance(value, str):
        return value
    if isinstance(value, Expression):
        return value.text
    if value is None:
        return "none"
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        if not math.isfinite(value):
            raise refuse(f"{name}{'=' * bool(name)}{float(value)}: that is no number of a model", "write a finite number")
        return repr(float(value))
    if isinstance(value, np.ndarray) and value.ndim == 0:
        return text_of(value.item(), name)
    if isinstance(value, (list, tuple)) and any(isinstance(entry, typing.Mapping) for entry in value):
        table = f"[[{name}]]" if name in _STATED else "the table"
        raise refuse(
            f"{name}=[{{…}}]: a setting changes numbers of a model, it adds no tables",
            f"write {table} into the text, saltus.Model.from_text(text), or use saltus.Builder{_STATED.get(name, '')}",
        )
    if isinstance(value, np.ndarray) and value.ndim > 1:
        raise refuse(f"{name}: expected a list of values, found an array of shape {value.shape}", f"{name}=values.ravel()")
    if is_list(value) or isinstance(value, np.ndarray):
        bad = next((i for i, entry in enumerate(value) if isinstance(entry, float) and not math.isfinite(entry)), None)
        if bad is not None:
            return text_of(value[bad], f"{name}[{bad}]" if name else "")  # which refuses it
        return "[" + ", ".join(text_of(entry, name) for entry in value) + "]"
    if hasattr(value, "save"):
        raise refuse(
            f"{name}: a result is no value",
            'its end is set=r.final, all of it start=r; the values of a control are inputs={"u": r}',
        )
    if callable(value):
        raise refuse(
            f"{name}: a function of Python is called at no time of a run",
            'an expression does, "0.5*sin(t)" (if(t < 1, 0, 2) for pieces); or its values, (times, [f(t) for t in times])',
        )
    found = type(value).__name__
    raise TypeError(f"{name}{': ' * bool(name)}a number, a text or a list of numbers is expected, found {found}")


def settings_of(values: Settings | None) -> list[str]:
    """NAME=VALUE of `set`; tables inside become dotted names."""
    return [f"{name}={text_of(_one_value(name, value), name)}" for name, value in _flat(mapping_of(values))]


def entry_by_entry(values: Settings | None, declares: typing.Callable[[str], bool]) -> Settings | None:
    """The same with an array of the model as its entries: x1, x2, … for ``{"x": [1, 0]}``."""
    if not isinstance(values, typing.Mapping):
        return values
    changed: dict[typing.Any, typing.Any] = {}
    for key, value in values.items():
        shape = np.shape(value) if isinstance(value, (list, tuple, np.ndarray)) else ()
        names = entries(key, shape) if isinstance(key, str) and "." not in key and 0 < len(shape) < 3 and 0 not in shape else None
        if names is None or declares(key) or not all(declares(name) for name in names.flat):
            changed[key] = value
        else:
            changed.update(zip(names.flat, np.array(value, dtype=object).flat))
    return changed


def names_in(values: Settings | None) -> list[str]:
    """The names that `set` changes, dotted."""
    return [name for name, _ in _flat(mapping_of(values))]


def mapping_of(values: typing.Any) -> typing.Mapping[str, Value]:
    """What `set=` says, by names: of a dict, of the end of a run, of nothing."""
    if isinstance(values, Final):
        return values.states()
    if values is not None and not isinstance(values, typing.Mapping):
        raise TypeError(f'set={values!r}: expected a dict, e.g. set={{"mu": 0.5}}, or the end of a run, set=r.final')
    return values or {}


def _one_value(name: str, value: Value) -> Value:
    """What a setting can be: of a name of the model one number or expression."""
    if value is None:
        raise refuse(f"{name}=None: that is no value", f"leave {name} out, or write a number or an expression")
    if "." not in name and isinstance(value, (bool, np.bool_)):
        raise refuse(f"{name}={value}: expected a number or an expression", f"0 and 1 are numbers: {name}={int(value)}")
    if "." not in name and not isinstance(value, str) and np.ndim(value) > 0:
        shown = _shown(value, name) if np.size(value) < 10 else f"[… {np.size(value)} values]"
        raise refuse(f"{name}={shown}: expected one value", f"many values are for a sweep: m.sweep({name}=[…])")
    return value


def _flat(values: typing.Mapping[str, Value], before: str = "") -> typing.Iterator[tuple[str, Value]]:
    for key, value in values.items():
        name = key.text if isinstance(key, Expression) else key
        if not isinstance(name, str) or not name:
            raise refuse(f"{key!r} is no name of a model or option", 'names are texts: {"mu": 0.5}')
        if isinstance(value, typing.Mapping):
            yield from _flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value


def simulate_options(
    keywords: typing.Mapping[str, Value], method: str
) -> tuple[list[str], list[Option]]:
    """Settings and options of [simulate] that keywords stand for: `integrator` is event.integrator, `points` is
    output.points, `stages` is fesd.stages or, of the method timestepping, timestepping.stages."""
    keywords = {name.rstrip("_"): value for name, value in keywords.items() if value is not None}
    method = str(keywords.get("method", method))
    tables = ["output", "event", "smoothed", "timestepping" if method == "timestepping" else "fesd"]
    settings = inputs_settings(keywords.pop("inputs", None))
    options: list[Option] = []
    for name, value in _flat(keywords):
        _in_its_table(name, value)
        keys = [name] + [f"{table}.{name}" for table in tables]
        by_surface = f"event.{name}" if name.startswith("scaling.") else name
        key = next((key for key in keys if key in _SIMULATE), by_surface)
        options.append((f"simulate.{key}", text_of(value, name), f"{name}={_shown(value)}"))
    return settings, options


def has_times(options: typing.Mapping[str, Value]) -> bool:
    """Whether the times of rows are given, the last of which is an end."""
    output = options.get("output")
    return options.get("times", output.get("times") if isinstance(output, typing.Mapping) else None) is not None


def option_of(name: str, value: Value) -> Option:
    """A keyword that is the key of an option itself."""
    return name.rstrip("_"), text_of(value, name), f"{name}={_shown(value)}"


def inputs_settings(inputs: typing.Any) -> list[str]:
    """Settings of what controls are: expressions, files, data in memory, earlier results."""
    settings: list[str] = []
    for name, value in _samples.inputs_by_control({} if inputs is None else inputs).items():
        what, key = f'inputs={{"{name}": …}}', f"simulate.inputs.{name}"
        source = value.get("result") if isinstance(value, typing.Mapping) else value
        if hasattr(source, "optimization"):
            settings.append(f"{key}={sampled(*_samples.of_result(what, name, source))}")
        elif _samples.is_data(value):
            settings.append(f"{key}={sampled(*_samples.samples(what, name, value))}")
        elif isinstance(value, typing.Mapping):
            settings += [f"{key}.{kind}={text_of(path, name)}" for kind, path in value.items()]
        else:
            settings.append(f"{key}={text_of(value, name)}")
    return settings


def sampled(times: list[float], values: list[float]) -> str:
    """Samples as they stand in a model file."""
    return f"{{ times = {times}, values = {values} }}"


def _in_its_table(name: str, value: Value) -> None:
    """Refuses an option in the table of another method, and says where it belongs."""
    table, _, word = name.rpartition(".")
    if table not in _TABLES or name in _SIMULATE or name.startswith("event.scaling."):
        return
    written = f"{word}={value if isinstance(value, bool) else _shown(value)}"
    if word in _SIMULATE:
        raise refuse(f"{table} has no option '{word}'", f"it is of every method: {written}")
    homes = [home for home in _TABLES if f"{home}.{word}" in _SIMULATE]
    if homes:
        home = "the table of rows" if homes[0] == "output" else f"the method {homes[0]}"
        remedy = f'output={{"{word}": …}}' if homes[0] == "output" else f'method="{homes[0]}", {written}'
        raise refuse(f"{table} has no option '{word}'", f"'{word}' is of {home}: write {remedy}")


def check_together(keywords: typing.Mapping[str, Value]) -> None:
    """What keywords cannot be beside each other."""
    output = keywords.get("output")
    given = {**(output if isinstance(output, typing.Mapping) else {}), **keywords}
    grids = [name for name in ("every", "points", "times") if given.get(name) is not None]
    if len(grids) > 1:
        raise refuse(f"{' and '.join(grids)} say twice when there are rows", "leave one of them out")


def optimize_options(keywords: typing.Mapping[str, Value]) -> tuple[list[str], list[Option]]:
    """The same of [optimize]: `tolerance` is mpcc.tolerance. Keys of the problem itself are settings."""
    settings: list[str] = []
    options: list[Option] = []
    for name, value in _flat({name.rstrip("_"): value for name, value in keywords.items() if value is not None}):
        key = _optimize_key(name)
        if key is None and is_list(value):
            raise refuse(
                f"{name}=[…]: that states the problem, and cannot be changed from call to call",
                f"write it under [optimize] of the model; saltus.Builder takes it: b.optimize({name}=[…])",
            )
        if key is None:
            settings.append(f"optimize.{name}={text_of(value, name)}")
        else:
            options.append((f"optimize.{key}", text_of(value, name), f"{name}={_shown(value)}"))
    return settings, options


def _optimize_key(name: str) -> str | None:
    """The option of [optimize] that a keyword stands for."""
    return next((key for key in (name, f"mpcc.{name}") if key in _OPTIMIZE), None)


def states_the_problem(name: str) -> bool:
    """Whether a keyword of an optimisation says what is to be optimised, not how."""
    return _optimize_key(name.rstrip("_")) is None and name not in ("set", "start", "progress", *_ELSEWHERE_IN_OPTIMIZE)


def is_result(value: Value) -> bool:
    """Whether a keyword is an earlier result, or a dict that names one."""
    value = value.get("result") if isinstance(value, typing.Mapping) else value
    return hasattr(value, "optimization")


def is_list(value: Value) -> bool:
    """Whether a keyword has several values."""
    if isinstance(value, (str, bytes, typing.Mapping)) or np.ndim(value) != 1:
        return False
    return isinstance(value, (typing.Sequence, np.ndarray)) or hasattr(value, "__array__")


def sweep_name(name: str, method: str) -> str:
    """What a name that is none of the model changes in a sweep: an option by its last word, or an input."""
    return option_named(name, method) or (f"simulate.{name}" if name.startswith("inputs.") else name)


def option_named(name: str, method: str) -> str | None:
    """The whole name of the option that a keyword stands for."""
    options = simulate_options({name: 0}, method)[1] if name != "inputs" else []
    return next((key for key, _, _ in options if key.removeprefix("simulate.") in _SIMULATE), None)


def nearest(name: str, known: typing.Iterable[str]) -> tuple[str | None, str | None]:
    """What is nearest to a misspelt name: an option, or one of those that are known."""
    words = {key.rpartition(".")[2] for key in _SIMULATE}
    near = difflib.get_close_matches(name, [*known, *words], 1, 0.75)
    word = near[0] if near else None
    return (word, None) if word in words else (None, word)


def not_two_things(options: typing.Mapping[str, Value], declares: typing.Callable[[str], bool], method: str) -> None:
    """Refuses a keyword that an option and a parameter or state of the model have."""
    for name, value in options.items():
        key = option_named(name, method) if value is not None and declares(name) else None
        if key is not None:
            raise refuse(
                f"{name}={_shown(value)} may be two things: '{name}' is an option and a name of the model",
                f'write set={{"{name}": …}} for that of the model, set={{"{key}": …}} for the option',
            )


def axis(name: str, values: Value) -> str:
    """The values of a swept name, as the tool reads them: a list, or the text FROM:TO:NUMBER."""
    if isinstance(values, str):
        if _DISTRIBUTION.match(values):
            raise refuse(f"{name}: a distribution is no list of values", f'write sample={{"{name}": "{values}"}}, runs=100')
        return values
    if np.ndim(values) > 1:
        raise refuse(f"{name}: expected a list of values, found an array of shape {np.shape(values)}", "values.ravel()")
    if not is_list(values):
        raise refuse(f"{name}: expected a list of values, found {values!r}", f"{name}=[0.1, 0.2], or set={{...}} for one")
    if len(values) == 0:
        raise refuse(f"{name}: an empty list of values", "at least one value")
    return text_of(values, name)[1:-1]


def series_of(until: Value, schemes: Value, steps: Value) -> tuple[str, str]:
    """Schemes and numbers of steps of an order study, as the tool reads them."""
    if is_list(until):
        raise refuse(f"until={until!r}: expected the end time, a number", f"numbers of steps are steps={until!r}")
    schemes = [schemes] if isinstance(schemes, str) or not isinstance(schemes, typing.Iterable) else list(schemes)
    if not all(isinstance(one, (list, tuple, np.ndarray)) and len(one) == 2 for one in schemes):
        raise refuse(f"schemes={schemes!r}: expected pairs of a name and a number of stages", 'e.g. schemes=[("radau_iia", 2)]')
    if not isinstance(steps, typing.Iterable) or isinstance(steps, str):
        raise refuse(f"steps={steps!r}: expected a list of numbers of steps", "e.g. steps=[50, 100, 200]")
    return ",".join(f"{name}:{stages}" for name, stages in schemes), ",".join(str(n) for n in steps)


def is_several(value: Value) -> bool:
    """Whether a keyword of a sweep is swept; arrays of several axes are, to be refused."""
    return is_list(value) or isinstance(value, np.ndarray) and value.ndim > 1


def check_sweep(over: Value, sample: Value, runs: Value, seed: Value, jobs: Value) -> None:
    """What a sweep is asked for has the right kind."""
    if jobs is not None:
        whole("jobs", jobs, 1, 4096)
    whole("seed", seed, 0, 2**64 - 1)
    if runs is not None:
        whole("runs", runs, 1, 10**12)
    if sample is not None and not isinstance(sample, typing.Mapping):
        raise refuse(f"sample={sample!r}: expected a dict", 'e.g. sample={"v": "normal(3, 0.1)"}')
    if over is not None and not isinstance(over, typing.Mapping):
        raise refuse(f"over={over!r}: expected a dict", 'e.g. over={"mu": [0.1, 0.2]}, or mu=[0.1, 0.2]')


def whole(name: str, value: Value, least: int, most: int) -> None:
    """Refuses what is no whole number from `least` to `most`."""
    if not isinstance(value, numbers.Integral) or int(value) < least:
        raise refuse(f"{name}={value!r}: expected a whole number >= {least}", f"e.g. {name}={max(least, 1)}")
    if int(value) > most:
        raise refuse(f"{name}={value!r}: expected a whole number <= {most}", f"e.g. {name}={max(least, 1)}")


def count_of(values: Value) -> int:
    """How many they are; 0 where the tool counts them."""
    return 0 if isinstance(values, str) else len(values)


def once(name: str, taken: typing.Sequence[str]) -> str:
    """A name that nobody else changes."""
    if name in taken:
        raise refuse(f"'{name}' is changed twice", "give its values once: as a keyword, in over or in set")
    return name


def is_option(name: str, method: str) -> bool:
    """Whether a keyword is a key of [simulate], or the table of several."""
    return option_named(name, method) is not None or name in ("inputs", "set", "event", "fesd", "output", "smoothed")


def parameters_among(options: typing.Mapping[str, Value], known: typing.Collection[str], method: str) -> None:
    """Refuses a parameter or state, also a misspelt one, that is given as if it were an option."""
    for name in options:
        if name in _ELSEWHERE and name not in known and not is_option(name, method):
            raise refuse(f"'{name}' is no option", f"write {_ELSEWHERE[name]}")
        if name in known and isinstance(options[name], str) and _DISTRIBUTION.match(options[name]):
            axis(name, options[name])
        if name in known and not is_option(name, method):
            raise refuse(
                f"'{name}' is a name of the model, not an option",
                f'write set={{"{name}": {_shown(options[name], name)}}}; in a sweep {name}=[…] has its values',
            )
        meant = None if is_option(name, method) else nearest(name, known)[1]
        if meant is not None:
            raise refuse(f"'{name}' is no option, and no name of the model", f'did you mean set={{"{meant}": …}}?')


def names_no_keys(options: typing.Mapping[str, Value], known: typing.Container[str]) -> None:
    """Refuses a name of the model among the keywords of an optimisation."""
    for name in options:
        if name in _ELSEWHERE_IN_OPTIMIZE and name not in known:
            raise refuse(f"'{name}' is no option of an optimisation", f"write {_ELSEWHERE_IN_OPTIMIZE[name]}")
        if name in known and name not in _OPTIMIZE:
            raise refuse(f"'{name}' is a name of the model, not an option", f'write set={{"{name}": {_shown(options[name], name)}}}')


def _shown(value: Value, name: str = "") -> str:
    return repr(value) if isinstance(value, str) else text_of(value, name)


def check_path(value: typing.Any, what: str) -> None:
    """A mistake that is easily made: a text where a file is expected."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{what} expects the name of a file, found {type(value).__name__}; a Builder is a model already")
    if isinstance(value, str) and "\n" in value:
        raise refuse(f"{what} expects the name of a file, found a text of several lines", "write saltus.Model.from_text(text)")


def check_text(text: typing.Any) -> None:
    """The opposite mistake."""
    if not isinstance(text, str):
        raise TypeError(f"expected the text of a model file, found {type(text).__name__}")
    if "\n" not in text and text.endswith(".toml"):
        raise refuse(f"'{text}' is the name of a file, not its text", f'write saltus.Model("{text}")')
