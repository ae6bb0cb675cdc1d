"""Models with regions by `indicator`, for make_references.py: the Taylor series of taylor_events.py, with the weights of
the active regions from the equality of their indicators, and the next regions from Stewart's complementarity system."""

from dataclasses import dataclass
from itertools import combinations

import mpmath
from mpmath import mp, mpf
from taylor_events import Explicit, Problem, Series, Step, clock_at, first_root

SOURCE = "Taylor series of degree 40 and 52 with 40 and 50 digits; weights and regions by Stewart's conditions"


def determinant(rows):
    """By the first row: entries are numbers or Series."""
    if len(rows) == 1:
        return rows[0][0]
    minors = [determinant([row[:k] + row[k + 1 :] for row in rows[1:]]) for k in range(len(rows))]
    total = rows[0][0] * minors[0]
    for k in range(1, len(rows)):
        term = rows[0][k] * minors[k]
        total = total - term if k % 2 else total + term
    return total


def equal_rates(rates, active):
    """theta over `active` with sum 1 and equal sum_j w_ij theta_j, by Cramer's rule."""
    first, others = active[0], active[1:]
    if not others:
        return [mpf(1)]
    # unknown theta_j of the others, theta of the first 1 less these
    change = lambda i, j: rates[i][j] - rates[first][j]
    matrix = [[change(i, j) - change(i, first) for j in others] for i in others]
    right = [-change(i, first) for i in others]
    whole = determinant(matrix)
    theta = [determinant([row[:k] + [r] + row[k + 1 :] for row, r in zip(matrix, right)]) / whole
             for k in range(len(others))]
    rest = mpf(1)
    for weight in theta:
        rest = rest - weight
    return [rest] + theta


