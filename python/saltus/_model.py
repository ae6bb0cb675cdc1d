"""Models: read, simulated, optimised."""

from __future__ import annotations

import os
import typing

from . import _core
from ._card import model_card, table_card
from ._errors import warn
from ._expression import refuse
from ._facts import Quantities, of_model
from ._progress import lines_of_problems, progress_line, progress_of_runs
from ._result import Result, Source, continued, own_results
from ._samples import file_text
from ._settings import (
    Option,
    Settings,
    Value,
    axis,
    check_path,
    check_sweep,
    check_text,
    check_together,
    count_of,
    entry_by_entry,
    is_option,
    is_several,
    mapping_of,
    names_in,
    names_no_keys,
    nearest,
    not_two_things,
    once,
    optimize_options,
    parameters_among,
    series_of,
    settings_of,
    simulate_options,
    sweep_name,
)
from ._machines._shares import sweep_by
from ._signature import with_options
from ._machines._starts import optimize_by
from ._machines._stored_sweep import sweep_into
from ._sweep import Sweep, SweepArguments, Warned, warn_of_runs, with_results

if typing.TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keywords import OptimizeOptions, OrderOptions, SimulateOptions, SweepCall

Start = typing.Union[Result, str, "os.PathLike[str]"]


class Model(Source):
    """A model file: equations, parameters, initial values, and the options it was written with.

    >>> m = saltus.Model.from_text('''
    ... [model]
    ... name = "brake"
    ... [states]
    ... x = 0
    ... v = 3
    ... [dynamics]
    ... x = "v"
    ... v = "-0.4*x - 2*sign(v)"
    ... ''')
    >>> r = m.simulate(until=6)
    >>> r.status, [e.kind for e in r.events]
    ('completed', ['enter_sliding'])
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        """Reads a model file. Raises :class:`ModelError` with file, line and column of what cannot be read; whether names
        and equations fit is said, likewise, by whatever is asked of the model first."""
        check_path(path, "saltus.Model")
        self._core = _core.Model(os.fspath(path))
        self._made = (Model, (os.path.abspath(self._core.path),))

    @classmethod
    def from_text(
        cls, text: str, name: str = "model.toml", *, files: typing.Mapping[str, typing.Any] | None = None
    ) -> Model:
        """A model from the text of a file, as if it were read. `name` is used in messages, and its folder to find files it
        names. `files` are data in memory in place of files that the text names: arrays, lists of columns, DataFrames, or
        texts, ``{"u.csv": frame}``.

        >>> m = saltus.Model.from_text('[model]\\nname = "decay"\\n[states]\\nx = 1\\n[dynamics]\\nx = "-x"')
        >>> round(m.simulate(until=1).final["x"], 6)
        0.367879
        """
        check_text(text)
        model = cls.__new__(cls)
        in_memory = [(file, file_text(file, value)) for file, value in (files or {}).items()]
        model._core = _core.Model(text, name, in_memory)
        model._made = (_from_texts, (text, name, in_memory)) if in_memory else (Model.from_text, (text, name))
        return model

    @property
    def name(self) -> str:
        """The name that the file states.

        >>> saltus.catalogue("stick-slip").name
        'stick-slip'
        """
        return self._core.name

    @property
    def description(self) -> str:
        """One sentence of the file, or an empty text.

        >>> saltus.catalogue("stick-slip").description
        'a block on a moving belt sticks and slips'
        """
        return self._core.description

    @property
    def path(self) -> str:
        """The file it was read from.

        >>> saltus.catalogue("stick-slip").path.endswith("stick-slip.toml")
        True
        """
        return self._core.path

    @with_options("simulate")
    def simulate(
        self,
        until: float | None = None,
        *,
        set: Settings | None = None,
        start: Start | None = None,
        progress: bool = False,
        **options: Unpack[SimulateOptions],
    ) -> Result:
        """Simulates the model and returns everything that was computed.

        `until` is the end of the simulation; without it that of the file holds, or the last one of `times`. `set` changes
        parameters, initial values and constant inputs (``{"mu": 0.5}``; ``{"x": [1, 0]}`` of x1, x2), and by dotted names any key of the file
        (``{"dynamics.v": "-x"}``); the end of a run, ``set=r.final``, its states. With `start` the run goes on from the
        end of another one: its states, its time, and what it slides on. `inputs` are expressions or data in memory:
        ``{"u": "sin(t)"}``, ``{"u": (times, values)}``, a DataFrame with a column for every control.

        A run that stops early is no exception: see ``status`` and :meth:`Result.require`. Ctrl-C raises
        KeyboardInterrupt, whose ``result`` is what was computed. Other threads run meanwhile.

        >>> saltus.catalogue("stick-slip").simulate(until=3, set={"belt": 0.3}, integrator="dop853").final.t
        3.0
        """
        with progress_line(self.name, progress) as tell:
            stated: Settings | None = set
            asked: typing.Mapping[str, Value] = options
            if start is not None:
                changed = entry_by_entry(mapping_of(set), self._core.declares)
                stated, asked = continued(
                    start, self.states, self.parameters, dict(mapping_of(changed)), options, self._core.method, self._core.forced_modes
                )
            run, settings, chosen = self._run("simulate", until, stated, asked, tell)
        return Result(run, (self, settings, chosen))

    @with_options("simulate")
    def compare(
        self, until: float | None = None, *, set: Settings | None = None, **options: Unpack[SimulateOptions]
    ) -> Result:
        """Simulates the model by every engine; ``comparison`` of the result has a row for each.

        >>> rows = saltus.catalogue("stick-slip").compare(until=2).comparison["runs"]
        >>> rows[0]["method"]
        'event'
        """
        return Result(self._run("compare", until, set, options, None)[0])

    @with_options("simulate")
    def order(
        self,
        until: float | None = None,
        *,
        schemes: typing.Iterable[tuple[str, int]] = (),
        steps: typing.Iterable[int] = (),
        set: Settings | None = None,
        **options: Unpack[OrderOptions],
    ) -> Result:
        """Measures how errors fall with the step; ``order`` of the result has a series for every scheme.

        >>> m = saltus.catalogue("stick-slip")
        >>> series = m.order(until=1, schemes=[("radau_iia", 2)], steps=[10, 20]).order["series"]
        >>> series[0]["stages"]
        2
        """
        return Result(self._run("order", until, set, options, None, series_of(until, schemes, steps))[0])

    @with_options("optimize")
    def optimize(
        self,
        *,
        set: Settings | None = None,
        start: Start | None = None,
        progress: bool = False,
        executor: typing.Any = None,
        **options: Unpack[OptimizeOptions],
    ) -> Result:
        """Finds the controls, times and parameters that [optimize] of the file asks for, and verifies them.

        Options are the keys of [optimize] (docs/optimal-control.md): ``control_intervals=20``, ``time_limit=60``,
        ``tolerance=1e-8``, ``horizon=2``. `start` is a result to begin at, or its file; or the word of the option of that
        name, ``"neutral"`` or ``"simulated"``. ``optimization`` of the result has costs, parameters, multipliers and
        what was verified.

        `executor` (as of :meth:`sweep`) shares out the starts of ``starts=8``, one to each of its workers: the result is
        that of one process.

        >>> m = saltus.Model.from_text('''
        ... [model]
        ... name = "car"
        ... [states]
        ... q = 0
        ... v = 0
        ... [controls]
        ... u = { lower = -1, upper = 1 }
        ... [dynamics]
        ... q = "v"
        ... v = "u"
        ... [optimize]
        ... horizon = { free = true, initial = 2.5, lower = 1, upper = 5 }
        ... minimize_time = true
        ... terminal_constraints = ["q == 1", "v == 0"]
        ... ''')
        >>> round(m.optimize(control_intervals=4).optimization["horizon"], 6)
        2.0
        """
        names_no_keys(options, {**self.states, **self.parameters} if options else {})
        stated: dict[str, Value] = {**options}
        if isinstance(start, str) and start in ("neutral", "simulated"):
            stated, start = {**stated, "start": start}, None
        guess = stated.get("initial_guess")
        guess = guess.get("result") if isinstance(guess, typing.Mapping) else guess
        if isinstance(guess, Result):
            start = guess
            del stated["initial_guess"]
        typed, chosen = optimize_options(stated)
        settings = [*settings_of(entry_by_entry(set, self._core.declares)), *typed]
        if executor is None:
            with own_results(), lines_of_problems(self.name, progress) as tell:
                run, warned = self._optimum(settings, chosen, start, tell)
        else:
            with progress_of_runs(self.name, progress, "starts") as tell_starts:
                run, warned = optimize_by(executor, self, settings, chosen, start, tell_starts)
        warn(warned)
        return Result(run)

    def _optimum(
        self, settings: list[str], chosen: list[Option], start: Start | None, tell: typing.Callable[[str], None] | None
    ) -> tuple[_core.Run, list[str]]:
        warned: list[str] = []
        return self._core.optimize(settings, chosen, _place(start), tell, warned), warned

    @typing.overload
    def sweep(self, over: Settings | None = None, **keywords: Unpack[SweepCall]) -> Sweep: ...
    @typing.overload
    def sweep(self, over: Settings | None = None, **keywords: Value) -> Sweep: ...
    @with_options("sweep")
    def sweep(
        self,
        over: Settings | None = None,
        *,
        zip: bool = False,
        sample: typing.Mapping[str, str] | None = None,
        runs: int | None = None,
        seed: int = 1,
        keep: str = "final",
        jobs: int | None = None,
        yes: bool = False,
        until: Value = None,
        set: Settings | None = None,
        progress: bool = False,
        executor: typing.Any = None,
        resume: str | os.PathLike[str] | None = None,
        **options: Value,
    ) -> Sweep:
        """Simulates the model with many values, by all processors (or `jobs` threads).

        `over` has a list of values for every name that is changed: parameters, initial values, options; a keyword with
        a list is the same (``mu=np.linspace(0.1, 0.5, 50)``). Several make a grid, with `zip` they go one by one.
        `sample` has distributions (``{"v": "normal(3, 0.1)"}``), of which every point of the grid gets `runs` samples;
        they depend on `seed` and the number of the run only. `keep` is what is left of the runs: "final", "events" or
        "trajectory". A run that stops early is a row with its status, and one whose solution is not unique says so (of
        whole runs ``branches="all"`` follows the others, but those of contacts). Nothing depends on the number of
        threads. More than 10^7 runs need `yes`.

        Names of the model come before options of the same name, which are swept by their whole names
        (``{"simulate.fesd.rho": [1, 2]}``).

        `executor` is one of concurrent.futures, or of a library that has its interface (loky, mpi4py.futures,
        dask.distributed, Ray), or a function that makes one: it gets shares of the runs, each with `jobs` threads (one
        without it). A share whose worker ends is run again by another one, three times in all; then :class:`Stopped`
        names its runs, and has all others as its ``result``. Ctrl-C raises KeyboardInterrupt, whose ``result`` has the
        runs that began.

        `resume` is a folder to which rows are appended (Parquet where pyarrow is there, else npz), a thousand runs at a
        time; the same call goes on where it was ended, and gives a sweep that reads the folder (``parts()``).

        >>> s = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2, 0.3], until=5)
        >>> len(s), s.done, s["belt"].tolist()
        (3, True, [0.1, 0.2, 0.3])
        """
        check_sweep(over, sample, runs, seed, jobs)
        set = entry_by_entry(set, self._core.declares)
        options = {"until": until, **options}
        swept = self._swept(over or {}, set, options)
        for name in sample or {}:
            once(name, names_in(set))
        if not swept and not sample:
            raise refuse("nothing is changed from run to run", "e.g. m.sweep(mu=np.linspace(0.1, 0.5, 50), until=10)")
        typed, chosen = simulate_options(options, self._core.method)
        axes = {name: axis(name, values) for name, values in swept.items()}
        # Of values that the tool counts the shape is not known here.
        counts = tuple(count_of(values) for values in swept.values())
        shape = counts if not zip and sample is None and 0 not in counts else ()
        arguments: SweepArguments = (
            [*settings_of(set), *typed],
            chosen,
            [f"{name}={values}" for name, values in axes.items()],
            zip,
            [f"{name}={text}" for name, text in (sample or {}).items()],
            runs,
            seed,
            keep,
            yes,
        )
        warned: list[Warned] = []
        axes_of = shape, len(sample or {})
        with progress_of_runs(self.name, progress, "runs") as tell:
            if resume is not None:
                return sweep_into(resume, executor, self, arguments, jobs, tell, axes_of)
            try:
                if executor is None:
                    found = with_results(self._core.sweep(*arguments, jobs or 0, (1, 1, 0), tell, warned), self, arguments)
                    if tell is not None:  # not every run was told
                        tell(len(found[1]), len(found[1]))
                else:
                    found = sweep_by(executor, self, arguments, jobs or 1, tell)
            except BaseException as stopped:
                kept: typing.Any = getattr(stopped, "result", None)
                if isinstance(kept, tuple):
                    kept = with_results(kept, self, arguments, all_runs=False) if executor is None else kept
                    stopped.result = Sweep(kept, *axes_of, (self, arguments))  # type: ignore[attr-defined]
                raise
        warn_of_runs(warned)
        return Sweep(found, *axes_of, (self, arguments))

    def _swept(self, over: Settings, set: Settings | None, options: dict[str, Value]) -> dict[str, Value]:
        """All that is swept, by the names of settings; keywords that have several values leave the options."""
        chosen = options.get("method")
        method = chosen if isinstance(chosen, str) else self._core.method
        swept: dict[str, Value] = {}
        taken = names_in(set)
        for key, values in mapping_of(over).items():
            swept[once(self._swept_name(getattr(key, "text", key), method), [*swept, *taken])] = values
        for name in [name for name, value in options.items() if is_several(value) and name != "times"]:
            swept[once(self._swept_name(name, method), [*swept, *taken])] = options.pop(name)
        self._refuse_parameters({name: value for name, value in options.items() if name != "until"})
        return swept

    def _swept_name(self, name: str, method: str) -> str:
        if not isinstance(name, str) or self._core.declares(name):
            return name
        setting = sweep_name(name, method)
        if setting == name and "." not in name:
            near, _ = nearest(name, {**self.states, **self.parameters})
            if near is not None:
                raise refuse(f"'{name}' is no name of the model and no option", f"did you mean '{near}'?")
        return setting

    def equations(self, *, latex: bool = False) -> list[tuple[str, str, str]]:
        """The equations as they were read: left side, right side, and where or when they hold; at most 1000.

        >>> saltus.catalogue("bouncing-ball").equations()[1]
        ("v'", '-g', '')
        >>> saltus.catalogue("bouncing-ball").equations(latex=True)[1][0]
        '\\\\dot{v}'
        """
        return self._core.equations(latex)

    @property
    def states(self) -> Quantities:
        """The states with their initial values.

        >>> saltus.catalogue("bouncing-ball").states
        {'y': 10.0, 'v': 0.0}
        """
        return of_model(self._core.quantities(True))

    @property
    def parameters(self) -> Quantities:
        """The parameters with their values; they are changed where the model is run, by `set`.

        >>> saltus.catalogue("bouncing-ball").parameters
        {'g': 9.8, 'e': 0.9}
        """
        return of_model(self._core.quantities(False))

    def _repr_html_(self) -> str:
        return model_card(self)

    def check(self, *, set: Settings | None = None) -> str:
        """What `saltus check` prints: states, switching functions and their kinds, methods, warnings.

        >>> "slip: " in saltus.catalogue("stick-slip").check()
        True
        """
        return _Lines(self._core.check(settings_of(entry_by_entry(set, self._core.declares))))

    def _run(
        self,
        command: str,
        until: float | None,
        set: Settings | None,
        options: typing.Mapping[str, Value],
        tell: typing.Callable[..., None] | None,
        more: tuple[str, ...] = (),
    ) -> tuple[_core.Run, list[str], list[Option]]:
        self._refuse_parameters(options)
        set = entry_by_entry(set, self._core.declares)
        typed, chosen = simulate_options({"until": until, **options}, self._core.method)
        warned: list[str] = []
        with own_results():
            settings = [*settings_of(set), *typed]
            run: _core.Run = getattr(self._core, command)(settings, chosen, tell, warned, *more)
        warn(warned)
        return run, settings, chosen

    def _refuse_parameters(self, options: typing.Mapping[str, Value]) -> None:
        """Of keywords that are no options those that the model knows; the rest is the tool's to say."""
        check_together(options)
        not_two_things(options, self._core.declares, self._core.method)
        if any(not is_option(name, self._core.method) for name in options):
            parameters_among(options, {**self.states, **self.parameters}, self._core.method)

    def __repr__(self) -> str:
        return f"<saltus.Model {self.name!r}>"


class _Lines(str):
    """A text that a notebook shows as its lines."""

    def __repr__(self) -> str:
        return str(self).rstrip()

    def _repr_html_(self) -> str:
        return table_card("", self)


def _place(start: typing.Any) -> typing.Any:
    """What the library begins at: a result in memory, the name of a file, or nothing."""
    if start is None or isinstance(start, Result):
        return None if start is None else start._run
    if not isinstance(start, (str, os.PathLike)):
        raise refuse(f"start={start!r}: expected a result, or the file of one", 'start=r, or start="r.json"')
    return os.fspath(start)


def _from_texts(text: str, name: str, files: list[tuple[str, str]]) -> Model:
    return Model.from_text(text, name, files=dict(files))
