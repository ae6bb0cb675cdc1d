#!/usr/bin/env python3
"""Writes models of any size: large_models.py MODEL N [-o FILE] [--seed SEED]

MODEL is one of
  chain    N blocks in a row on springs, with dry friction on a belt of speed 0.2:
             q_i'' = q_{i-1} - 2 q_i + q_{i+1} - 0.5 q_i - sign(q_i' - 0.2)
  rod      a rod of N cells, heated at one end by a thermostat that feels its middle
  network  N genes; each is switched by three others at random thresholds
  ladder   N stages of inductor and capacitor, each fed by a relay that holds its voltage
"""
import argparse
import math
import random
import sys


def model_file(name, description, states, dynamics, until, simulate=()):
    lines = ["[model]", f'name = "{name}"', f'description = "{description}"', "", "[states]"]
    lines += [f"{state} = {value!r}" for state, value in states]
    lines += ["", "[dynamics]"]
    lines += [f'{state} = "{rate}"' for (state, _), rate in zip(states, dynamics)]
    lines += ["", "[simulate]", f"until = {until!r}", *simulate]
    return "\n".join(lines) + "\n"


def chain(n, _):
    states = [(f"q{i}", round(math.sin(1.7 * i), 6)) for i in range(1, n + 1)]
    states += [(f"v{i}", round(0.5 * math.cos(2.3 * i), 6)) for i in range(1, n + 1)]
    dynamics = [f"v{i}" for i in range(1, n + 1)]
    for i in range(1, n + 1):
        left = f"q{i - 1} " if i > 1 else ""
        right = f" + q{i + 1}" if i < n else ""
        dynamics.append(f"{left}- 2*q{i}{right} - 0.5*q{i} - sign(v{i} - 0.2)")
    return model_file(f"chain-{n}", f"{n} blocks on springs with dry friction", states, dynamics, 20.0)


def rod(n, _):
    # u_t = u_xx - u on (0, 1), flux at the left end switched by the middle. The heat needs n^2, the text stays linear.
    scale = float(n * n)
    states = [(f"u{i}", 0.0) for i in range(1, n + 1)]
    middle = (n + 1) // 2
    dynamics = []
    for i in range(1, n + 1):
        inflow = f"{scale!r}*(u{i - 1} - u{i})" if i > 1 else f"{float(n)!r}*4*step(0.5 - u{middle})"
        outflow = f" + {scale!r}*(u{i + 1} - u{i})" if i < n else ""
        dynamics.append(f"{inflow}{outflow} - 2*u{i}")
    return model_file(f"rod-{n}", f"heated rod of {n} cells with one thermostat", states, dynamics, 5.0,
                      ["", "[simulate.event]", 'integrator = "radau13"'])


def network(n, rng):
    states = [(f"x{i}", round(rng.uniform(0.0, 1.0), 6)) for i in range(1, n + 1)]
    dynamics = []
    # Two genes that switch each other may chatter faster and faster without an end (relative degree 2).
    inputs = {}
    for gene in range(1, n + 1):
        others = [k for k in rng.sample(range(1, n + 1), min(n, 12)) if gene not in inputs.get(k, ()) and k != gene]
        inputs[gene] = others[:3]
    for gene in range(1, n + 1):
        terms = []
        for source in inputs[gene]:
            threshold = round(rng.uniform(0.2, 0.8), 6)
            sign = rng.choice(("", "1 - "))
            terms.append(f"{round(rng.uniform(0.2, 0.5), 6)}*({sign}step(x{source} - {threshold}))")
        dynamics.append(" + ".join(terms))
    dynamics = [f"{rate or 0.5} - x{i}" for i, rate in enumerate(dynamics, 1)]
    return model_file(f"network-{n}", f"random network of {n} genes with three inputs each", states, dynamics, 100.0)


def ladder(n, rng):
    states = [(f"i{k}", 0.0) for k in range(1, n + 1)] + [(f"v{k}", 0.0) for k in range(1, n + 1)]
    targets = [round(rng.uniform(0.4, 0.6), 6) for _ in range(n)]
    dynamics = []
    for k in range(1, n + 1):
        before = f"0.2*v{k - 1} + " if k > 1 else ""
        dynamics.append(f"{before}2*step({targets[k - 1]} - v{k} - 0.5*i{k}) - v{k} - 0.1*i{k}")
    for k in range(1, n + 1):
        after = f" - 0.2*i{k + 1}" if k < n else ""
        dynamics.append(f"i{k}{after} - v{k}")
    return model_file(f"ladder-{n}", f"ladder of {n} converters with relays", states, dynamics, 10.0)


MODELS = {"chain": chain, "rod": rod, "network": network, "ladder": ladder}


def text(model, n, seed=1):
    return MODELS[model](n, random.Random(seed))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", choices=sorted(MODELS))
    parser.add_argument("n", type=int)
    parser.add_argument("-o", "--output")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    written = text(arguments.model, arguments.n, arguments.seed)
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            file.write(written)
    else:
        sys.stdout.write(written)


if __name__ == "__main__":
    main()
