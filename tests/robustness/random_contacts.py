"""Random bodies with random contacts: nothing passes through, no energy comes from nowhere, every run ends.

usage: random_contacts.py [--runs 10000] [--first 1] [--also 683 …] [--until 5] [--rtol 1e-9] [--outcomes]

Run number k has 1 to 4 positions in a potential well, a random mass matrix, and 1 to 4 contacts with sloped and curved
gaps: without friction, with one tangent or with two, mu in [0, 2], e in [0, 1]. The checker shares nothing with the
engine: it reads the rows of the trajectory and the events.
  gap >= -1e-12 and force >= 0 in every row, to the rounding of its time;
  the energy of no row is above that of an earlier one (the well's forces have a potential), but for the tolerance;
  open contacts have no force, closed ones no gap, sticking ones no tangential velocity, all friction is in its cone,
  that of a slip on its edge and against the velocity;
  an impact changes velocities by its impulses, leaves no approach behind and makes no energy, to rounding;
  a status of its own for what has no solution (jamming, Painleve), never an end of the steps.
With --outcomes nothing is checked, and each run has a line of outcomes.hpp (outcomes.py compares them).
"""

import argparse
import collections
import random
import sys
import time

import numpy as np
import saltus

import outcomes


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
        mass = self.mass = factor @ factor.T + 0.3 * np.eye(self.count)
        self.slopes, self.tangents, self.friction = [], [], []
        pull = [dice.uniform(-1, 1) for _ in q]
        potential = sum(0.5 * p * p + a * p for p, a in zip(q, pull))
        model.mechanics(q, v, mass=mass.tolist(), potential=potential)
        for k in range(self.contacts):
            self.add_contact(dice, f"c{k}")

    def add_contact(self, dice, name):
        """Gap with a slope and a curvature; tangents that are not parallel to the normal where there are as many axes."""
        q = self.q
        distance, slopes = dice.uniform(0.05, 0.5), [dice.uniform(-1, 1) for _ in q]
        gap = distance + 0.1 * q[0] ** 2 + sum(slope * p for slope, p in zip(slopes, q))
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
        self.slopes.append(slopes)
        self.tangents.append(np.array(rows).reshape(tangents, self.count))
        self.friction.append(friction)
        self.model.contact(name, gap=gap, **options)

    def normal(self, k, q):
        normal = np.array(self.slopes[k])
        normal[0] += 0.2 * q[0]
        return normal


def along(run, name, tangents):
    """A tangential vector of a contact in all rows."""
    return np.array([run[f"{name}[{i + 1}]" if tangents == 2 else name] for i in range(tangents)]).T


def faults_of_modes(bodies, run, rows, tolerance):
    """Between events: whether forces, gaps and velocities are those of the modes."""
    found = []
    times = [event.t for event in run.events]
    t, x = np.asarray(run.t)[:rows], np.asarray(run.x)[:rows]
    piece = np.searchsorted(times, t)
    inside = ~np.isin(t, times)
    for k in range(bodies.contacts):
        modes = [run.events[0].contact_modes_before if times else ["open"] * bodies.contacts]
        mode = np.array([m[k] for m in modes + [event.contact_modes_after for event in run.events]])[piece]
        gap, force = np.asarray(run[f"gap(c{k})"])[:rows], np.asarray(run[f"force(c{k})"])[:rows]
        size = 1 + np.abs(force)
        if (np.abs(force) > 0)[inside & (mode == "open")].any():
            found.append(f"c{k} is open and has a force")
        if (np.abs(gap) > 1e-12)[inside & (mode != "open")].any():
            found.append(f"c{k} is closed and has a gap of {np.abs(gap[inside & (mode != 'open')]).max():.1e}")
        rows_of = bodies.tangents[k]
        if not len(rows_of):
            continue
        v = x[:, bodies.count : 2 * bodies.count]
        slip, terms = v @ rows_of.T, np.abs(v) @ np.abs(rows_of).T
        friction = along(run, f"friction(c{k})", len(rows_of))[:rows]
        limit, strength = bodies.friction[k] * force, np.linalg.norm(friction, axis=1)
        sticks, slips = inside & (mode == "stick"), inside & (mode == "slip")
        if (np.abs(slip) > 1e-15 + 1e-14 * terms)[sticks].any():
            found.append(f"c{k} sticks at {np.abs(slip[sticks]).max():.1e}")
        if (strength > limit + tolerance * size)[inside].any():
            found.append(f"friction of c{k} leaves its cone by {(strength - limit)[inside].max():.1e}")
        if (np.abs(strength - limit) > tolerance * size)[slips].any():
            found.append(f"c{k} slips with {np.abs(strength - limit)[slips].max():.1e} too much or little friction")
        if (np.sum(friction * slip, axis=1) > tolerance * size)[slips].any():
            found.append(f"friction of c{k} drives its slip")
    return found


