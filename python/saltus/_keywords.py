"""Options as keywords, with their types, for signatures, help and whoever checks types.

Generated from the table of options of the source by scripts/python_keywords.py; a test compares.
"""

from __future__ import annotations

import typing

import numpy as np
import numpy.typing as npt

Whole = typing.Union[int, np.integer[typing.Any]]
Real = typing.Union[float, np.floating[typing.Any], np.integer[typing.Any]]
Reals = typing.Union[typing.Sequence[float], npt.NDArray[typing.Any]]
Wholes = typing.Union[typing.Sequence[int], npt.NDArray[typing.Any]]
Names = typing.Union[str, typing.Sequence[str]]
Several = typing.Union[typing.Sequence[typing.Any], npt.NDArray[typing.Any]]
Stated = typing.Any  #: an expression or what has some: a text, a number, an Expression, a list or a dict of them


class OutputTable(typing.TypedDict, total=False):
    """Keys of [simulate.output]."""

    every: typing.Union[Real, None]
    points: typing.Union[Whole, None]
    times: typing.Union[Reals, None]
    events: typing.Union[bool, None]
    states: typing.Union[Names, None]
    surfaces: typing.Union[Names, None]


class EventTable(typing.TypedDict, total=False):
    """Keys of [simulate.event]."""

    integrator: typing.Union[typing.Literal["auto", "dopri5", "dop853", "radau5", "radau9", "radau13", "taylor"], None]
    max_step: typing.Union[typing.Literal["none"], Real, None]
    local_steps: typing.Union[bool, None]
    selection: typing.Union[typing.Literal["active_dominant", "passive_dominant", "scaled", "report"], None]
    scaling: typing.Union[typing.Mapping[typing.Any, typing.Union[Real]], None]
    branches: typing.Union[typing.Literal["report", "all"], Whole, None]
    members: typing.Union[Whole, None]


class SmoothedTable(typing.TypedDict, total=False):
    """Keys of [simulate.smoothed]."""

    epsilon: typing.Union[Real, None]


class FesdTable(typing.TypedDict, total=False):
    """Keys of [simulate.fesd]."""

    scheme: typing.Union[typing.Literal["radau_iia", "gauss_legendre", "lobatto_iiia", "lobatto_iiic", "explicit"], None]
    stages: typing.Union[Whole, None]
    steps: typing.Union[Whole, None]
    elements: typing.Union[Whole, None]
    representation: typing.Union[typing.Literal["integral", "differential"], None]
    error_limit: typing.Union[typing.Literal["off"], Real, None]
    step_bounds: typing.Union[Real, None]
    rho: typing.Union[Real, None]
    equilibration_scale: typing.Union[Real, None]
    reformulation: typing.Union[typing.Literal["step", "stewart"], None]
    cross_complementarity: typing.Union[typing.Literal["stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"], None]
    step_equilibration: typing.Union[typing.Literal["direct", "mlcp", "none", "heuristic_mean", "heuristic_diff", "l2_relaxed", "l2_relaxed_scaled", "paper"], None]
    lifting: typing.Union[typing.Literal["off"], Whole, None]
    sensitivities: typing.Union[bool, None]


class TimesteppingTable(typing.TypedDict, total=False):
    """Keys of [simulate.timestepping]."""

    scheme: typing.Union[typing.Literal["radau_iia", "gauss_legendre", "lobatto_iiia", "lobatto_iiic", "explicit"], None]
    stages: typing.Union[Whole, None]
    steps: typing.Union[Whole, None]
    elements: typing.Union[Whole, None]
    representation: typing.Union[typing.Literal["integral", "differential"], None]
    error_limit: typing.Union[typing.Literal["off"], None]
    step_bounds: typing.Union[Real, None]
    rho: typing.Union[Real, None]
    equilibration_scale: typing.Union[Real, None]
    reformulation: typing.Union[typing.Literal["step", "stewart"], None]
    cross_complementarity: typing.Union[typing.Literal["stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"], None]
    step_equilibration: typing.Union[typing.Literal["direct", "mlcp", "none", "heuristic_mean", "heuristic_diff", "l2_relaxed", "l2_relaxed_scaled", "paper"], None]
    lifting: typing.Union[typing.Literal["off"], Whole, None]
    sensitivities: typing.Union[bool, None]


