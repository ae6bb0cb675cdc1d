"""The network of 500 thresholds: ten proteins in a ring, fifty thresholds each, of which the trajectory meets two.

Every protein activates the next one, the last one represses the first; each protein decays. A threshold acts on the
next protein only, never on its own one, so nothing slides. Around two thresholds within its range each protein has 24
below and 24 above it; they act weakly and are never met. Run as a program it prints the model file:

    python3 benchmarks/compare/gene_ring.py > gene-ring.toml
    python3 benchmarks/compare/gene_ring.py 0 > gene-ring-active.toml      without the thresholds that are never met
"""

import sys
from decimal import Decimal

PROTEINS = 10
INACTIVE = 24  # on each side of the active ones
UNTIL = 100


class Network:
    """All numbers are decimals with at most four digits, so that text, Python and C++ mean the same doubles."""

    basal = Decimal("0.05")
    weight_inactive = Decimal("0.002")
    weight_active = Decimal("0.5")

    def __init__(self, inactive_each_side=INACTIVE):
        self.inactive = inactive_each_side
        self.start = [100 + 80 * i for i in range(PROTEINS)]  # thousandths
        self.decay = [Decimal(50 + 3 * i % 10) / 50 for i in range(PROTEINS)]
        self.thresholds = [self.of_protein(i) for i in range(PROTEINS)]
        # Without the inactive thresholds their constant part stays, so that both networks have the same solution.
        constant = self.weight_inactive * (INACTIVE - inactive_each_side)
        self.constant = [self.basal + constant] * PROTEINS

    def of_protein(self, i):
        below = [Decimal(j + 1) / 1000 for j in range(self.inactive)]
        active = [Decimal(400 + 7 * i) / 1000, Decimal(600 + 5 * i) / 1000]
        above = [Decimal(2050 + 50 * j) / 1000 for j in range(self.inactive)]
        return below + active + above

    def weight(self, j):
        return self.weight_active if j in (self.inactive, self.inactive + 1) else self.weight_inactive

    def levels_of(self, x):
        return [sum(own > threshold for threshold in self.thresholds[i]) for i, own in enumerate(x)]

    def production(self, levels):
        """Of every protein, where `levels` counts the thresholds below each."""
        drive = [sum(self.weight(j) for j in range(level)) for level in levels]
        most = sum(self.weight(j) for j in range(2 * self.inactive + 2))
        return [self.constant[0] + most - drive[-1]] + [c + d for c, d in zip(self.constant[1:], drive)]

    def next_threshold(self, i, level, rising):
        j = level if rising else level - 1
        return self.thresholds[i][j] if 0 <= j < len(self.thresholds[i]) else None


def term(network, protein, repressing):
    """What a protein adds to the production of the next one."""

    def steps(indices):
        thresholds = [network.thresholds[protein][j] for j in indices]
        return " + ".join(f"{'(1 - ' if repressing else ''}step(x{protein} - {threshold})"
                          f"{')' if repressing else ''}" for threshold in thresholds)

    k = network.inactive
    inactive = [*range(k), *range(k + 2, 2 * k + 2)]
    weak = f" + {network.weight_inactive}*({steps(inactive)})" if inactive else ""
    return f"{network.weight_active}*({steps((k, k + 1))}){weak}"


def model_file(network):
    total = sum(len(thresholds) for thresholds in network.thresholds)
    lines = ["[model]", f'name = "gene-ring-{total}"', f'description = "a ring of ten genes with {total} thresholds"',
             "", "[states]"]
    lines += [f"x{i} = {Decimal(start) / 1000}" for i, start in enumerate(network.start)]
    lines += ["", "[dynamics]"]
    for i in range(PROTEINS):
        production = term(network, (i - 1) % PROTEINS, repressing=i == 0)
        lines.append(f'x{i} = "{network.constant[i]} + {production} - {network.decay[i]}*x{i}"')
    return "\n".join([*lines, "", "[simulate]", f"until = {UNTIL}.0", ""])


if __name__ == "__main__":
    print(model_file(Network(int(sys.argv[1]) if len(sys.argv) > 1 else INACTIVE)), end="")
