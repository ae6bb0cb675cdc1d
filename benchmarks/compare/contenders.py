"""Who takes part in the comparison, how each one is started, and what has to be built before."""

import dataclasses
import datetime
import json
import os
import pathlib
import platform
import subprocess

import gene_ring

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BUILD = ROOT / "build" / "benchmarks"
MODELS = BUILD / "models"
PLUGIN = BUILD / "siconos_plugin.so"
CACHE = BUILD / "cache"  # of Saltus' native code; emptied before a run
DEBIAN_PYTHON = "/usr/bin/python3"

PROBLEMS = ("irma", "stick-slip", "relay-feedback", "gene-ring")
NETWORKS = ("irma", "gene-ring", "gene-ring-active")
TOLERANCES = tuple(10.0**-k for k in range(4, 13))
# Lengths of the steps of time stepping: they divide the time span, so that the last step ends at its end.
STEPS = {"irma": (1.0, 0.25, 0.1, 0.025), "stick-slip": (0.04, 0.01, 0.004),
         "relay-feedback": (1e-2, 1e-3, 1e-4, 2.5e-5), "gene-ring": (0.1, 0.01, 0.004, 0.002)}


@dataclasses.dataclass(frozen=True)
class Contender:
    """One row of the table for every problem that `problems` lists."""

    name: str
    method: str
    variant: str
    command: tuple
    problems: tuple = PROBLEMS
    time_stepping: bool = False
    missing: str = ""  # why it cannot run

    def sweep(self, problem):
        return STEPS[problem] if self.time_stepping else TOLERANCES

    def run(self, problem, seconds, tolerances, timeout):
        """One dictionary for every tolerance; fewer if the time is up."""
        if self.name == "Saltus":
            what = str(MODELS / f"{problem}.toml")
        elif self.variant == "active relays":
            what = f"{problem}-active"  # the same solution
        else:
            what = problem
        command = [*self.command, what, self.method, self.variant, repr(seconds), *map(repr, tolerances)]
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "XDG_CACHE_HOME": str(CACHE),
                       "COMPARE_SICONOS_PLUGIN": str(PLUGIN)}
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
        try:
            output, errors = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            process.kill()
            output, errors = process.communicate()
        else:
            if process.returncode != 0:
                raise RuntimeError(f"{' '.join(command)}:\n{errors}")
        return [json.loads(line) for line in output.splitlines() if line.startswith("{") and line.endswith("}")]


def succeeds(*command):
    """False also where there is no such program."""
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except FileNotFoundError:
        return False


def build(folder, programs=("compare_saltus", "compare_hand", "compare_cvode")):
    """Configures and builds the programs; returns the folder they lie in."""
    prefix = sorted(ROOT.glob(".venv/lib/python3*/site-packages/casadi/cmake"))
    if not (folder / "CMakeCache.txt").exists():
        subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        "-DSALTUS_BENCHMARKS=ON", f"-DCMAKE_PREFIX_PATH={';'.join(map(str, prefix))}"], check=True)
    targets = subprocess.run(["cmake", "--build", folder, "--target", "help"], capture_output=True, text=True,
                             check=True).stdout
    wanted = [name for name in programs if f"{name}:" in targets]
    subprocess.run(["cmake", "--build", folder, "-j", "1", "--target", *wanted], check=True)
    return folder / "benchmarks" / "compare"


def write_models():
    """The model files of the four problems, each with the end of the comparison."""
    MODELS.mkdir(parents=True, exist_ok=True)
    for problem, until in (("irma", 1000.0), ("stick-slip", 1000.0), ("relay-feedback", 10.0)):
        lines = (ROOT / "models" / f"{problem}.toml").read_text().splitlines()
        changed = [f"until = {until}" if line.startswith("until") else line for line in lines]
        (MODELS / f"{problem}.toml").write_text("\n".join(changed) + "\n")
    for problem, inactive in (("gene-ring", gene_ring.INACTIVE), ("gene-ring-active", 0)):
        (MODELS / f"{problem}.toml").write_text(gene_ring.model_file(gene_ring.Network(inactive)))


def build_plugin():
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", HERE / "siconos_plugin.c", "-o", PLUGIN], check=True)


def line_up(programs):
    """All contenders, those that are not installed with the reason."""
    hand, cvode, saltus = (programs / f"compare_{name}" for name in ("hand", "cvode", "saltus"))
    scipy_python = BUILD / "venv" / "bin" / "python3"
    no_cvode = "" if cvode.exists() else "not installed"
    no_scipy = "" if succeeds(scipy_python, "-c", "import scipy") else "not installed"
    no_siconos = "" if succeeds(DEBIAN_PYTHON, "-c", "import siconos.kernel") else "not installed"
    if not no_siconos:
        build_plugin()
    scipy = (str(scipy_python), str(HERE / "scipy_runner.py"))
    siconos = (DEBIAN_PYTHON, str(HERE / "siconos_runner.py"))
    contenders = []
    for method in ("dopri5", "dop853", "taylor"):
        contenders.append(Contender("Saltus", method, "native", (str(saltus),)))
    for variant in ("interpreted", "trajectory"):
        for method in ("dop853", "taylor"):
            contenders.append(Contender("Saltus", method, variant, (str(saltus),)))
    for method in ("dopri5", "dop853"):
        contenders.append(Contender("by hand", method, "relevant", (str(hand),)))
        contenders.append(Contender("by hand", method, "all", (str(hand),), ("irma", "gene-ring")))
    for method in ("adams", "bdf"):
        contenders.append(Contender("CVODE", method, "relevant", (str(cvode),), missing=no_cvode))
        contenders.append(Contender("CVODE", method, "all", (str(cvode),), ("gene-ring",), missing=no_cvode))
    for method in ("dopri5", "dop853"):
        contenders.append(Contender("SciPy", method, "relevant", scipy, missing=no_scipy))
    contenders.append(Contender("Siconos", "midpoint", "relays", siconos, ("irma", "stick-slip", "relay-feedback"),
                                time_stepping=True, missing=no_siconos))
    # With all 500 relays a step takes a tenth of a second: ten minutes for an error of 0.1.
    contenders.append(Contender("Siconos", "midpoint", "active relays", siconos, ("gene-ring",), time_stepping=True,
                                missing=no_siconos))
    return contenders


def machine():
    """Processor, compiler, revision and day of this run."""
    model = "unknown processor"
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    compiler = subprocess.run(["c++", "--version"], capture_output=True, text=True, check=False).stdout
    revision = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty=, changed"],
                              capture_output=True, text=True, check=False).stdout.strip()
    compiler = compiler.splitlines()[0] if compiler else "no compiler"
    return f"{model}, {os.cpu_count()} processors, {platform.system()}, {compiler}, revision {revision}, {datetime.date.today()}"