class OrderOptions(typing.TypedDict, total=False):
    """Keywords of a study of errors over steps."""

    from_: typing.Union[Real, None]
    begun: typing.Union[typing.Literal["none"], Real, None]
    method: typing.Union[typing.Literal["event", "smoothed", "fesd", "timestepping"], None]
    rtol: typing.Union[Real, None]
    atol: typing.Union[Real, None]
    output: typing.Union[typing.Literal["auto", "steps"], OutputTable, None]
    every: typing.Union[Real, None]
    points: typing.Union[Whole, None]
    times: typing.Union[Reals, None]
    events: typing.Union[bool, None]
    states: typing.Union[Names, None]
    surfaces: typing.Union[Names, None]
    error_estimate: typing.Union[bool, None]
    continuous: typing.Union[bool, None]
    native: typing.Union[typing.Literal["auto", "on", "off"], None]
    max_steps: typing.Union[Whole, None]
    max_events: typing.Union[Whole, None]
    initial_mode: typing.Union[typing.Mapping[typing.Any, typing.Union[typing.Literal[-1, 0, 1]]], None]
    integrator: typing.Union[typing.Literal["auto", "dopri5", "dop853", "radau5", "radau9", "radau13", "taylor"], None]
    max_step: typing.Union[typing.Literal["none"], Real, None]
    local_steps: typing.Union[bool, None]
    selection: typing.Union[typing.Literal["active_dominant", "passive_dominant", "scaled", "report"], None]
    scaling: typing.Union[typing.Mapping[typing.Any, typing.Union[Real]], None]
    branches: typing.Union[typing.Literal["report", "all"], Whole, None]
    members: typing.Union[Whole, None]
    epsilon: typing.Union[Real, None]
    scheme: typing.Union[typing.Literal["radau_iia", "gauss_legendre", "lobatto_iiia", "lobatto_iiic", "explicit"], None]
    stages: typing.Union[Whole, None]
    elements: typing.Union[Whole, None]
    representation: typing.Union[typing.Literal["integral", "differential"], None]
    error_limit: typing.Union[typing.Literal["off"], Real, None]
    step_bounds: typing.Union[Real, None]
    rho: typing.Union[Real, None]
    equilibration_scale: typing.Union[Real, None]
    reformulation: typing.Union[typing.Literal["step", "stewart"], None]
    cross_complementarity: typing.Union[typing.Literal["stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"], None]
    step_equilibration: typing.Union[typing.Literal["direct", "mlcp", "none", "heuristic_mean", "heuristic_diff", "l2_relaxed", "l2_relaxed_scaled", "paper"], None]
    lifting: typing.Union[typing.Literal["off"], Whole, None]
    sensitivities: typing.Union[bool, None]
    inputs: typing.Union[typing.Mapping[typing.Any, typing.Any], None]
    event: typing.Union[EventTable, None]
    fesd: typing.Union[FesdTable, None]
    smoothed: typing.Union[SmoothedTable, None]
    timestepping: typing.Union[TimesteppingTable, None]


class SimulateOptions(OrderOptions, total=False):
    """Keywords of a simulation."""

    steps: typing.Union[Whole, None]


