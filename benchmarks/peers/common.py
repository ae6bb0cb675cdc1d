"""What the comparisons of this folder share: the environments of the peers, runs with a limit, and the page of results.

A runner is a Python file that prints one line of JSON per measurement. It runs in the environment of its peer
(scripts/install_benchmarks.sh). A peer that is not there gives one row "not installed".
"""

import datetime
import json
import os
import pathlib
import subprocess

import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
RESULTS = ROOT / "benchmarks" / "results"
sys.path.insert(0, str(HERE.parent / "compare"))
import contenders  # noqa: E402

# Peer: folder of its environment, module that shows that it is there.
PEERS = {"SciPy": ("venv", "scipy"), "OSQP": ("venv", "osqp"), "HiGHS": ("venv", "highspy"), "CasADi and Ipopt": ("venv", "casadi"),
         "mpecss": ("mpecss-venv", "mpecss"), "nosnoc": ("nosnoc-venv", "nosnoc"), "MuJoCo": ("mujoco-venv", "mujoco"),
         "Drake": ("drake-venv", "pydrake"), "diffrax": ("diffrax-venv", "diffrax"), "jaxonomy": ("jaxonomy-venv", "jaxonomy")}
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false", "JAX_PLATFORMS": "cpu"}


def python_of(peer):
    """The interpreter that has the peer, or None. Saltus is the package of the release build."""
    if peer == "Saltus":
        return ROOT / ".venv" / "bin" / "python3"
    folder, module = PEERS[peer]
    python = ROOT / "build" / "benchmarks" / folder / "bin" / "python3"
    return python if contenders.succeeds(python, "-c", f"import {module}") else None


def run(peer, script, *arguments, limit=120.0):
    """Rows (dictionaries) that a runner has printed within `limit` seconds; one row with `status` where there are none."""
    python = python_of(peer)
    if python is None:
        return [{"peer": peer, "status": "not installed"}]
    environment = {**os.environ, **ONE_THREAD, "PYTHONPATH": str(ROOT / "build" / "release" / "python") if peer == "Saltus" else ""}
    status, output, errors = "", "", ""
    try:
        done = subprocess.run([python, HERE / script, *map(str, arguments)], capture_output=True, text=True, env=environment, timeout=limit)
        output, errors = done.stdout, done.stderr
        status = "" if done.returncode == 0 else "failed"
    except subprocess.TimeoutExpired as ended:
        output, status = (ended.stdout or b"").decode(), f"more than {limit:g} s"
    rows = [{"peer": peer, **json.loads(line)} for line in output.splitlines() if line.startswith("{")]
    if status:
        print(f"{peer}, {script}: {status}\n{errors[-1500:]}")
        rows.append({"peer": peer, "status": status})
    return rows


def cell(value):
    if value is None:
        return "–"
    if isinstance(value, float):
        return f"{value:.3g}"
    return str(value)


def table(rows, columns):
    """Lines of a Markdown table; `columns` gives each key its title."""
    lines = ["| " + " | ".join(columns.values()) + " |", "|" + " --- |" * len(columns)]
    return lines + ["| " + " | ".join(cell(row.get(key)) for key in columns) + " |" for row in rows]


def write(name, title, text, rows, columns, output=RESULTS):
    """The page NAME.md: what was measured, machine, day and load, the table."""
    load = os.getloadavg()
    busy = " The machine was busy: times are upper bounds." if load[1] > 0.5 * (os.cpu_count() or 1) else ""
    lines = [f"# {title}", "", f"Made by `make benchmarks ONLY={name}` on {contenders.machine()}, {datetime.datetime.now():%H:%M}. "
             f"Load average of the last 1 and 5 minutes: {load[0]:.1f}, {load[1]:.1f}.{busy} How to read it: [benchmarks/README.md](../README.md#against-peers).",
             "", text.strip(), "", *table(rows, columns)]
    output.mkdir(parents=True, exist_ok=True)
    (output / f"{name}.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))
