#!/usr/bin/env python3
"""B7: derivatives of an end state through switches and jumps; Saltus, diffrax, jaxonomy against closed forms.

    python3 benchmarks/peers/gradients.py          writes benchmarks/results/gradients.md
"""

import collections

import common
from gradients_problems import PROBLEMS

TEXT = """
The derivative of one component of the state at the end by an initial value or a parameter. Every problem is written as a user would: `sign`, `if` in Saltus, `where` and `sign` of
JAX in the others, each with its default solver at tolerances of 1e-8 (diffrax: Tsit5 with PID controller, through `jax.grad`). *Right*: to 1e-4 of the closed form.
*Refused*: the program says that it cannot, or has no way to state it without code that finds events and starts again. *Stopped*: more than 100 000 steps. Saltus: `fesd` with `sensitivities`, 20 steps, three stages.
"""
COLUMNS = {"problem": "problem", "by": "derivative of", "exact": "closed form", "peer": "program", "value": "value", "verdict": "verdict", "seconds": "CPU s"}


def verdict(row, exact):
    if "value" not in row:
        return row.get("status", "refused")
    return "right" if abs(row["value"] - exact) <= 1e-4 * max(1.0, abs(exact)) else "wrong"


def counted(rows, peer):
    """ "5 right, 2 refused" """
    verdicts = collections.Counter(row["verdict"].partition(":")[0] for row in rows if row["peer"] == peer)
    return ", ".join(f"{count} {verdict}" for verdict, count in verdicts.items())


def main():
    found = {"Saltus": common.run("Saltus", "gradients_saltus.py"), "diffrax": common.run("diffrax", "gradients_diffrax.py", limit=580)}
    found["jaxonomy"] = [{"status": "not installed" if common.python_of("jaxonomy") is None else "not run: no runner yet"}]
    rows = []
    for name, problem in PROBLEMS.items():
        for peer, own in found.items():
            has_form = peer == "Saltus" or "[[jumps]]" not in problem["text"] or "problem" not in own[0]
            ended = next((row for row in own if "problem" not in row and has_form), {"status": "refused"})
            row = next((row for row in own if row.get("problem") == name), ended)
            row = {**row, "problem": name, "by": problem["by"], "exact": problem["exact"], "peer": peer, "verdict": verdict(row, problem["exact"])}
            rows.append(row)
    counts = "; ".join(f"{peer}: {counted(rows, peer)}" for peer in found)
    common.write("gradients", "Derivatives through switches", TEXT + f"\nOf {len(PROBLEMS)} problems: {counts}.\n", rows, COLUMNS)


if __name__ == "__main__":
    main()
