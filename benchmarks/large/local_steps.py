#!/usr/bin/env python3
"""What steps of a part of a large system are worth: an experiment for decision record 25.

A chain of N blocks with a relay each, q_i'' = q_{i-1} - 2.5 q_i + q_{i+1} - 0.3 sign(q_i), followed to t = T by steps of
length h of the method of Dormand and Prince with its continuous output.

  all     a switch of one block ends the step of all blocks
  d = k   a switch of block i ends the steps of blocks i - k ... i + k only: they go on to the end of the step with the
          continuous output of the others

The error is that of the end state against steps of h / 8; the cost is the number of evaluations of one block.
"""
import argparse

import numpy as np

C = np.array([0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0])
A = [[], [1 / 5], [3 / 40, 9 / 40], [44 / 45, -56 / 15, 32 / 9],
     [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
     [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656]]
B = np.array([35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84])
D = np.array([-12715105075 / 11282082432, 0, 87487479700 / 32700410799, -10690763975 / 1880347072,
              701980252875 / 199316789632, -1453857185 / 822651844, 69997945 / 29380423])


class Piece:
    """Continuous output of blocks lo ... hi - 1 from t to t + h."""

    def __init__(self, t, h, lo, y, y_end, slopes):
        self.t, self.h, self.lo, self.hi = t, h, lo, lo + y.shape[1]
        rise = y_end - y
        start = h * slopes[0] - rise
        self.r = (y, rise, start, rise - h * slopes[6] - start, h * np.tensordot(D, slopes, 1))

    def at(self, t, blocks):
        s = (t - self.t) / self.h
        a, b, c, d, e = (r[:, blocks - self.lo] for r in self.r)
        return a + s * (b + (1 - s) * (c + s * (d + (1 - s) * e)))


class Chain:
    def __init__(self, n, relay=0.3):
        i = np.arange(1, n + 1)
        self.n, self.relay, self.cost = n, relay, 0
        self.y = np.array([np.sin(1.7 * i), 0.5 * np.cos(2.3 * i)])
        self.sign = np.sign(self.y[0])

    def rates(self, y, sign, left, right):
        q = np.concatenate(([left], y[0], [right]))
        self.cost += y.shape[1]
        return np.array([y[1], q[:-2] - 2.5 * y[0] + q[2:] - self.relay * sign])

    def step(self, t, h, lo, y, neighbour):
        """One step of blocks lo ...; neighbour(block, t) is q of one that is not among them."""
        hi = lo + y.shape[1]
        sign = self.sign[lo:hi]
        side = lambda block, at: neighbour(block, at) if 0 <= block < self.n else 0.0
        slopes = []
        for c, row in zip(C, A):
            stage = y + h * sum((a * k for a, k in zip(row, slopes)), np.zeros_like(y))
            at = t + c * h
            slopes.append(self.rates(stage, sign, side(lo - 1, at), side(hi, at)))
        end = y + h * np.tensordot(B, np.array(slopes), 1)
        slopes.append(self.rates(end, sign, side(lo - 1, t + h), side(hi, t + h)))
        return Piece(t, h, lo, y, end, np.array(slopes)), end


def first_zero(piece, blocks, signs, begin):
    """First time behind `begin` at which a q has left the side it should be on, and its block."""
    times = np.linspace(begin, piece.t + piece.h, 9)[1:]
    best = None
    before = begin
    for at in times:
        wrong = blocks[piece.at(at, blocks)[0] * signs < 0]
        for block in wrong:
            lo, hi = before, at
            one = np.array([block])
            while hi - lo > 1e-15 * max(1.0, hi):
                middle = 0.5 * (lo + hi)
                if middle in (lo, hi):
                    break
                if piece.at(middle, one)[0, 0] * signs[block - blocks[0]] < 0:
                    hi = middle
                else:
                    lo = middle
            if best is None or hi < best[0]:
                best = (hi, block)
        if best:
            return best
        before = at
    return None


def run(n, until, h, reach):
    """@return end state, evaluations of blocks, switches. reach None: all blocks are restarted."""
    chain = Chain(n)
    t, switches = 0.0, 0
    every = np.arange(n)
    while t < until - 1e-12:
        end_t = min(t + h, until)
        whole, end = chain.step(t, end_t - t, 0, chain.y, None)
        if reach is None:
            found = first_zero(whole, every, chain.sign, t)
            if found is None:
                chain.y, t = end, end_t
                continue
            t_switch, block = found
            chain.y = whole.at(t_switch, every)
            chain.sign[block] *= -1
            t, switches = t_switch, switches + 1
            continue
        pieces = [[whole] for _ in range(n)]  # by block, in time

        def value(block, at):
            piece = next(p for p in reversed(pieces[block]) if p.t <= at or p is pieces[block][0])
            return piece.at(at, np.array([block]))[:, 0]

        zeros = {}
        for block in every:
            zero = first_zero(whole, np.array([block]), chain.sign[block:block + 1], t)
            if zero:
                zeros[block] = zero[0]
        while zeros:
            block = min(zeros, key=zeros.get)
            at = zeros.pop(block)
            chain.sign[block] *= -1
            switches += 1
            lo, hi = max(0, block - reach), min(n, block + reach + 1)
            y = np.array([value(b, at) for b in range(lo, hi)]).T
            if end_t - at < 1e-14:
                continue
            part, _ = chain.step(at, end_t - at, lo, y, lambda b, s: value(b, s)[0])
            for b in range(lo, hi):
                pieces[b].append(part)
                zeros.pop(b, None)
                zero = first_zero(part, np.array([b]), chain.sign[b:b + 1], at)
                if zero:
                    zeros[b] = zero[0]
        chain.y = np.array([value(b, end_t) for b in range(n)]).T
        t = end_t
    return chain.y, chain.cost, switches


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--until", type=float, default=5.0)
    parser.add_argument("--step", type=float, default=0.1)
    parser.add_argument("sizes", type=int, nargs="*", default=[20, 80, 320])
    arguments = parser.parse_args()
    print("| N | blocks restarted | switches | evaluations of a block / (N T / h) | error |")
    print("|---|---|---|---|---|")
    for n in arguments.sizes:
        reference, _, _ = run(n, arguments.until, arguments.step / 8, None)
        for reach in (None, 1, 2, 3, 4, 6):
            y, cost, switches = run(n, arguments.until, arguments.step, reach)
            name = "all" if reach is None else f"d = {reach}"
            share = cost / (n * arguments.until / arguments.step)
            print(f"| {n} | {name} | {switches} | {share:.1f} | {np.abs(y - reference).max():.1e} |", flush=True)


if __name__ == "__main__":
    main()
