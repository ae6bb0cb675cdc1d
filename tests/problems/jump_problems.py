"""Models with jumps for make_references.py: flows in closed form, roots by mpmath, written down independently of Saltus."""

import mpmath
from mpmath import mpf


class Model:
    """A flow between jumps in closed form: flow(x, s) is the state s later; jumps are found as first roots."""

    def __init__(self, model, until, x0, flow, jumps, source, step):
        self.model, self.until, self.x0, self.flow, self.jumps = model, until, x0, flow, jumps
        self.source, self.step = source, step


def first_root(function, span, step):
    """The first change of sign from + to - of `function` in (0, span], on a grid finer than its humps, then bisected."""
    before, s = mpf(0), mpf(0)
    armed = False
    while s < span:
        s = min(s + step, span)
        if function(s) > 0:
            armed, before = True, s
        elif armed or function(before + (s - before) / 1000) > 0:
            low = before if armed else before + (s - before) / 1000
            return mpmath.findroot(function, (low, s), solver="anderson", tol=mpf(10) ** (-2 * mpmath.mp.dps + 10))
    return None


def entry(problem):
    """The reference of one model: every jump with the states on both sides, and the end."""
    t, x, events, until = mpf(0), [mpf(value) for value in problem.x0()], [], mpf(problem.until)
    while True:
        found = []
        for name, guard, new in problem.jumps(x):
            s = first_root(lambda s, guard=guard, x=x: guard(problem.flow(x, s)), until - t, problem.step)
            if s is not None:
                found.append((s, name, new))
        if not found:
            break
        s, name, new = min(found, key=lambda item: item[0])
        at = problem.flow(x, s)
        t, x = t + s, new(at)
        events.append(dict(t=t, kind="jump", name=name, surfaces=[name], mode_before=[], mode_after=[], x=at, x_after=x))
    final = dict(t=until, x=problem.flow(x, until - t), mode=[], alpha=[])
    return dict(model=problem.model, until=until, how=problem.source, events=events, final=final)


def ball(model, until, height, gravity, restitution, step):
    def flow(x, s):
        return [x[0] + x[1] * s - gravity() * s * s / 2, x[1] - gravity() * s]

    def jumps(x):
        yield "bounce", lambda y: y[0], lambda y: [mpf(0), -restitution() * y[1]]

    return Model(model, until, lambda: [height, 0], flow, jumps, "closed form", step)


def decay_between(model, until, start, rate, power, offset, low, high, names):
    """x' = -rate (x - offset) + power on, off above high, on below low."""

    def flow(x, s):
        rest = offset() + x[1] * power() / rate()
        return [rest + (x[0] - rest) * mpmath.exp(-rate() * s), x[1]]

    def jumps(x):
        if x[1] == 1:
            yield names[0], lambda y: high() - y[0], lambda y: [y[0], mpf(0)]
        else:
            yield names[1], lambda y: y[0] - low(), lambda y: [y[0], mpf(1)]

    return Model(model, until, lambda: [start, 1], flow, jumps, "closed form", mpf(1) / 16)


def hiskens_pai():
    # A = [[1, a], [b, 1]] with a b < 0: growth by exp(s) and a rotation of frequency sqrt(-a b) = sqrt(1000).
    def flow(x, s):
        a, b = (mpf(-100), mpf(10)) if x[2] == 1 else (mpf(10), mpf(-100))
        w = mpmath.sqrt(-a * b)
        c, d = mpmath.exp(s) * mpmath.cos(w * s), mpmath.exp(s) * mpmath.sin(w * s)
        return [c * x[0] + a / w * d * x[1], b / w * d * x[0] + c * x[1], x[2]]

    def jumps(x):
        if x[2] == 1:
            yield "to_second", lambda u: u[1] - mpf("2.75") * u[0], lambda u: [u[0], u[1], mpf(0)]
        else:
            yield "to_first", lambda u: mpf("0.36") * u[0] - u[1], lambda u: [u[0], u[1], mpf(1)]

    return Model("hiskens-pai", mpf(1) / 8, lambda: [0, 1, 1], flow, jumps, "closed form of both flows, roots", mpf(1) / 512)


def simple_jump():
    # 1/x grows by k (t^2 - t0^2)/2: the time is carried along as a component.
    def flow(x, s):
        grown = 1 / x[0] + mpf("0.1") * ((x[1] + s) ** 2 - x[1] ** 2) / 2
        return [1 / grown, x[1] + s]

    def jumps(x):
        yield "lift_up", lambda y: y[0] - mpf("0.5"), lambda y: [y[0] + mpf("0.6"), y[1]]

    return Model("simple-jump", 10, lambda: [1, 0], flow, jumps, "closed form", mpf(1) / 16)


def two_balls_spring():
    # The centre of mass falls, the extension d = q2 - q1 - l oscillates with frequency sqrt(2 k/m).
    def flow(x, s):
        w = mpmath.sqrt(mpf(20000))
        centre = (x[0] + x[1]) / 2 + (x[2] + x[3]) / 2 * s - mpf("9.81") * s * s / 2
        speed = (x[2] + x[3]) / 2 - mpf("9.81") * s
        d0, v0 = x[1] - x[0] - 1, x[3] - x[2]
        d = d0 * mpmath.cos(w * s) + v0 / w * mpmath.sin(w * s)
        v = -w * d0 * mpmath.sin(w * s) + v0 * mpmath.cos(w * s)
        return [centre - (1 + d) / 2, centre + (1 + d) / 2, speed - v / 2, speed + v / 2]

    def jumps(x):
        yield "impact", lambda y: y[0] - mpf("0.2"), lambda y: [mpf("0.2"), y[1], -mpf("0.8") * y[2], y[3]]

    return Model("two-balls-spring", 1, lambda: [1, 2, 0, 0], flow, jumps,
                 "closed form of the flow (a fall and a harmonic oscillation), roots", mpf(1) / 2048)


def problems():
    number = lambda text: lambda: mpf(text)
    # They end before the impacts accumulate, or at a number of impacts that is everybody's.
    yield ball("bouncing-ball", 26, 10, number("9.8"), number("0.9"), mpf(1) / 32)
    yield ball("bouncing-ball-fmi", mpf("2.5"), 1, number("9.81"), number("0.7"), mpf(1) / 128)
    yield decay_between("thermostat", 20, 15, number("0.1"), number("2"), number("18"), number("22"), number("23.5"),
                        ("too_warm", "too_cold"))
    yield decay_between("temperature-control", 3, 15, number("0.2"), number("10"), number("0"), number("18"),
                        number("20"), ("heating", "heating"))
    yield hiskens_pai()
    yield simple_jump()
    yield two_balls_spring()


def without_clock(reference):
    """simple-jump carries the time along as its second component, which the model does not have."""
    if reference["model"] == "simple-jump":
        for event in reference["events"]:
            event["x"], event["x_after"] = event["x"][:1], event["x_after"][:1]
        reference["final"]["x"] = reference["final"]["x"][:1]
    return reference


def entries():
    """All references at the precision in force."""
    return [without_clock(entry(problem)) for problem in problems()]
