#!/usr/bin/env python3
"""B3: model predictive control of a linear cart-pole between soft walls; Saltus, ADMM over OSQP, branch and bound over HiGHS.

    python3 benchmarks/peers/soft_walls.py          writes benchmarks/results/soft-walls.md
"""

import common

TEXT = """
A pole (0.411 kg, centre 0.4267 m, tip 0.6 m) on a cart (0.978 kg), linear about its upright position, with the tip between walls at +-0.35 m that push with 100 N/m.
Control for 0.01 s each, horizon of 10, Q = diag(10, 2, 1, 1), R = 1, terminal cost of the Riccati equation without walls. From (0.1, 0.05, 1.2, 0.4), for 0.6 s. All programs control
one plant (explicit steps of 0.1 ms of the same equations); the cost is the sum of z'Qz + u'Ru over samples. Times are CPU time of one control, without the first.
The first control says how near a program is to the optimum of its horizon, which branch and bound gives; the closed-loop cost of a horizon this short is no
measure of that. *ADMM*: consensus between a QP (OSQP, warm start) and the projection of pairs, 10 iterations (`soft_walls_peers.py`). *Branch and bound*: mixed-integer
optimum over QPs of HiGHS, which solves none with integers itself. *Saltus*: `optimize` from the last solution with its branch first; each call solves, certifies and verifies,
as there is no prepared controller yet.
"""
COLUMNS = {"peer": "program", "method": "method", "status": "status", "samples": "samples", "first": "first control", "cost": "closed-loop cost", "median": "median, ms", "largest": "largest, ms"}


def main():
    rows = common.run("Saltus", "soft_walls_saltus.py", limit=240)
    rows += common.run("OSQP", "soft_walls_peers.py", "admm", limit=240)
    rows += common.run("HiGHS", "soft_walls_peers.py", "branch", limit=240)
    common.write("soft-walls", "Control between soft walls", TEXT, rows, COLUMNS)


if __name__ == "__main__":
    main()
