"""Event-driven integration with Taylor series at any precision: the engine behind make_references.py."""

from dataclasses import dataclass, field
from typing import Callable

import mpmath
from mpmath import mp, mpf


# ---------------------------------------------------------------------------------------------------------- Taylor series
class Series:
    """A power series in the time since the start of the step; coefficients are worked out when first asked for.

    rule(k) gives coefficient k from those before it, so that x' = f(x) defines its own solution: coefficient k + 1 of x
    needs coefficient k of f only.
    """

    def __init__(self, coefficients, rule=None):
        self.c, self.rule = list(coefficients), rule

    def __getitem__(self, k):
        while len(self.c) <= k:
            self.c.append(self.rule(len(self.c)))
        return self.c[k]

    def to(self, length):
        """With at least so many coefficients worked out."""
        self[length - 1]
        return self

    @staticmethod
    def lift(value):
        return value if isinstance(value, Series) else Series([mpf(value)], lambda k: mpf(0))

    def __add__(self, other):
        other = Series.lift(other)
        return Series([], lambda k: self[k] + other[k])

    __radd__ = __add__

    def __neg__(self):
        return Series([], lambda k: -self[k])

    def __sub__(self, other):
        other = Series.lift(other)
        return Series([], lambda k: self[k] - other[k])

    def __rsub__(self, other):
        return Series.lift(other) - self

    def __mul__(self, other):
        if not isinstance(other, Series):
            return Series([], lambda k: self[k] * other)

        def rule(k):
            self[k], other[k]
            return mpmath.fdot(self.c[: k + 1], other.c[k::-1])

        return Series([], rule)

    __rmul__ = __mul__

    def __truediv__(self, other):
        if not isinstance(other, Series):
            return Series([], lambda k: self[k] / other)
        quotient = Series([])

        def rule(k):
            other[k]
            known = mpmath.fdot(other.c[1 : k + 1], quotient.c[k - 1 :: -1]) if k else mpf(0)
            return (self[k] - known) / other.c[0]

        quotient.rule = rule
        return quotient

    def __rtruediv__(self, other):
        return Series.lift(other) / self

    def at(self, h):
        return mpmath.polyval(self.c[::-1], h)

    def derivative(self):
        return Series([k * a for k, a in enumerate(self.c)][1:])


def sine_cosine(t, scale, length):
    """The series of sin and cos of scale*(t + h)."""
    s, c = mpmath.sin(scale * t), mpmath.cos(scale * t)
    cycle_s, cycle_c = (s, c, -s, -c), (c, -s, -c, s)
    factor, sines, cosines = mpf(1), [], []
    for k in range(length):
        sines.append(cycle_s[k % 4] * factor)
        cosines.append(cycle_c[k % 4] * factor)
        factor = factor * scale / (k + 1)
    return Series(sines), Series(cosines)


# --------------------------------------------------------------------------------------------------------------- problems
@dataclass
class Problem:
    """x' = f(t, x, alpha) with psi_j(t, x); every alpha enters affinely, and sliding surfaces do not act on each other.

    `f` and `psi` work on numbers and on Series alike; t is (t, sin, cos) of a clock with the given frequency. Functions
    of psi beyond `names` are kinks and time events: the series start anew there, and nothing is listed. `watched` are the
    [[events]]: functions of (t, x) and the direction that counts (1, -1, or 0 for both).
    """

    model: str
    names: list
    x0: Callable
    f: Callable
    psi: Callable
    psi_dot: Callable  # (t, x, xdot) -> time derivatives of all psi
    until: Callable
    source: str
    case: str = ""
    overrides: dict = field(default_factory=dict)
    initial_mode: dict = field(default_factory=dict)
    frequency: int = 1
    model_until: bool = True
    max_step: float = 1.0
    unique: bool = True
    alternatives: list = field(default_factory=list)
    watched: list = field(default_factory=list)


@dataclass
class Explicit:
    """A problem whose solution is written down: a function that returns what solve() does."""

    model: str
    solution: Callable
    source: str = "closed form"
    case: str = ""
    overrides: dict = field(default_factory=dict)
    initial_mode: dict = field(default_factory=dict)


class Clock:
    """The time as number or series, with sin and cos of frequency*t."""

    def __init__(self, t, sin, cos):
        self.t, self.sin, self.cos = t, sin, cos


def clock_at(t, frequency):
    return Clock(t, mpmath.sin(frequency * t), mpmath.cos(frequency * t))


