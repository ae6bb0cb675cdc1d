#!/usr/bin/env python3
"""B6: error over time of bodies that hit the ground: falling rod, rocking block, bouncing chain; Saltus, MuJoCo, Drake, Siconos, SciPy.

    python3 benchmarks/peers/contact_precision.py          writes benchmarks/results/contact-precision.md
"""

import shutil

import common

TEXT = """
`rod`: `models/falling-rod.toml` to t = 1, error of x, z, phi. `block`: a block of 0.2 m x 1 m, released at 0.1 rad, rocks on its two edges without rebound, to t = 2, error of its angle. `chain`: three
balls of 1 kg on springs (400 N/m, 0.2 m) fall from 0.5 m and bounce with restitution 0.5, to t = 1.5, error of the heights. The reference of each is Saltus at rtol 1e-13; its own errors are
differences from that run. For `chain` SciPy confirms it to 14 digits where its steps are short; with longer ones a restart on the ground is taken for a hit, or a bounce is stepped over, and no tolerance mends that. Rigid contact is the model that all are measured against: MuJoCo's and Drake's
contacts are soft by design, so what is left at their smallest step is that difference, not a mistake. MuJoCo's chain is left out, as it has no restitution of a given size. CPU seconds without building.
"""
COLUMNS = {"problem": "problem", "peer": "program", "setting": "setting", "status": "status", "error": "error", "seconds": "CPU s"}


def main():
    rows = common.run("Saltus", "contact_precision_saltus.py") + common.run("MuJoCo", "contact_precision_mujoco.py")
    rows += common.run("SciPy", "contact_precision_scipy.py")
    for peer, module in (("Drake", "pydrake"), ("Siconos", "siconos")):
        python = common.python_of(peer) if peer in common.PEERS else shutil.which("python3")
        is_there = python is not None and common.contenders.succeeds(str(python), "-c", f"import {module}")
        rows.append({"problem": "all", "peer": peer, "status": "not run: no runner yet" if is_there else "not installed"})
    reference = {row["problem"]: row["values"] for row in rows if row.get("setting") == "reference"}
    for row in rows:
        if "values" in row and row["problem"] in reference:
            row["error"] = max(abs(a - b) for a, b in zip(row["values"], reference[row["problem"]], strict=True))
    rows = sorted((row for row in rows if row.get("setting") != "reference"), key=lambda row: row.get("problem", "~"))
    common.write("contact-precision", "Error over time with contacts", TEXT, rows, COLUMNS)


if __name__ == "__main__":
    main()