class SweepOptions(typing.TypedDict, total=False):
    """Keywords of many simulations: of most several values are swept."""

    from_: typing.Union[Real, Several, None]
    begun: typing.Union[typing.Literal["none"], Real, Several, None]
    method: typing.Union[typing.Literal["event", "smoothed", "fesd", "timestepping"], Several, None]
    rtol: typing.Union[Real, Several, None]
    atol: typing.Union[Real, Several, None]
    output: typing.Union[typing.Literal["auto", "steps"], OutputTable, None]
    every: typing.Union[Real, Several, None]
    points: typing.Union[Whole, Several, None]
    times: typing.Union[Reals, Several, None]
    events: typing.Union[bool, Several, None]
    states: typing.Union[Names, Several, None]
    surfaces: typing.Union[Names, Several, None]
    error_estimate: typing.Union[bool, Several, None]
    continuous: typing.Union[bool, Several, None]
    native: typing.Union[typing.Literal["auto", "on", "off"], Several, None]
    max_steps: typing.Union[Whole, Several, None]
    max_events: typing.Union[Whole, Several, None]
    initial_mode: typing.Union[typing.Mapping[typing.Any, typing.Union[typing.Literal[-1, 0, 1]]], None]
    integrator: typing.Union[typing.Literal["auto", "dopri5", "dop853", "radau5", "radau9", "radau13", "taylor"], Several, None]
    max_step: typing.Union[typing.Literal["none"], Real, Several, None]
    local_steps: typing.Union[bool, Several, None]
    selection: typing.Union[typing.Literal["active_dominant", "passive_dominant", "scaled", "report"], Several, None]
    scaling: typing.Union[typing.Mapping[typing.Any, typing.Union[Real]], None]
    branches: typing.Union[typing.Literal["report", "all"], Whole, Several, None]
    members: typing.Union[Whole, Several, None]
    epsilon: typing.Union[Real, Several, None]
    scheme: typing.Union[typing.Literal["radau_iia", "gauss_legendre", "lobatto_iiia", "lobatto_iiic", "explicit"], Several, None]
    stages: typing.Union[Whole, Several, None]
    elements: typing.Union[Whole, Several, None]
    representation: typing.Union[typing.Literal["integral", "differential"], Several, None]
    error_limit: typing.Union[typing.Literal["off"], Real, Several, None]
    step_bounds: typing.Union[Real, Several, None]
    rho: typing.Union[Real, Several, None]
    equilibration_scale: typing.Union[Real, Several, None]
    reformulation: typing.Union[typing.Literal["step", "stewart"], Several, None]
    cross_complementarity: typing.Union[typing.Literal["stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"], Several, None]
    step_equilibration: typing.Union[typing.Literal["direct", "mlcp", "none", "heuristic_mean", "heuristic_diff", "l2_relaxed", "l2_relaxed_scaled", "paper"], Several, None]
    lifting: typing.Union[typing.Literal["off"], Whole, Several, None]
    sensitivities: typing.Union[bool, Several, None]
    inputs: typing.Union[typing.Mapping[typing.Any, typing.Any], None]
    event: typing.Union[EventTable, None]
    fesd: typing.Union[FesdTable, None]
    smoothed: typing.Union[SmoothedTable, None]
    timestepping: typing.Union[TimesteppingTable, None]
    steps: typing.Union[Whole, Several, None]


class SweepCall(SweepOptions, total=False):
    """All keywords of a sweep but names of the model."""

    zip: bool
    sample: typing.Union[typing.Mapping[str, str], None]
    runs: typing.Union[int, None]
    seed: int
    keep: typing.Literal["final", "events", "trajectory"]
    jobs: typing.Union[int, None]
    yes: bool
    until: typing.Union[Real, Several, None]
    set: typing.Any
    progress: bool
    executor: typing.Any