def clock_series(t, frequency, length):
    s, c = sine_cosine(t, frequency, length)
    return Clock(Series([t, mpf(1)] + [mpf(0)] * (length - 2)) if length > 1 else Series([t]), s, c)


def alphas(problem, clock, x, mode):
    """alpha_j is 0 or 1 off the surface; on it, it makes psi_j stationary (affine in alpha_j)."""
    fixed = [mpf(1) if k > 0 else mpf(0) for k in mode]
    result = list(fixed)
    for j, k in enumerate(mode):
        if k == 0:
            below, above = (
                problem.psi_dot(clock, x, problem.f(clock, x, fixed[:j] + [side] + fixed[j + 1 :]))[j]
                for side in (mpf(0), mpf(1))
            )
            result[j] = below / (below - above)
    return result


class Step:
    """The Taylor polynomials of one step from (t, x) in a mode, and the length on which they are exact to rounding."""

    def __init__(self, problem, t, x, mode, degree):
        self.t, self.mode = t, mode
        length = degree + 1
        clock = clock_series(t, problem.frequency, length)
        self.x = [Series([value]) for value in x]
        self.alpha = self.selections(problem, clock)
        for series, rate in zip(self.x, problem.f(clock, self.x, self.alpha)):
            series.rule = lambda k, rate=Series.lift(rate): rate[k - 1] / k
        for k in range(length):
            for series in self.x:
                series.to(k + 1)
        self.psi = [psi.to(length) for psi in problem.psi(clock, self.x)]
        self.watched = [(function(clock, self.x).to(length), direction) for function, direction in problem.watched]
        for alpha in self.alpha:
            if isinstance(alpha, Series):
                alpha.to(length)
        self.h = self.safe_length(degree, mpf(problem.max_step))

    def selections(self, problem, clock):
        return alphas(problem, clock, self.x, self.mode)

    def safe_length(self, degree, longest):
        """The last two terms stay below rounding, for the states and what the events are found from."""
        h = longest
        scale = max([mpf(1)] + [abs(s.c[0]) for s in self.x])
        seen = self.x + list(self.psi) + [a for a in self.alpha if isinstance(a, Series)]
        for series in seen + [function for function, _ in self.watched]:
            for k in (degree - 1, degree):
                if k < len(series.c) and series.c[k] != 0:
                    h = min(h, (mpf(10) ** (-mp.dps + 1) * scale / abs(series.c[k])) ** (mpf(1) / k))
        return h * mpf("0.9")


SAMPLES = 240


def first_root(series, h):
    """The first root of a polynomial in (0, h], or None. Roots at 0 itself, simple or double, are divided out."""
    tiny = mpf(10) ** (-mp.dps + 12)
    scale = max(abs(a) * h**k for k, a in enumerate(series.c))
    if scale == 0:
        return None
    c = list(series.c)
    while c and abs(c[0]) <= tiny * scale:
        c = c[1:]
        scale = max((abs(a) * h**k for k, a in enumerate(c)), default=mpf(0))
        if scale == 0:
            return None
    values = [float(a * h**k / scale) for k, a in enumerate(c)]
    previous = None
    for i in range(SAMPLES + 1):
        s = i / SAMPLES
        value = 0.0
        for a in reversed(values):
            value = value * s + a
        if previous is not None and (previous > 0) != (value > 0):
            return polish(c, h * (i - 1) / SAMPLES, h * mpf(i) / SAMPLES)
        previous = value
    return None


def polish(c, low, high):
    """A root between low and high, by bisection and Newton's method."""
    value = lambda t: mpmath.polyval(c[::-1], t)
    slope = [k * a for k, a in enumerate(c)][1:]
    low, high = mpf(low), mpf(high)
    sign = value(low) > 0
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if (value(middle) > 0) == sign else (low, middle)
    root = (low + high) / 2
    for _ in range(4):
        root -= value(root) / mpmath.polyval(slope[::-1], root)
    return root


