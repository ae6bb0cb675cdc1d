"""Models with contacts for make_references.py, written down once more: Taylor series in every phase, impulses by the
momentum balance of an impact. The order of modes is written down with each problem, and every sign that it needs is checked."""

import itertools
from dataclasses import dataclass, field
from typing import Callable

import mpmath
from mpmath import mp, mpf
from series_functions import cos, sin
from taylor_events import Series


@dataclass
class Contact:
    """gap(q); row: its gradient; bias: d(row)/dt v; along, along_bias: the same of the tangent."""

    name: str
    gap: Callable
    row: Callable
    bias: Callable = lambda q, v: mpf(0)
    along: Callable = None
    along_bias: Callable = lambda q, v: mpf(0)
    mu: Callable = lambda: mpf(0)
    e: Callable = lambda: mpf(0)


@dataclass
class Phase:
    """modes: "open", "closed", "stick", "+" or "-" (the sign of the slip) by contact; it ends where `end` = (what, contact) falls
    through 0: what is "gap", "force" or "slip"; `touching`: contacts that take part in the impact then; `rests`: which leaves no velocity."""

    modes: dict
    end: tuple = None
    touching: tuple = ()
    rests: bool = False
    still: bool = False  # nothing moves


@dataclass
class ContactProblem:
    model: str
    until: Callable
    x0: Callable  # positions, then velocities
    mass: Callable  # diagonal
    force: Callable
    contacts: list
    phases: Callable  # an iterator of Phase
    case: str = ""
    overrides: dict = field(default_factory=dict)
    max_step: str = "0.0625"
    at_start: tuple = ()  # contacts that press on without a collision at the start
    source: str = "Taylor series of degree 40 and 52 with 40 and 50 digits in every phase, impulses by momentum balance"
    initial_mode = {}

    def solve(self, degree):
        t, x, events, until = mpf(0), [mpf(value) for value in self.x0()], [], mpf(self.until())
        if self.at_start:
            after = x[: len(x) // 2] + self.impact(x, self.at_start, pushed=self.at_start[0])
            events.append(self.event(t, "impact", self.at_start, x, after))
            events[-1]["mode_before"] = None  # as of a start
            x = after
        for phase, following in with_following(self.phases()):
            t, x, found = self.advance(phase, t, x, until, degree)
            if not found:
                break
            after, kind, names = self.behind(phase, x, following)
            events.append(self.event(t, kind, names, x, after))
            x = after
        assert t == until, (self.model, t)
        return dict(events=events, final=dict(t=t, x=x, mode=[], alpha=[]))

    @staticmethod
    def event(t, kind, names, x, after):
        return dict(t=t, kind=kind, surfaces=list(names), mode_before=[], mode_after=[], x=list(x), x_after=list(after))

    # ------------------------------------------------------------------------------------------------------------- motion
    def forces(self, phase, q, v):
        """(index of velocity -> acceleration, forces by contact), as series."""
        mass, force = self.mass(), self.force(q, v)
        unknowns = []  # (row that is held, its bias, what a unit of the force does to all velocities)
        for contact in self.contacts:
            mode = phase.modes.get(contact.name, "open")
            if mode == "open":
                continue
            row, acting = contact.row(q), contact.row(q)
            if mode in "+-":
                sign = 1 if mode == "+" else -1
                acting = [n - t * (sign * contact.mu()) for n, t in zip(row, contact.along(q))]
            unknowns.append((contact.name, row, contact.bias(q, v), acting))
            if mode == "stick":
                along = contact.along(q)
                unknowns.append((contact.name + " along", along, contact.along_bias(q, v), along))
        free = [f / m for f, m in zip(force, mass)]
        matrix = [[dot(row, [a / m for a, m in zip(acting, mass)]) for _, _, _, acting in unknowns] for _, row, _, _ in unknowns]
        right = [-(dot(row, free) + bias) for _, row, bias, _ in unknowns]
        found = eliminate(matrix, right)
        for (_, _, _, acting), value in zip(unknowns, found):
            free = [a + b * value / m for a, b, m in zip(free, acting, mass)]
        return free, {name: value for (name, _, _, _), value in zip(unknowns, found)}

    def advance(self, phase, t, x, until, degree):
        if phase.still:
            return until, x, False
        n = len(x) // 2
        armed = False
        while t < until:
            series = [Series([value]) for value in x]
            q, v = series[:n], series[n:]
            acceleration, forces = self.forces(phase, q, v)
            for s, rate in zip(series, v + acceleration):
                s.rule = lambda k, rate=Series.lift(rate): rate[k - 1] / k
            for k in range(degree + 1):
                for s in series:
                    s.to(k + 1)
            h = min(mpf(self.max_step), until - t, *[safe(s, degree) for s in series])
            guards = self.guards(phase, q, v, forces)
            zero = None
            for name, guard in guards.items():
                guard.to(degree + 1)
                s = first_fall(guard, h, armed or abs(guard[0]) > mpf(10) ** (-mp.dps // 2))
                if s is not None and (zero is None or s < zero[0]):
                    zero = (s, name)
            if zero is not None:
                assert zero[1] == phase.end, (self.model, "t =", t + zero[0], "ends", zero[1], "not", phase.end)
                return t + zero[0], self.projected(phase, [s.at(zero[0]) for s in series]), True
            armed = True
            t, x = (until if h == until - t else t + h), [s.at(h) for s in series]
        return t, x, False

    def guards(self, phase, q, v, forces):
        """All signs that the modes need, and what is to end the phase among them."""
        result = {}
        for contact in self.contacts:
            mode, name = phase.modes.get(contact.name, "open"), contact.name
            if mode == "open":
                result["gap", name] = Series.lift(contact.gap(q))
                continue
            result["force", name] = Series.lift(forces[name])
            if mode in ("+", "-"):
                slip = dot(contact.along(q), v)
                result["slip", name] = Series.lift(slip if mode == "+" else -slip)
            if mode == "stick" and contact.mu() > 0:
                for sign in (1, -1):
                    result["cone", name, sign] = Series.lift(forces[name] * contact.mu() - forces[name + " along"] * sign)
        return result

    def projected(self, phase, x):
        """What the modes say is 0, without the rounding of series."""
        return [mpf(0) if abs(value) < mpf(10) ** (-mp.dps + 8) else value for value in x]

    # ------------------------------------------------------------------------------------------------------------ impacts
    def behind(self, phase, x, following):
        what, name = phase.end
        if what != "gap":
            turns = what == "slip" and following.modes[name] in ("+", "-")
            return x, "slip" if turns else {"force": "lift_off", "slip": "stick"}[what], [name]
        n = len(x) // 2
        touching = [name, *phase.touching]
        names = [contact.name for contact in self.contacts if contact.name in touching]
        velocity = [mpf(0)] * n if phase.rests else self.impact(x, names)
        return x[:n] + velocity, "impact", names

    def impact(self, x, names, pushed=None):
        """Velocities behind: Newton's law without friction, Darboux and Keller's process with it or for several contacts."""
        n = len(x) // 2
        q, v, mass = x[:n], list(x[n:]), self.mass()
        contacts = [contact for contact in self.contacts if contact.name in names]
        rows = [[mpf(a) for a in contact.row(q)] for contact in contacts]
        if len(contacts) == 1 and contacts[0].mu() == 0:
            weight = sum(a * a / m for a, m in zip(rows[0], mass))
            impulse = -(1 + contacts[0].e()) * dot(rows[0], v) / weight
            return [b + impulse * a / m for a, b, m in zip(rows[0], v, mass)]
        assert all(contact.e() == 0 for contact in contacts)
        alongs = [[mpf(a) for a in contact.along(q)] if contact.mu() > 0 else None for contact in contacts]
        for _ in range(100):
            if pushed is None and all(dot(row, v) > -tiny() for row in rows):
                return v
            rate = self.rate(contacts, rows, alongs, mass, v, pushed)
            pushed = None
            ends = []
            for row in rows + [a for a in alongs if a is not None]:
                here, change = dot(row, v), dot(row, rate)
                if abs(here) > tiny() and here * change < 0:
                    ends.append(-here / change)
            v = [a + min(ends) * b for a, b in zip(v, rate)]
        raise AssertionError(self.model)

    @staticmethod
    def rate(contacts, rows, alongs, mass, v, pushed):
        """dv/dp where each contact pushes with 1 (closing), something in [0, 1] (at rest) or 0 (opening); the one that is consistent."""
        choices = []
        for contact, row, along in zip(contacts, rows, alongs):
            normal = dot(row, v)
            pushes = normal < -tiny() or contact.name == pushed
            normals = ["push"] if pushes else ["open"] if normal > tiny() else ["held", "open", "push"]
            slip = dot(along, v) if along is not None else mpf(0)
            slips = [None] if along is None else [int(mpmath.sign(slip))] if abs(slip) > tiny() else [0, 1, -1]
            choices.append([(a, s) for a in normals for s in (slips if a != "open" else [None])])
        for chosen in itertools.product(*choices):
            held, rate, factors = [], [mpf(0)] * len(v), []
            for (kind, slip), contact, row, along in zip(chosen, contacts, rows, alongs):
                acting = row if slip in (None, 0) else [a - slip * contact.mu() * b for a, b in zip(row, along)]
                if kind == "push":
                    rate = [r + a / m for r, a, m in zip(rate, acting, mass)]
                elif kind == "held":
                    held.append((row, acting))
                    factors.append(("share", len(held) - 1))
                if slip == 0 and kind != "open":
                    held.append((along, along))
                    factors.append(("stick", len(held) - 1, contact.mu(), len(held) - 2 if kind == "held" else None))
            matrix = [[dot(row, [a / m for a, m in zip(acting, mass)]) for _, acting in held] for row, _ in held]
            found = eliminate(matrix, [-dot(row, rate) for row, _ in held])
            for (_, acting), value in zip(held, found):
                rate = [r + value * a / m for r, a, m in zip(rate, acting, mass)]
            good = all(-tiny() <= found[f[1]] <= 1 + tiny() for f in factors if f[0] == "share")
            good &= all(abs(found[f[1]]) <= f[2] * (1 if f[3] is None else found[f[3]]) + tiny() for f in factors if f[0] == "stick")
            for (kind, slip), contact, row, along in zip(chosen, contacts, rows, alongs):
                at_rest = abs(dot(row, v)) <= tiny() and contact.name != pushed
                if at_rest and kind == "open":
                    good &= dot(row, rate) >= -tiny()
                if at_rest and kind == "push":
                    good &= dot(row, rate) <= tiny()
                if slip not in (None, 0) and abs(dot(along, v)) <= tiny():
                    good &= slip * dot(along, rate) >= -tiny()
            if good:
                return rate
        raise AssertionError("no continuation")


def with_following(phases):
    """Each phase with the one behind it, None behind the last."""
    before = None
    for phase in phases:
        if before is not None:
            yield before, phase
        before = phase
    yield before, None


def tiny():
    return mpf(10) ** (-mp.dps + 12)


def dot(a, b):
    terms = [x * y for x, y in zip(a, b) if not (isinstance(x, (int, mpf)) and x == 0) and not (isinstance(y, (int, mpf)) and y == 0)]
    return sum(terms[1:], terms[0]) if terms else mpf(0)


def eliminate(matrix, right):
    """Gauss without pivots, on numbers and series alike."""
    n, rows = len(right), [list(row) + [b] for row, b in zip(matrix, right)]
    for k in range(n):
        for i in range(k + 1, n):
            factor = rows[i][k] / rows[k][k]
            rows[i] = [a - factor * b for a, b in zip(rows[i], rows[k])]
    found = [None] * n
    for k in reversed(range(n)):
        value = rows[k][n]
        for j in range(k + 1, n):
            value = value - rows[k][j] * found[j]
        found[k] = value / rows[k][k]
    return found


def safe(series, degree):
    """The step on which the last two terms are rounding."""
    h = mpf("inf")
    for k in (degree - 1, degree):
        if series[k] != 0:
            h = min(h, (mpf(10) ** (-mp.dps) * max(1, abs(series[0])) / abs(series[k])) ** (mpf(1) / k))
    return h


def first_fall(series, h, armed):
    """The first s in (0, h] where the series falls through 0; one that begins at 0 has to rise first, unless armed."""
    before, value = mpf(0), series[0]
    for i in range(1, 65):
        s = h * i / 64
        new = series.at(s)
        if new < 0 and abs(new) > tiny() and (armed or value > tiny()):
            return mpmath.findroot(series.at, (before, s), solver="anderson", maxsteps=200, tol=mpf(10) ** (-2 * mp.dps + 10))
        assert new > -tiny() or armed, "wrong from the beginning"
        before, value = s, new
    return None


# --------------------------------------------------------------------------------------------------------------- problems
def number(text):
    return lambda: mpf(text)


def bounces(name):
    while True:
        yield Phase({}, ("gap", name))


def upright(name, **more):
    return Contact(name, lambda q: q[0], lambda q: [1], **more)


def elastic_balls():
    for case, overrides, until, z, g, e in (("", {}, "2", "1", "10", "0.9"),
                                            ("elastic", {"g": 9.81, "e": 1, "z": 0.8}, "2", "0.8", "9.81", "1")):
        yield ContactProblem("elastic-ball", number(until), lambda z=z: [mpf(z), 0], lambda: [1],
                             lambda q, v, g=g: [Series.lift(-mpf(g))], [upright("ground", e=number(e))],
                             lambda: bounces("ground"), case, overrides, "0.125")


def spring_balls():
    def force(q, v):
        spring = (q[1] - q[0] - 1) * 10000
        return [spring - mpf("9.81"), -spring - mpf("9.81")]

    ground = Contact("ground", lambda q: q[0] - mpf("0.2"), lambda q: [1, 0], e=number("0.8"))
    return ContactProblem("spring-balls", number("1"), lambda: [1, 2, 0, 0], lambda: [1, 1], force, [ground],
                          lambda: bounces("ground"), max_step="0.015625")


def planar_ground(mu="0"):
    return Contact("ground", lambda q: q[1], lambda q: [0, 1], along=lambda q: [1, 0], mu=number(mu))


def sliding_ball():
    return ContactProblem("sliding-ball", number("2"), lambda: [0, 1, 4, 0], lambda: [1, 1],
                          lambda q, v: [Series.lift(0), Series.lift(-10)], [planar_ground("0.3")],
                          lambda: iter([Phase({}, ("gap", "ground")), Phase({"ground": "+"}, ("slip", "ground")),
                                        Phase({"ground": "stick"})]))


def ball_in_space():
    """The direction of the slip stays: one tangent along it."""
    along = lambda: [2 / mpmath.sqrt(5), 1 / mpmath.sqrt(5), mpf(0)]
    ground = Contact("ground", lambda q: q[2], lambda q: [0, 0, 1], along=lambda q: along(), mu=number("0.2"))
    return ContactProblem("ball-in-space", number("2"), lambda: [0, 0, 1, 2, 1, 0], lambda: [1, 1, 1],
                          lambda q, v: [Series.lift(0), Series.lift(0), Series.lift(-10)], [ground],
                          lambda: iter([Phase({}, ("gap", "ground")), Phase({"ground": "+"}, ("slip", "ground")),
                                        Phase({"ground": "stick"})]))


def balls_touch(i, j, radius):
    """Gap of two balls of a pile, |q_i - q_j|^2 - 4 r^2; positions are (x1, y1, x2, y2, ...)."""
    apart = lambda q: [q[2 * i + k] - q[2 * j + k] for k in (0, 1)]
    squared = lambda d: d[0] * d[0] + d[1] * d[1]

    def row(q):
        result, d = [0] * 8, apart(q)
        for k in (0, 1):
            result[2 * i + k], result[2 * j + k] = d[k] * 2, d[k] * -2
        return result

    return Contact(f"balls{i + 1}{j + 1}", lambda q: squared(apart(q)) - 4 * radius() * radius(), row,
                   lambda q, v: squared(apart(v)) * 2)


def pile_of_balls():
    """Up to where the thrown ball leaves the lower ones; later two of them touch without a force, and rounding decides."""
    r = number("0.2")
    grounds = [Contact(f"ground{i + 1}", lambda q, i=i: q[2 * i + 1] - r(), lambda q, i=i: [int(k == 2 * i + 1) for k in range(8)])
               for i in range(4)]
    pairs = [balls_touch(i, j, r) for i, j in itertools.combinations(range(4), 2)]
    start = lambda: [-1, mpf("0.5"), 0, r(), 2 * r(), r(), r(), r() + mpmath.sqrt(3) * r(), 10, 0, 0, 0, 0, 0, 0, 0]
    force = lambda q, v: [Series.lift(0), Series.lift(-mpf("9.81"))] * 4
    lying = {"ground2": "closed", "ground3": "closed"}
    return ContactProblem("pile-of-balls", number("0.085"), start, lambda: [1] * 8, force, grounds + pairs,
                          lambda: iter([Phase({**lying, "balls24": "closed", "balls34": "closed"}, ("gap", "balls12"),
                                              ("ground2", "balls24", "balls34")),
                                        Phase(lying, ("gap", "balls23")), Phase(lying, ("gap", "balls12"), ("ground2", "balls23")),
                                        Phase(lying)]), max_step="0.015625")


def corner():
    left = Contact("left", lambda q: q[0], lambda q: [1, 0])
    bottom = Contact("bottom", lambda q: q[1], lambda q: [0, 1])
    return ContactProblem("inelastic-corner", number("1"), lambda: [mpf("0.8"), mpf("0.5"), mpf("-1.5"), -1], lambda: [1, 1],
                          lambda q, v: [Series.lift(-1), Series.lift(-2)], [left, bottom],
                          lambda: iter([Phase({}, ("gap", "bottom")), Phase({"bottom": "closed"}, ("gap", "left")),
                                        Phase({"bottom": "closed", "left": "closed"})]))


def three_carts():
    def force(q, v):
        return [u - 2 * rate for u, rate in zip((-1, 10, 0), v)]

    contacts = [Contact("first", lambda q: q[1] - q[0] - 2, lambda q: [-1, 1, 0]),
                Contact("last", lambda q: q[2] - q[1] - 2, lambda q: [0, -1, 1])]
    return ContactProblem("three-carts", number("3"), lambda: [-3, 0, 3, 0, 0, 0], lambda: [1, 1, 1], force, contacts,
                          lambda: iter([Phase({}, ("gap", "last")), Phase({"last": "closed"})]))


def rod_end(name, sign, mu, angle):
    """An end of a rod: `angle` gives (height above the ground over the centre, and along it) as functions of phi."""
    height, along = angle
    return Contact(name, lambda q: q[1] + sign * height(q[2]), lambda q: [0, 1, sign * along(q[2])],
                   lambda q, v: -sign * height(q[2]) * v[2] * v[2],
                   lambda q: [1, 0, -sign * height(q[2])], lambda q, v: -sign * along(q[2]) * v[2] * v[2], number(mu))


def falling_rod():
    half = (lambda phi: sin(phi) / 2, lambda phi: cos(phi) / 2)
    contacts = [rod_end("low", -1, "0.3", half), rod_end("high", 1, "0.3", half)]
    return ContactProblem("falling-rod", number("2"), lambda: [0, 1, mpf("0.6"), 0, 0, 0], lambda: [1, 1, mpf(1) / 12],
                          lambda q, v: [Series.lift(0), Series.lift(-mpf("9.81")), Series.lift(0)], contacts,
                          lambda: iter([Phase({}, ("gap", "low")), Phase({"low": "-"}, ("slip", "low")), Phase({"low": "+"}, ("gap", "high"), ("low",), rests=True),
                                        Phase({}, still=True)]))


def painleve_rod():
    def contact():
        c, s = lambda th: cos(th) / 2, lambda th: sin(th) / 2
        return Contact("ground", lambda q: q[1] - c(q[2]), lambda q: [0, 1, s(q[2])], lambda q, v: c(q[2]) * v[2] * v[2],
                       lambda q: [1, 0, -c(q[2])], lambda q, v: s(q[2]) * v[2] * v[2], number("1"))

    def start():
        return [0, mpmath.cos(mpmath.pi / 6) / 2, mpmath.pi / 6, -10, 0, 0]

    force = lambda q, v: [Series.lift(0), Series.lift(-mpf("9.81")), Series.lift(0)]
    yield ContactProblem("painleve-rod", number("0.4"), start, lambda: [1, 1, mpf(1) / 32], force, [contact()],
                         lambda: iter([Phase({})]), at_start=("ground",))
    yield ContactProblem("painleve-rod", number("0.4"), start, lambda: [1, 1, 1], force, [contact()],
                         lambda: iter([Phase({"ground": "-"})]), "heavy ends", {"J": 1.0})


def ball_in_box():
    walls = [Contact("right", lambda q: 1 - q[0], lambda q: [-1, 0], e=number("1")),
             Contact("left", lambda q: 1 + q[0], lambda q: [1, 0], e=number("1")),
             Contact("top", lambda q: 1 - q[1], lambda q: [0, -1], e=number("1")),
             Contact("bottom", lambda q: 1 + q[1], lambda q: [0, 1], e=number("1"))]
    order = ["right", "top", "left", "right", "left", "bottom"]
    return ContactProblem("ball-in-box", number("4"), lambda: [0, mpf("0.5"), 2, mpf("0.7")], lambda: [1, 1],
                          lambda q, v: [Series.lift(0), Series.lift(0)], walls,
                          lambda: iter([*(Phase({}, ("gap", name)) for name in order), Phase({})]))


def landing_ball():
    return ContactProblem("landing-ball", number("2"), lambda: [0, mpf("1.5"), 0, 0], lambda: [1, 1],
                          lambda q, v: [Series.lift(0), Series.lift(-mpf("9.81"))], [planar_ground("0.6")],
                          lambda: iter([Phase({}, ("gap", "ground")), Phase({"ground": "stick"})]))


def hopper():
    foot = Contact("foot", lambda q: q[1] - q[3], lambda q: [0, 1, 0, -1], along=lambda q: [1, 0, q[3], 0], mu=number("0.45"))
    force = lambda q, v: [Series.lift(0), Series.lift(-mpf("1.1") * mpf("9.81")), Series.lift(0), Series.lift(0)]
    return ContactProblem("hopper", number("0.2"), lambda: [mpf("0.1"), mpf("0.5"), 0, mpf("0.5"), 0, 0, 0, 0],
                          lambda: [mpf("1.1"), mpf("1.1"), mpf("0.275"), mpf("0.1")], force, [foot],
                          lambda: iter([Phase({"foot": "closed"})]))


def problems():
    yield from elastic_balls()
    yield spring_balls()
    yield sliding_ball()
    yield ball_in_space()
    yield pile_of_balls()
    yield corner()
    yield three_carts()
    yield falling_rod()
    yield from painleve_rod()
    yield ball_in_box()
    yield landing_ball()
    yield hopper()
