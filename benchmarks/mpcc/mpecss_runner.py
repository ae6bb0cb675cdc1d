"""One JSON file of NOSBENCH with PyPI's mpecss: prints a line of JSON. Run by run.py, in the environment that has mpecss."""

import json
import logging
import sys
import time

import numpy
from mpecss.helpers.loaders.nosbench_loader import load_nosbench
from mpecss.phase_2.mpecss import run_mpecss

logging.disable(logging.CRITICAL)


def main(file, limit):
    problem = load_nosbench(file)
    start = numpy.asarray(problem["x0_fn"](0), dtype=float).flatten()
    before = time.process_time()
    found = run_mpecss(problem, start, {"wall_timeout": limit})
    seconds = time.process_time() - before
    z = numpy.asarray(found["z_final"], dtype=float).flatten()
    sides = [numpy.asarray(problem[key](z), dtype=float).flatten() - numpy.asarray(problem[bound], dtype=float).flatten()
             for key, bound in (("G_fn", "lbG_eff"), ("H_fn", "lbH_eff"))]
    low, high = (numpy.asarray(problem[key], dtype=float).flatten() for key in ("lbx", "ubx"))
    worst = max(numpy.max(numpy.minimum(abs(sides[0]), abs(sides[1])), initial=0.0), *(numpy.max(-side, initial=0.0) for side in sides),
                numpy.max(low - z, initial=0.0), numpy.max(z - high, initial=0.0))
    done = found["status"] == "converged"
    print(json.dumps({"status": "completed" if done else str(found["status"]), "objective": float(found["f_final"]),
                      "violation": float(worst), "seconds": seconds, "iterations": int(found.get("n_outer_iters", 0))}))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