# ----------------------------------------------------------------------------------------------------------------- solver
def decide(problem, t, x, mode, j):
    """The side(s) the solution goes to from psi_j = 0: +1, -1, 0 (sliding) or None (both sides repel)."""
    clock = clock_at(t, problem.frequency)
    current = alphas(problem, clock, x, [k if i != j else 1 for i, k in enumerate(mode)])
    rates = []
    for side in (mpf(0), mpf(1)):
        current[j] = side
        rates.append(problem.psi_dot(clock, x, problem.f(clock, x, current))[j])
    tiny = mpf(10) ** (-mp.dps // 2)
    if all(abs(r) < tiny for r in rates):
        return side_by_series(problem, t, x, mode, j)
    below, above = (mpmath.sign(r) if abs(r) >= tiny else 0 for r in rates)
    if below > 0 and above < 0:
        return 0
    if below < 0 and above > 0:
        return None
    return 1 if below + above > 0 else -1


def side_by_series(problem, t, x, mode, j):
    """Both normal velocities vanish (as at a start of relay-oscillator type): the first nonzero Taylor term decides."""
    sides = []
    for k in (-1, 1):
        psi = Step(problem, t, x, mode[:j] + [k] + mode[j + 1 :], 8).psi[j]
        sides.append(next(mpmath.sign(c) for c in psi.c if abs(c) > mpf(10) ** (-mp.dps // 2)))
    assert sides[0] == sides[1], "needs a decision of higher order"
    return int(sides[0])


def kind_of(before, after):
    enters = any(b != 0 and a == 0 for b, a in zip(before, after))
    leaves = any(b == 0 and a != 0 for b, a in zip(before, after))
    return {(True, False): "enter_sliding", (False, True): "leave_sliding", (True, True): "change_sliding"}.get(
        (enters, leaves), "crossing"
    )


def start(problem, t, x):
    """The first mode, and the event of a start on a surface."""
    psi = problem.psi(clock_at(t, problem.frequency), x)
    on = [abs(value) < mpf(10) ** (-mp.dps + 5) for value in psi]
    mode = [0 if o else int(mpmath.sign(value)) for o, value in zip(on, psi)]
    for j, o in enumerate(on):
        if o:
            decided = decide(problem, t, x, [k or 1 for k in mode], j)
            # a repelling surface: the default continues to psi > 0
            mode[j] = problem.initial_mode.get(problem.names[j], 1 if decided is None else decided)
    surfaces = [name for name, o in zip(problem.names, on) if o]
    if not surfaces:
        return mode, []
    listed = mode[: len(problem.names)]
    event = dict(t=t, kind="start", surfaces=surfaces, mode_before=None, mode_after=listed, x=list(x))
    if not problem.unique:
        event.update(unique=False, alternatives=problem.alternatives)
    return mode, [event]


def next_event(step):
    """(h, surface, side where its alpha ends) of the first event, without a surface if it is watched; or None."""
    found = []
    for j, k in enumerate(step.mode):
        if k != 0:
            root = first_root(step.psi[j], step.h)
            found.append((root, j, None))
        elif isinstance(step.alpha[j], Series):
            found.append((first_root(step.alpha[j], step.h), j, -1))
            found.append((first_root((1 - step.alpha[j]).to(len(step.alpha[j].c)), step.h), j, 1))
    for function, direction in step.watched:
        root = first_root(function, step.h)
        if root is not None and direction * function.derivative().at(root) >= 0:
            found.append((root, None, None))
    found = [entry for entry in found if entry[0] is not None]
    return min(found, default=None, key=lambda entry: entry[0])


def solve(problem, degree):
    if isinstance(problem, Explicit):
        return problem.solution()
    t, x = mpf(0), [mpf(value) for value in problem.x0()]
    until = mpf(problem.until())
    mode, events = start(problem, t, x)
    listed = len(problem.names)
    while t < until:
        step = Step(problem, t, x, mode, degree)
        h = min(step.h, until - t)
        event = next_event(step)
        if event is None or event[0] > h:
            t, x = (until if h == until - t else t + h), [series.at(h) for series in step.x]
            continue
        h, j, side = event
        t, x = t + h, [series.at(h) for series in step.x]
        if j is None:
            events.append(dict(t=t, kind="user", surfaces=[], mode_before=mode[:listed], mode_after=mode[:listed], x=list(x)))
            continue
        after = list(mode)
        after[j] = side if side is not None else decide(problem, t, x, mode, j)
        assert after[j] is not None, "a solution cannot reach a repelling surface"
        if j < listed:
            events.append(
                dict(t=t, kind=kind_of(mode, after), surfaces=[problem.names[j]], mode_before=mode[:listed],
                     mode_after=after[:listed], x=list(x))
            )
        mode = after
    final_alpha = alphas(problem, clock_at(t, problem.frequency), x, mode)
    return dict(events=events, final=dict(t=t, x=x, mode=mode[:listed], alpha=final_alpha[:listed]))
