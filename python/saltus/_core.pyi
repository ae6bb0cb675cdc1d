"""The extension module: what the Python of the package calls."""

import typing

import numpy as np
from numpy.typing import NDArray

version: str
Floats = NDArray[np.float64]
Option = tuple[str, str, str]
SharedWarning = tuple[str, list[int]]

class Alternative:
    mode: list[int]
    alpha: Floats
    regions: list[list[str]]
    def __repr__(self) -> str: ...

class Intersection:
    surfaces: list[str]
    velocities: list[list[float]]
    alpha_before: list[float] | None
    alpha_after: list[float]

class Event:
    t: float
    kind: str
    name: str | None
    turned: str | None
    surfaces: list[str]
    mode_before: list[int] | None
    mode_after: list[int] | None
    alpha_before: Floats | None
    alpha_after: Floats | None
    regions_before: list[list[str]] | None
    regions_after: list[list[str]] | None
    contact_modes_before: list[str]
    contact_modes_after: list[str]
    impulse: list[list[float]] | None
    states: list[str]
    x: Floats
    x_after: Floats
    unique: bool | None
    alternatives: list[Alternative]
    reason: str
    intersection: Intersection | None
    def __getitem__(self, name: str) -> typing.Any: ...
    def __repr__(self) -> str: ...

class Run:
    model: str
    description: str
    parameters: list[tuple[str, float]]
    command: str
    method: str
    states: list[str]
    states_in_rows: list[str]
    functions_in_rows: list[str]
    controls: list[str]
    output_names: list[str]
    switching_functions: list[str]
    contacts: list[str]
    contact_modes: list[list[str]]
    regions: list[str]
    termination: str
    done: bool
    message: str
    time_reached: float
    t: Floats
    x: Floats
    u: Floats
    alpha: Floats
    mode: NDArray[np.int32]
    outputs: Floats
    theta: Floats
    events: list[Event]
    final: dict[str, typing.Any]
    branches: list[Run]
    is_continuous: bool
    sensitivities: dict[str, typing.Any] | None
    def values_at(self, between: Run, times: list[float], before: bool) -> Run: ...
    def drawn(self) -> Run | None: ...
    def facts(self) -> str: ...
    def said(self) -> list[list[str]]: ...
    def table(self) -> str: ...
    def json(self, surfaces: bool) -> str: ...
    def page(self, labels: list[str], others: list[Run]) -> str: ...
    def save(self, path: str) -> None: ...

class Model:
    name: str
    description: str
    path: str
    method: str
    can_optimize: bool
    forced_modes: list[str]
    @typing.overload
    def __init__(self, model: str) -> None: ...
    @typing.overload
    def __init__(self, text: str, name: str, files: list[tuple[str, str]] = ...) -> None: ...
    def equations(self, latex: bool) -> list[tuple[str, str, str]]: ...
    def declares(self, name: str) -> bool: ...
    def quantities(self, of_states: bool) -> list[tuple[str, float]]: ...
    def simulate(
        self,
        settings: list[str],
        options: list[Option],
        progress: typing.Callable[..., None] | None,
        warnings: list[str],
    ) -> Run: ...
    def compare(
        self,
        settings: list[str],
        options: list[Option],
        progress: typing.Callable[..., None] | None,
        warnings: list[str],
    ) -> Run: ...
    def order(
        self,
        settings: list[str],
        options: list[Option],
        progress: typing.Callable[..., None] | None,
        warnings: list[str],
        schemes: str,
        steps: str,
    ) -> Run: ...
    def optimize(
        self,
        settings: list[str],
        options: list[Option],
        start: Run | str | None,
        on_step: typing.Callable[[str], None] | None,
        warnings: list[str],
    ) -> Run: ...
    def simulate_between(self, settings: list[str], options: list[Option], branches: bool) -> Run: ...
    def sweep(
        self,
        settings: list[str],
        options: list[Option],
        over: list[str],
        paired: bool,
        samples: list[str],
        runs: int | None,
        seed: int,
        keep: str,
        yes: bool,
        jobs: int,
        share: tuple[int, int, int],
        progress: typing.Callable[[float, float], None] | None,
        warnings: list[SharedWarning],
    ) -> tuple[dict[str, typing.Any], list[Run], list[str]]: ...
    def starts(self, settings: list[str], options: list[Option]) -> int: ...
    def study(
        self,
        settings: list[str],
        options: list[Option],
        over: list[str],
        paired: bool,
        samples: list[str],
        runs: int | None,
        seed: int,
        keep: str,
        yes: bool,
    ) -> tuple[str, int]: ...
    def sweep_page(
        self, columns: list[tuple[str, list[str], list[float]]], names: list[str], command: str, grid: bool
    ) -> str: ...
    @staticmethod
    def told_with_runs(warnings: list[SharedWarning]) -> list[str]: ...
    def check(self, settings: list[str]) -> str: ...

def best_of_starts(runs: list[Run]) -> Run: ...
def run_tool(arguments: list[str]) -> int: ...
def models() -> list[str]: ...
def told_together(texts: list[str]) -> list[str]: ...
def sized_model(name: str, sizes: dict[str, int]) -> str | None: ...
def find_catalogue(name: str) -> str: ...
def set_shared_folder(folder: str) -> None: ...
def write_file(path: str, content: str) -> None: ...
def plotly_source() -> str: ...
def option_tables() -> dict[str, list[dict[str, typing.Any]]]: ...
def solve_mpcc(
    file: str,
    options: list[Option],
    start: list[float],
    on_step: typing.Callable[[str], None] | None,
    warnings: list[str],
) -> tuple[str, str, bool]: ...
def simulate_keys() -> list[str]: ...
def optimize_keys() -> list[str]: ...
def load(path: str) -> Run: ...
def parse_result(text: str) -> Run: ...
def difference(a: Run, b: Run, rtol: float, atol: float | None) -> dict[str, typing.Any]: ...
