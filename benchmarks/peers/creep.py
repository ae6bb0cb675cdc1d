#!/usr/bin/env python3
"""B5: what should rest rests. A block far inside its friction cone, a capsule pinched between two plates; Saltus, MuJoCo, Drake.

    python3 benchmarks/peers/creep.py          writes benchmarks/results/creep.md
"""

import common

TEXT = """
`slope`: a block of 1 kg (0.2 m x 0.1 m) lies on a slope of 0.2 rad, friction 1: friction needs a fifth of what it may have.
`pinch`: a capsule of 1 kg and radius 0.1 m is held between two plates by 50 N and friction 1: half of its weight per plate, a tenth of what it may have.
Creep is the mean speed from t = 1 to t = 5; a rigid body with Coulomb's friction has 0. CPU seconds are per simulated second, without building.
MuJoCo: elliptic cone, its recommended `impratio`s, Newton's solver. Drake: discrete plant, point contact, SAP solver.
"""
COLUMNS = {"problem": "problem", "peer": "program", "setting": "setting", "status": "status", "creep": "creep, m/s", "seconds": "CPU s per simulated s"}


def main():
    rows = common.run("Saltus", "creep_saltus.py") + common.run("MuJoCo", "creep_mujoco.py") + common.run("Drake", "creep_drake.py", limit=200)
    rows.sort(key=lambda row: row.get("problem", "~"))
    common.write("creep", "Creep of bodies at rest", TEXT, rows, COLUMNS)


if __name__ == "__main__":
    main()
