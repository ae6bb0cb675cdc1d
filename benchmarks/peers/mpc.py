#!/usr/bin/env python3
"""B4: closed loops on problems of nosnoc's MPC set: `saltus optimize` from its last solution, a warm-started homotopy of CasADi and Ipopt.

    python3 benchmarks/peers/mpc.py          writes benchmarks/results/mpc.md
"""

import common

TEXT = """
Both contenders control the same plant, the event engine with the model as it is, and solve the same discretisation: `cart-pole` with friction 3, horizon 1, 10 intervals of two elements of
Radau IIA with one stage, 30 samples; `acrobot` with friction in both joints, horizon 2, 20 intervals of two elements with two stages, 10 samples. Times are CPU time of one control, without the
first. *Saltus* solves to a certified point and verifies it by simulation, each time from the model: there is no prepared controller in this version. *Homotopy*: the solver is built once;
sigma = 1e-2, 1e-4, 1e-6 from the last solution. The cost is the sum over samples of the running cost times the sampling time.
nosnoc 0.2.0 on PyPI has no controller: its row would be the homotopy's. `finger-spinner` and `two-discs` need contacts in the loop and are not run: not yet stated here.
"""
COLUMNS = {"problem": "problem", "contender": "controller", "status": "status", "samples": "samples", "unsolved": "not solved", "cost": "closed-loop cost", "median": "median, ms", "largest": "largest, ms"}


def main():
    rows = []
    for problem in ("cart-pole", "acrobot"):
        for contender in ("saltus", "homotopy"):
            found = common.run("Saltus", "mpc_loop.py", problem, contender, limit=240)
            rows += [{"problem": problem, "contender": contender, **row} for row in found]
    common.write("mpc", "Closed loops of model predictive control", TEXT, rows, COLUMNS)


if __name__ == "__main__":
    main()
