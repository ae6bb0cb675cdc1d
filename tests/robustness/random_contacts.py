"""Random bodies with random contacts: nothing passes through, no energy comes from nowhere, every run ends.

usage: random_contacts.py [--runs 10000] [--first 1] [--until 5]

Run number k has 1 to 4 positions in a potential well, a random mass matrix, and 1 to 4 contacts with sloped and curved
gaps: without friction, with one tangent or with two, mu in [0, 2], e in [0, 1]. The checker shares nothing with the
engine: it reads the rows of the trajectory.
  gap >= -1e-12 and force >= 0 in every row;
  the energy of no row is above that of an earlier one (the well's forces have a potential), but for the tolerance;
  a status of its own for what has no solution (jamming, Painleve), never an end of the steps.
"""

import argparse
import collections
import random
import sys
import time

import numpy as np
import saltus


class Bodies:
    """A model and what the checker needs of it."""

    def __init__(self, seed):
        self.seed = seed
        dice = random.Random(seed)
        self.count = dice.randint(1, 4)
        self.contacts = dice.randint(1, 4)
        model = self.model = saltus.Builder("bodies")
        q = self.q = [model.state(f"q{i}", 0) for i in range(self.count)]
        v = self.v = [model.state(f"v{i}", dice.uniform(-1, 1)) for i in range(self.count)]
        factor = np.array([[dice.uniform(-1, 1) for _ in q] for _ in q])
        mass = factor @ factor.T + 0.3 * np.eye(self.count)
        pull = [dice.uniform(-1, 1) for _ in q]
        potential = sum(0.5 * p * p + a * p for p, a in zip(q, pull))
        model.mechanics(q, v, mass=mass.tolist(), potential=potential)
        for k in range(self.contacts):
            self.add_contact(dice, f"c{k}")

    def add_contact(self, dice, name):
        """Gap with a slope and a curvature; tangents that are not parallel to the normal where there are as many axes."""
        q = self.q
        gap = dice.uniform(0.05, 0.5) + 0.1 * q[0] ** 2 + sum(dice.uniform(-1, 1) * p for p in q)
        tangents = min(dice.choice([0, 1, 1, 2]), self.count - 1)
        rows = [[dice.uniform(-1, 1) for _ in q] for _ in range(tangents)]
        friction = dice.uniform(0, 2) if tangents else 0.0
        options = {"restitution": dice.choice([0.0, dice.uniform(0, 1)])}
        if tangents:
            options["friction"] = friction
        if tangents == 1:
            options["tangent"] = dict(zip(q, rows[0]))
        if tangents == 2:
            options["tangents"] = [dict(zip(q, row)) for row in rows]
        self.model.contact(name, gap=gap, **options)


def faults_of(bodies, run, tolerance=1e-7):
    """What a run did that bodies do not do."""
    if not np.isfinite(np.asarray(run.x)).all():
        return ["a state is not finite"]
    found = []
    rows = len(run.t) - (0 if run.status.done else 1)  # where nothing follows there are no forces
    energy = np.asarray(run["energy"])
    if (np.diff(energy) > tolerance * (1 + np.abs(energy[:-1]))).any():
        found.append(f"energy grows by {np.diff(energy).max():.1e}")
    for k in range(bodies.contacts):
        gap, force = np.asarray(run[f"gap(c{k})"]), np.asarray(run[f"force(c{k})"])[:rows]
        if gap.min() < -1e-12:
            found.append(f"gap of c{k} is {gap.min():.1e}")
        if force.min() < -tolerance:
            found.append(f"force of c{k} is {force.min():.1e}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10000)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--until", type=float, default=5.0)
    arguments = parser.parse_args()
    outcomes = collections.Counter()
    bad = []
    slowest = (0.0, 0)
    for seed in range(arguments.first, arguments.first + arguments.runs):
        bodies = Bodies(seed)
        begin = time.perf_counter()
        run = bodies.model.simulate(until=arguments.until, max_steps=200000)
        slowest = max(slowest, (time.perf_counter() - begin, seed))
        outcomes[str(run.status)] += 1
        faults = faults_of(bodies, run)
        if str(run.status) not in ("completed", "outside_class"):
            faults.append(f"{run.status}: {run.status.message}")
        if faults:
            bad.append(seed)
            print(f"{seed}: {bodies.count} positions, {bodies.contacts} contacts: {'; '.join(faults)}", flush=True)
    print(f"{arguments.runs} runs: {dict(outcomes)}; {len(bad)} with faults; slowest {slowest[0]:.2f} s (run {slowest[1]})")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
