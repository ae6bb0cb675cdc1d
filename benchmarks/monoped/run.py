"""The monoped of models/optima: one row of figures per run.

python3 benchmarks/monoped/run.py SALTUS [--positions hip|foot] [--intervals 30 40 …]
    [--start rest|reference|RESULT.json] [--terminal-weight 1|T/N] [--rho 0.01|0.1]
    [--seconds 600] [--stages KEY=VALUE,… KEY=VALUE,… …]

--positions: of the hip, as the paper states it, or of the foot (foot.toml), in which the gap is linear.
Every stage begins at the result of the one before (the first one as --start says) and changes what it names, for
itself and those behind it: goal (metres), friction, a_n, stabilisation (followed down to 0 with sigma), form
(step|stewart), sigma (the first one), factor, steering (direct|l1|linf), first (relaxed|branch), elements,
points (stages of the scheme), seconds, clear (weight of a cost of a foot that moves near the ground), penetration (of
the foot, metres), correction (metres per second), or key.of.optimize.
"""

import argparse
import json
import math
import pathlib
import subprocess
import tempfile

import reference

MODELS = {"hip": pathlib.Path(__file__).parents[2] / "models/optima/monoped.toml",
          "foot": pathlib.Path(__file__).parent / "foot.toml"}
LINK = 0.2
COLUMNS = ["N", "stage", "status", "objective", "iterations", "seconds", "ms per iteration", "primal", "complementarity",
           "stationarity", "B-stationary", "penetration [m]", "simulated [m]", "defect", "q_x(T)", "q(T) off", "v(T)",
           "open loop", "amplification", "closed loop", "closed loop q(T) off"]


def replaced(text, old, new):
    assert old in text, old
    return text.replace(old, new)


def guess_of(arguments, goal):
    """Expressions of time: the reference roughly, or the robot where it stands."""
    moves = arguments.start == "reference"
    height = "0.1*(1 - cos(4*pi*t/3))" if moves else "0"
    if arguments.positions == "hip":
        names, lift = ["q_x", "q_z", "phi_h", "phi_k", "v_x", "v_z", "w_h", "w_k"], 0.4
    else:
        names, lift = ["x", "z", "a", "b", "vx", "vz", "wa", "wb"], 0
    speed = goal / 3 if moves else 0
    return dict(zip(names, [f'"{speed}*t"', f'"{lift} + {height}"', 0, 0, speed, 0, 0, 0]))


def model_text(arguments, intervals, stage, table):
    horizon, goal = 3.0, float(stage.get("goal", 3.0))
    text = replaced(MODELS[arguments.positions].read_text(encoding="utf-8"), "monoped.csv", str(table))
    text = replaced(text, "control_intervals = 30", f"control_intervals = {intervals}")
    text = replaced(text, "weight = [0.01, 0.01]", f"weight = [{arguments.rho}, {arguments.rho}]")
    text = replaced(text, '"q_x - 3"', f'"q_x - {goal}"')
    friction = "mu" if arguments.positions == "foot" else "friction"
    text = replaced(text, f"{friction} = 0.8", f"{friction} = {stage.get('friction', 0.8)}")
    freezing = {"a_n": stage.get("a_n", 200), "correction": stage.get("correction", 0.1),
                "penetration": stage.get("penetration", 5e-4)}
    if "stabilisation" in stage:
        freezing["stabilisation"] = f"{{ initial = {stage['stabilisation']}, final = 0 }}"
    text = replaced(text, "a_n = 200", "\n".join(f"{key} = {value}" for key, value in freezing.items()))
    if arguments.terminal_weight == "T/N":
        scale = horizon / intervals
        weights = [1000 * scale] * 4 + [10 * scale] * 4
        text = replaced(text, "weight = [1000, 1000, 1000, 1000, 10, 10, 10, 10]", f"weight = {weights}")
    guess = guess_of(arguments, goal)
    stated = "[optimize.initial_guess]\n" + "".join(f"{name} = {value}\n" for name, value in guess.items())
    return replaced(text, "[optimize.mpcc]", stated + "[optimize.mpcc]")


def settings(arguments, stage):
    keys = {"optimize.native": "on", "optimize.closed_loop": "true", "optimize.mpcc.iteration_limit": arguments.iterations}
    names = {"form": "optimize.reformulation", "sigma": "optimize.mpcc.sigma_initial",
             "factor": "optimize.mpcc.sigma_factor", "steering": "optimize.mpcc.steering",
             "first": "optimize.mpcc.first", "elements": "optimize.elements", "points": "optimize.stages"}
    for key, value in stage.items():
        if key in names or key == "clear" or key.startswith("optimize."):
            keys[names.get(key, key)] = value
    return [word for key, value in keys.items() for word in ("--set", f"{key}={value}")]


