"""The monoped of examples/contacts for several numbers of intervals: one row of figures per run.

python3 benchmarks/monoped/run.py SALTUS [--intervals 30 40 …] [--start rest|reference] [--terminal-weight 1|T/N] [--rho 0.01|0.1] [--seconds 600]
"""

import argparse
import json
import pathlib
import subprocess
import tempfile

import reference

MODEL = pathlib.Path(__file__).parents[2] / "examples/contacts/monoped.toml"
COLUMNS = ["N", "status", "objective", "iterations", "seconds", "ms per iteration", "primal", "complementarity",
           "stationarity", "lowest foot [m]", "defect", "q_x(T)"]


def model_text(arguments, intervals, table):
    horizon = 3.0
    text = MODEL.read_text(encoding="utf-8").replace("monoped.csv", str(table))
    text = text.replace("control_intervals = 30", f"control_intervals = {intervals}")
    text = text.replace("weight = [0.01, 0.01]", f"weight = [{arguments.rho}, {arguments.rho}]")
    if arguments.terminal_weight == "T/N":
        scale = horizon / intervals
        weights = [1000 * scale] * 4 + [10 * scale] * 4
        text = text.replace("weight = [1000, 1000, 1000, 1000, 10, 10, 10, 10]", f"weight = {weights}")
    if arguments.start == "reference":
        guess = {"q_x": '"t"', "q_z": '"0.4 + 0.1*(1 - cos(4*pi*t/3))"', "phi_h": 0, "phi_k": 0, "v_x": 1, "v_z": 0,
                 "w_h": 0, "w_k": 0}
    else:
        guess = {"q_x": 0, "q_z": 0.4, "phi_h": 0, "phi_k": 0, "v_x": 0, "v_z": 0, "w_h": 0, "w_k": 0}
    stated = "[optimize.initial_guess]\n" + "".join(f"{name} = {value}\n" for name, value in guess.items())
    return text.replace("[optimize.mpcc]", stated + "[optimize.mpcc]")


def row_of(intervals, result):
    certificate, statistics = result["certificate"], result["statistics"]
    iterations = max(statistics["iterations"], 1)
    foot = [row[0] for row in result["trajectory"]["outputs"]]
    verification = result.get("verification") or {}
    return [intervals, result["status"]["termination"], result["objective"], statistics["iterations"],
            statistics["wall_seconds"], 1e3 * statistics["wall_seconds"] / iterations,
            certificate["primal_infeasibility"], certificate["complementarity_residual"], certificate["stationarity"],
            min(foot), verification.get("interval_defect"), result["final"]["x"][0]]


def run(arguments, intervals, folder):
    table, model, out = folder / "reference.csv", folder / "monoped.toml", folder / "result.json"
    table.write_text(reference.table(intervals), encoding="utf-8")
    model.write_text(model_text(arguments, intervals, table), encoding="utf-8")
    out.unlink(missing_ok=True)
    subprocess.run([arguments.saltus, "optimize", model, "--quiet", "--out", out, "--time-limit", str(arguments.seconds),
                    "--set", "optimize.native=on", "--set", f"optimize.mpcc.iteration_limit={arguments.iterations}"],
                   check=False)
    return row_of(intervals, json.loads(out.read_text(encoding="utf-8")))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("saltus")
    parser.add_argument("--intervals", type=int, nargs="+", default=[30, 40, 50, 60, 70, 80, 90])
    parser.add_argument("--start", choices=["rest", "reference"], default="rest")
    parser.add_argument("--terminal-weight", choices=["1", "T/N"], default="1")
    parser.add_argument("--rho", type=float, default=0.01)
    parser.add_argument("--seconds", type=float, default=600)
    parser.add_argument("--iterations", type=int, default=30000)
    arguments = parser.parse_args()
    print("| " + " | ".join(COLUMNS) + " |")
    print("|---" * len(COLUMNS) + "|", flush=True)
    with tempfile.TemporaryDirectory(prefix="monoped-") as folder:
        for intervals in arguments.intervals:
            row = run(arguments, intervals, pathlib.Path(folder))
            cells = [f"{x:.3g}" if isinstance(x, float) else str(x) for x in row]
            print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