def faults_of_impacts(bodies, run):
    """Velocities behind impacts by their impulses, from the mass matrix."""
    found = []
    n = bodies.count
    for event in run.events:
        if event.kind != "impact":
            continue
        q, before, after = event.x[:n], event.x[n : 2 * n], event.x_after[n : 2 * n]
        push = np.zeros(n)
        for k, impulse in enumerate(event.impulse):
            push += impulse[0] * bodies.normal(k, q) + np.array(impulse[1 : 1 + len(bodies.tangents[k])]) @ bodies.tangents[k]
            if impulse[0] < -1e-12:
                found.append(f"an impact at {event.t} pulls c{k} by {impulse[0]:.1e}")
            closed = event.contact_modes_after[k] != "open" or impulse[0] > 0
            if closed and bodies.normal(k, q) @ after < -1e-9 * (1 + np.abs(before).max()):
                found.append(f"behind an impact at {event.t} c{k} closes at {bodies.normal(k, q) @ after:.1e}")
        change = bodies.mass @ (after - before)
        # A slip in a plane begins with a speed whose direction is known.
        starts = any(len(rows) == 2 for rows in bodies.tangents)
        allowed = 1e-9 * (1 + np.abs(push).max() + np.abs(before).max()) + (2e-6 if starts else 0)
        if np.abs(change - push).max() > allowed:
            found.append(f"an impact at {event.t} is not that of its impulses, by {np.abs(change - push).max():.1e}")
        grown = after @ bodies.mass @ after - before @ bodies.mass @ before
        if grown > 1e-11 * (before @ bodies.mass @ before) + allowed**2:
            found.append(f"energy grows by {grown:.1e} in an impact at {event.t}")
    return found


def within_rounding_of_time(t, values):
    """How much values change, from one row to the next, while times are the same to their rounding."""
    steps = np.diff(t, prepend=t[:1])
    with np.errstate(divide="ignore", invalid="ignore"):
        rates = np.abs(np.diff(values, prepend=values[:1])) / steps
    return np.where(steps > 0, rates, 0.0) * 2 * np.spacing(t)


def faults_of(bodies, run, tolerance=1e-7):
    """What a run did that bodies do not do."""
    if not np.isfinite(np.asarray(run.x)).all():
        return ["a state is not finite"]
    found = []
    has_limits = any(event.kind == "accumulation" for event in run.events)  # which are extrapolated
    rows = len(run.t) - (0 if run.status.done else 1)  # where nothing follows there are no forces
    energy = np.asarray(run["energy"])
    if (np.diff(energy) > tolerance * (1 + np.abs(energy[:-1]))).any():
        found.append(f"energy grows by {np.diff(energy).max():.1e}")
    for k in range(bodies.contacts):
        gap, force = np.asarray(run[f"gap(c{k})"]), np.asarray(run[f"force(c{k})"])[:rows]
        if gap.min() < -1e-12 - 1e-10 * has_limits:
            found.append(f"gap of c{k} is {gap.min():.1e}")
        if (force < -tolerance - within_rounding_of_time(np.asarray(run.t)[:rows], force)).any():
            found.append(f"force of c{k} is {force.min():.1e}")
    return found + faults_of_modes(bodies, run, rows, tolerance) + faults_of_impacts(bodies, run)


def print_outcomes(seeds, settings):
    print("seed,status,events,kinds,hash,times,end,x")
    for seed in seeds:
        run = Bodies(seed).model.simulate(**settings)
        print(outcomes.line_of(seed, str(run.status), run.events, run.final.x), flush=True)


def check(seeds, settings):
    """Runs, judges, prints what is wrong and a summary; returns the exit code."""
    fates = collections.Counter()
    bad = []
    slowest = (0.0, 0)
    for seed in seeds:
        bodies = Bodies(seed)
        begin = time.perf_counter()
        run = bodies.model.simulate(**settings)
        slowest = max(slowest, (time.perf_counter() - begin, seed))
        fates[str(run.status)] += 1
        faults = faults_of(bodies, run)
        if str(run.status) not in ("completed", "outside_class"):
            faults.append(f"{run.status}: {run.status.message}")
        if faults:
            bad.append(seed)
            print(f"{seed}: {bodies.count} positions, {bodies.contacts} contacts: {'; '.join(faults)}", flush=True)
    print(f"{len(seeds)} runs: {dict(fates)}; {len(bad)} with faults; slowest {slowest[0]:.2f} s (run {slowest[1]})")
    return 1 if bad else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10000)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--also", type=int, nargs="*", default=[])
    parser.add_argument("--until", type=float, default=5.0)
    parser.add_argument("--rtol", type=float)
    parser.add_argument("--outcomes", action="store_true")
    arguments = parser.parse_args()
    settings = {"until": arguments.until, "max_steps": 200000}
    if arguments.rtol:
        settings["rtol"] = arguments.rtol
    seeds = [*range(arguments.first, arguments.first + arguments.runs), *arguments.also]
    return print_outcomes(seeds, settings) if arguments.outcomes else check(seeds, settings)


if __name__ == "__main__":
    sys.exit(main())