def end_of(arguments, x):
    """Positions and velocities of the robot in a state, those of the hip first."""
    if arguments.positions == "hip":
        return x[:8]
    x, z, a, b, vx, vz, wa, wb = x[:8]
    hip = [x + LINK * (math.sin(a) + math.sin(b)), z + LINK * (math.cos(a) + math.cos(b))]
    velocity = [vx + LINK * (math.cos(a) * wa + math.cos(b) * wb), vz - LINK * (math.sin(a) * wa + math.sin(b) * wb)]
    return [*hip, a, b - a, *velocity, wa, wb - wa]


def off(end, goal):
    return max(abs(value - wanted) for value, wanted in zip(end, [goal, 0.4, 0, 0]))


def row_of(arguments, intervals, name, goal, result):
    certificate, statistics = result["certificate"], result["statistics"]
    iterations = max(statistics["iterations"], 1)
    verification = result.get("verification") or {}
    depth, open_loop, closed_loop = (verification.get(key, {}) for key in ("penetration", "open_loop", "closed_loop"))
    end = end_of(arguments, result["final"]["x"])
    replayed = closed_loop.get("x")
    return [intervals, name, result["status"]["termination"], result["objective"], statistics["iterations"],
            statistics["wall_seconds"], 1e3 * statistics["wall_seconds"] / iterations,
            certificate["primal_infeasibility"], certificate["complementarity_residual"],
            certificate["stationarity"], certificate["b_stationary"], depth.get("solution"), depth.get("simulation"),
            verification.get("interval_defect"), end[0], off(end, goal), max(abs(value) for value in end[4:]),
            open_loop.get("end_state_error"), open_loop.get("amplification"), closed_loop.get("end_state_error"),
            off(end_of(arguments, replayed[-1]), goal) if replayed else None]


def run(arguments, intervals, stage, name, files):
    """files: of the table, the model, the result, and the result to begin at or None."""
    table, model, out, begin = files
    table.write_text(reference.table(intervals, float(stage.get("goal", 3.0))), encoding="utf-8")
    model.write_text(model_text(arguments, intervals, stage, table), encoding="utf-8")
    out.unlink(missing_ok=True)
    start = ["--start", begin] if begin else []
    seconds = str(stage.get("seconds", arguments.seconds))
    subprocess.run([arguments.saltus, "optimize", model, "--quiet", "--out", out, "--time-limit", seconds,
                    *start, *settings(arguments, stage)], check=False)
    result = json.loads(out.read_text(encoding="utf-8"))
    return row_of(arguments, intervals, name, float(stage.get("goal", 3.0)), result)


def stages_of(arguments):
    """Names and settings; what a stage names holds for those behind it."""
    stage = {}
    for name in arguments.stages:
        stage = {**stage, **dict(part.split("=", 1) for part in name.split(",") if part)}
        yield name, stage


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("saltus")
    parser.add_argument("--positions", choices=list(MODELS), default="hip")
    parser.add_argument("--intervals", type=int, nargs="+", default=[30, 40, 50, 60, 70, 80, 90])
    parser.add_argument("--start", default="rest", help="rest, reference, or a stored result")
    parser.add_argument("--stages", nargs="+", default=[""])
    parser.add_argument("--terminal-weight", choices=["1", "T/N"], default="1")
    parser.add_argument("--rho", type=float, default=0.01)
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--iterations", type=int, default=30000)
    parser.add_argument("--keep", help="folder for models and results")
    arguments = parser.parse_args()
    print("| " + " | ".join(COLUMNS) + " |")
    print("|---" * len(COLUMNS) + "|", flush=True)
    with tempfile.TemporaryDirectory(prefix="monoped-") as scratch:
        folder = pathlib.Path(arguments.keep or scratch)
        folder.mkdir(parents=True, exist_ok=True)
        for intervals in arguments.intervals:
            before = None if arguments.start in ("rest", "reference") else pathlib.Path(arguments.start).resolve()
            for number, (name, stage) in enumerate(stages_of(arguments)):
                stem = f"{intervals}-{number}"
                out = (folder / f"{stem}.json").resolve()
                row = run(arguments, intervals, stage, name,
                          ((folder / f"{stem}.csv").resolve(), folder / f"{stem}.toml", out, before))
                cells = [f"{x:.3g}" if isinstance(x, float) else str(x) for x in row]
                print("| " + " | ".join(cells) + " |", flush=True)
                before = out


if __name__ == "__main__":
    main()