class OptimizeOptions(typing.TypedDict, total=False):
    """Keywords of an optimisation."""

    horizon: typing.Union[Stated, None]
    from_: typing.Union[Stated, None]
    running_cost: typing.Union[Stated, None]
    terminal_cost: typing.Union[Stated, None]
    minimize_time: typing.Union[Stated, None]
    path_constraints: typing.Union[Stated, None]
    path_constraints_at: typing.Union[Stated, None]
    terminal_constraints: typing.Union[Stated, None]
    path_complementarities: typing.Union[Stated, None]
    initial_guess: typing.Union[Stated, None]
    plant: typing.Union[Stated, None]
    least_squares: typing.Union[Stated, None]
    control_intervals: typing.Union[Whole, None]
    elements: typing.Union[Whole, Wholes, None]
    scheme: typing.Union[typing.Literal["radau_iia", "gauss_legendre", "lobatto_iiia", "lobatto_iiic", "explicit"], None]
    stages: typing.Union[Whole, None]
    switch_detection: typing.Union[bool, None]
    representation: typing.Union[typing.Literal["integral", "differential"], None]
    reformulation: typing.Union[typing.Literal["step", "stewart"], None]
    lifting: typing.Union[typing.Literal["off"], Whole, None]
    cross_complementarity: typing.Union[typing.Literal["stage_stage", "fe_stage", "stage_fe", "fe_fe", "paper"], None]
    step_equilibration: typing.Union[typing.Literal["direct", "mlcp", "none", "heuristic_mean", "heuristic_diff", "l2_relaxed", "l2_relaxed_scaled", "paper"], None]
    step_bounds: typing.Union[Real, None]
    rho: typing.Union[Real, None]
    equilibration_scale: typing.Union[Real, None]
    native: typing.Union[typing.Literal["auto", "on", "off"], None]
    closed_loop: typing.Union[typing.Literal["auto"], bool, None]
    feedback: typing.Union[typing.Literal["optimal", "tracking"], None]
    verification_tolerance: typing.Union[Real, None]
    time_limit: typing.Union[typing.Literal["none"], Real, None]
    solver: typing.Union[typing.Literal["structured", "ipopt"], None]
    starts: typing.Union[typing.Literal["auto"], Whole, None]
    seed: typing.Union[typing.Literal["none"], Whole, None]
    compared_starts: typing.Union[typing.Literal["auto"], Whole, None]
    method: typing.Union[typing.Literal["scholtes", "fischer_burmeister", "natural_residual", "chen_chen_kanzow", "steffensen_ulbrich_sine", "steffensen_ulbrich_poly", "kanzow_schwartz", "lin_fukushima", "kadrani"], None]
    steering: typing.Union[typing.Literal["direct", "l1", "linf"], None]
    sigma_initial: typing.Union[typing.Literal["auto"], Real, None]
    sigma_factor: typing.Union[Real, None]
    sigma_final: typing.Union[Real, None]
    warm_start: typing.Union[typing.Literal["primal", "primal_dual"], None]
    first: typing.Union[typing.Literal["auto", "relaxed", "branch", "modes"], None]
    crossover: typing.Union[bool, None]
    tolerance: typing.Union[Real, None]
    iteration_limit: typing.Union[Whole, None]
    mpcc: typing.Union[typing.Mapping[str, typing.Any], None]


class MpccOptions(typing.TypedDict, total=False):
    """Keywords of a foreign problem with complementarities."""

    solver: typing.Union[typing.Literal["structured", "ipopt"], None]
    starts: typing.Union[typing.Literal["auto"], Whole, None]
    seed: typing.Union[typing.Literal["none"], Whole, None]
    compared_starts: typing.Union[typing.Literal["auto"], Whole, None]
    method: typing.Union[typing.Literal["scholtes", "fischer_burmeister", "natural_residual", "chen_chen_kanzow", "steffensen_ulbrich_sine", "steffensen_ulbrich_poly", "kanzow_schwartz", "lin_fukushima", "kadrani"], None]
    steering: typing.Union[typing.Literal["direct", "l1", "linf"], None]
    sigma_initial: typing.Union[typing.Literal["auto"], Real, None]
    sigma_factor: typing.Union[Real, None]
    sigma_final: typing.Union[Real, None]
    warm_start: typing.Union[typing.Literal["primal", "primal_dual"], None]
    first: typing.Union[typing.Literal["auto", "relaxed", "branch", "modes"], None]
    crossover: typing.Union[bool, None]
    tolerance: typing.Union[Real, None]
    iteration_limit: typing.Union[Whole, None]
    time_limit: typing.Union[Real, None]