@dataclass
class RegionProblem(Problem):
    """x' = f(t, x, theta); `g_dot(t, x, xdot)` are the rates of the indicators `psi`. `hidden` states behind those of
    the model serve the series only."""

    hidden: int = 0

    def rates(self, c, x):
        """w_ij: the rate of indicator i along the field of region j."""
        n = len(self.names)
        unit = lambda j: [mpf(1) if i == j else mpf(0) for i in range(n)]
        columns = [self.psi_dot(c, x, self.f(c, x, unit(j))) for j in range(n)]
        return [[columns[j][i] for j in range(n)] for i in range(n)]

    def weights(self, c, x, active):
        theta = [mpf(0)] * len(self.names)
        for j, weight in zip(active, equal_rates(self.rates(c, x), active)):
            theta[j] = weight
        return theta

    def next_regions(self, c, x, tied):
        """The one subset of `tied` that satisfies theta > 0 and w_i > mu elsewhere."""
        rates = self.rates(c, x)
        found = []
        for size in range(1, len(tied) + 1):
            for active in combinations(tied, size):
                try:
                    theta = equal_rates(rates, list(active))
                except ZeroDivisionError:
                    continue  # not determined
                total = lambda i: sum(rates[i][j] * weight for j, weight in zip(active, theta))
                others = [total(i) - total(active[0]) for i in tied if i not in active]
                if all(value > mpf(10) ** (-mp.dps // 2) for value in [*theta, *others]):
                    found.append(active)
        assert len(found) == 1, found
        return found[0]

    def event(self, t, x, kind, before, after, surfaces):
        return dict(t=t, kind=kind, surfaces=surfaces, mode_before=[] if before else None, mode_after=[],
                    x=x[: len(x) - self.hidden], regions_after=[[self.names[j] for j in after]])

    def solve(self, degree):
        t, x, until = mpf(0), [mpf(value) for value in self.x0()], mpf(self.until())
        values = self.psi(clock_at(t, 1), x)
        tied = [j for j, value in enumerate(values) if value - min(values) < mpf(10) ** (-mp.dps + 5)]
        active = self.next_regions(clock_at(t, 1), x, tied)
        events = []
        if len(tied) > 1:
            events.append(self.event(t, x, "start", None, active, [self.names[j] for j in tied]))
        while t < until:
            step = RegionStep(self, t, x, active, degree)
            h = min(step.h, until - t)
            found = [entry for entry in step.ends() if entry[0] is not None and entry[0] <= h]
            if not found:
                t, x = (until if h == until - t else t + h), [series.at(h) for series in step.x]
                continue
            h, region, comes = min(found, key=lambda entry: entry[0])
            t, x = t + h, [series.at(h) for series in step.x]
            if comes:
                after = self.next_regions(clock_at(t, 1), x, sorted([*active, region]))
            else:
                after = tuple(j for j in active if j != region)
            came, went = set(after) - set(active), set(active) - set(after)
            kind = "enter_sliding" if not went else "leave_sliding" if not came else "change_sliding"
            if len(came) == len(went) == len(after) == 1:
                kind = "crossing"
            events.append(self.event(t, x, kind, active, after, [self.names[j] for j in sorted(came | went)]))
            active = after
        theta = self.weights(clock_at(t, 1), x, active)
        return dict(events=events, final=dict(t=t, x=x[: len(x) - self.hidden], mode=[], alpha=[],
                                              regions=[[self.names[j] for j in active]], theta=theta))


class RegionStep(Step):
    """The Taylor polynomials of one step while the regions `mode` are active."""

    def selections(self, problem, clock):
        return problem.weights(clock, self.x, self.mode)

    def ends(self):
        """(h, region, whether it comes) of every region that ties with the active ones, or loses its weight."""
        for j, indicator in enumerate(self.psi):
            if j not in self.mode:
                ahead = (indicator - self.psi[self.mode[0]]).to(len(indicator.c))
                yield first_root(ahead, self.h), j, True
            elif isinstance(self.alpha[j], Series):
                yield first_root(self.alpha[j], self.h), j, False


def decimal(text):
    return mpf(text)


def empty_circle():
    stations = [(0, 0), (4, 0), (1, 3)]

    def f(c, x, theta):
        pushes = [[(x[k] - a[k]) / x[2 + i] for k in range(2)] for i, a in enumerate(stations)]
        v = [sum(weight * push[k] for weight, push in zip(theta, pushes)) for k in range(2)]
        v[0] = v[0] + c.t * c.t / 100
        # the distances to the stations, so that no root is needed
        return v + [((x[0] - a[0]) * v[0] + (x[1] - a[1]) * v[1]) / x[2 + i] for i, a in enumerate(stations)]

    start = lambda: [decimal("0.6"), decimal("0.2")]
    distances = lambda x: [mpmath.sqrt((x[0] - a) ** 2 + (x[1] - b) ** 2) for a, b in stations]
    return RegionProblem(
        model="empty-circle", names=["south_west", "south_east", "north"], x0=lambda: start() + distances(start()), f=f,
        psi=lambda c, x: [x[2 + i] * x[2 + i] for i in range(3)],
        psi_dot=lambda c, x, v: [2 * ((x[0] - a) * v[0] + (x[1] - b) * v[1]) for a, b in stations],
        until=lambda: 10, source=SOURCE, max_step=0.2, hidden=3,
    )


def frozen_hysteresis():
    """Sliding on the two lines is the thermostat itself; a transfer at speed 5/2 takes 2/5, and the clock stands still.
    The fields of "to_on" and "to_off" vanish where a line ends: to stay there is another solution."""
    names = ["on", "to_on", "to_off", "off"]
    heat = lambda level, time: 50 + (level - 50) * mpmath.exp(-time / 5)

    def event(kind, surfaces, after, t, x, **more):
        return dict(t=t, kind=kind, surfaces=surfaces, mode_before=None if kind == "start" else [], mode_after=[], x=list(x),
                    regions_after=[after], **more)

    def solution():
        t, clock, until = mpf(0), mpf(0), mpf(4)
        events = [event("start", names[:2], names[:2], t, [mpf(15), mpf(0), clock])]
        level, w = mpf(15), mpf(0)
        while True:
            heated = w == 0
            phase = 5 * mpmath.log((50 - level) / 30) if heated else 5 * mpmath.log(level / 18)
            if t + phase > until:
                break
            level, line = (mpf(20), names[:3]) if heated else (mpf(18), names[1:])
            t, clock = t + phase, clock + phase
            stays = dict(unique=False, alternatives=[dict(mode=[], alpha=[])])
            events.append(event("change_sliding", line, [names[2 if heated else 1]], t, [level, w, clock], **stays))
            t, w = t + mpf(2) / 5, 1 - w
            line = names[2:] if heated else names[:2]
            events.append(event("enter_sliding", [line[1] if heated else line[0]], line, t, [level, w, clock]))
        x = [heat(level, until - t) if w == 0 else level * mpmath.exp((t - until) / 5), w, clock + until - t]
        theta = [mpf("0.5") * (1 - w)] * 2 + [mpf("0.5") * w] * 2
        return dict(events=events, final=dict(t=until, x=x, mode=[], alpha=[], regions=[names[:2] if w == 0 else names[2:]],
                                              theta=theta))

    return Explicit(model="frozen-hysteresis", solution=solution)


def three_windings():
    half = lambda: mpmath.sqrt(3) / 2
    directions = lambda: [(mpf(1), mpf(0)), (decimal("-0.5"), half()), (decimal("-0.5"), -half())]
    amplitude = lambda: decimal("0.8")

    def f(c, x, theta):
        fed = [2 * sum(weight * d[k] for weight, d in zip(theta, directions())) for k in range(2)]
        return [fed[0] - x[0], fed[1] - x[1], fed[0] * x[0] + fed[1] * x[1]]

    def psi(c, x):
        error = amplitude() * c.cos - x[0], amplitude() * c.sin - x[1]
        return [-(a * error[0] + b * error[1]) for a, b in directions()]

    def psi_dot(c, x, v):
        error = -amplitude() * c.sin - v[0], amplitude() * c.cos - v[1]
        return [-(a * error[0] + b * error[1]) for a, b in directions()]

    return RegionProblem(
        model="three-windings", names=["u", "v", "w"], x0=lambda: [decimal("-0.5"), decimal("0.2"), 0], f=f, psi=psi,
        psi_dot=psi_dot, until=lambda: 7, source=SOURCE, max_step=0.2,
    )


def problems():
    yield empty_circle()
    yield frozen_hysteresis()
    yield three_windings()
