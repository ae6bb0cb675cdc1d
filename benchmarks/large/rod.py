#!/usr/bin/env python3
"""Measures the heated rod against SciPy and CVODE: rod.py TOOL [--cells 1000] [--repeats 3] [--python PYTHON]

PYTHON has SciPy (benchmarks/compare installs one), g++ finds SUNDIALS with KLU (libsundials-dev of Debian). Every way
runs at several tolerances, in turns; times are of the processor, with reading and building the model in those of Saltus.
The error is the largest one of a switching time, against Saltus at rtol = 1e-12. Prints the table of results/rod.md.
"""
import argparse
import json
import os
import pathlib
import resource
import statistics
import subprocess
import tempfile

import large_models
import run

HERE = pathlib.Path(__file__).resolve().parent
TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10)


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, done.stdout


def by_saltus(tool, model, integrator, state):
    def measure(rtol, folder):
        out = folder / "rod.json"
        command = [tool, "simulate", model, "--quiet", "--method", "event", "--integrator", integrator, "--rtol", str(rtol),
                   "--atol", str(1e-2 * rtol), "--set", "simulate.native=off", "--set", f'simulate.output={{ states = ["{state}"] }}',
                   "--out", str(out)]
        seconds, _ = processor_seconds(command)
        result = json.loads(out.read_text(encoding="utf-8"))
        return seconds, result["statistics"]["steps"], [event["t"] for event in result["events"]]

    return measure


def by_program(*command):
    def measure(rtol, _):
        text = subprocess.run([*command, str(rtol)], check=True, capture_output=True, text=True).stdout
        lines = [line.split() for line in text.splitlines()]
        values = {key: float(value) for key, value in lines if key != "switch"}
        return values["seconds"], int(values["steps"]), [float(value) for key, value in lines if key == "switch"]

    return measure


def row(measure, rtol, repeats, reference, folder):
    runs = [measure(rtol, folder) for _ in range(repeats)]
    _, steps, switches = runs[0]
    error = max(abs(a - b) for a, b in zip(switches, reference)) if len(switches) == len(reference) else None
    return statistics.median(seconds for seconds, _, _ in runs), steps, len(switches), error


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--cells", type=int, default=1000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--python", default=str(HERE.parents[1] / "build/benchmarks/venv/bin/python3"))
    arguments = parser.parse_args()
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        model = folder / "rod.toml"
        model.write_text(large_models.text(arguments.tool, "rod", arguments.cells), encoding="utf-8")
        state = f"u{arguments.cells}"
        cvode = folder / "rod_cvode"
        subprocess.run(["g++", "-O3", "-march=native", HERE / "rod_cvode.cpp", "-I/usr/include/suitesparse", "-o", cvode,
                        "-lsundials_cvode", "-lsundials_nvecserial", "-lsundials_sunlinsolklu",
                        "-lsundials_sunmatrixsparse", "-lklu", "-lm"], check=True)
        ways = {"Saltus, radau13": by_saltus(arguments.tool, model, "radau13", state),
                "Saltus, radau9": by_saltus(arguments.tool, model, "radau9", state),
                "CVODE, BDF, KLU": by_program(str(cvode), str(arguments.cells)),
                "SciPy, BDF, sparse": by_program(arguments.python, str(HERE / "rod_scipy.py"), str(arguments.cells))}
        _, _, reference = by_saltus(arguments.tool, model, "radau13", state)(1e-12, folder)
        print(f"{run.machine()}; {arguments.cells} cells, {len(reference)} switches to t = 5\n")
        print("| way | rtol | seconds | steps | switches | largest error of a time |\n|---|---|---|---|---|---|")
        for way, measure in ways.items():
            for rtol in TOLERANCES:
                seconds, steps, switches, error = row(measure, rtol, arguments.repeats, reference, folder)
                text = "not all switches" if error is None else f"{error:.1e}"
                print(f"| {way} | {rtol:.0e} | {seconds:.2f} | {steps} | {switches} | {text} |", flush=True)


main()
