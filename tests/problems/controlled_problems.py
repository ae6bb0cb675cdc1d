"""Models with controls for make_references.py, simulated with each control at its initial value. Many of them are at rest
then, on the surface of their dry friction, which holds them."""

import mpmath
from catalogue_problems import TAYLOR, decimal, scalar, sgn
from mpmath import mpf
from series_functions import sqrt
from taylor_events import Explicit, Problem


def at_rest(model, surface, x, until):
    """Starts on a surface that holds it: nothing moves, and the selection is in the middle."""

    def solution():
        values = [mpf(value) for value in x]
        start = dict(t=mpf(0), kind="start", surfaces=[surface], mode_before=None, mode_after=[0], x=values)
        return dict(events=[start], final=dict(t=decimal(until), x=values, mode=[0], alpha=[mpf(1) / 2]))

    return Explicit(model=model, solution=solution)


def turbo_car():
    final = lambda: dict(t=mpf(10), x=[mpf(0), mpf(0)], mode=[-1], alpha=[mpf(0)])
    return Explicit(model="turbo-car", solution=lambda: dict(events=[], final=final()))


def hysteresis_car():
    """u = 4: without turbo up to v = 15, a transfer at speed 1 while the clock stands still, then with turbo. To stay
    where three regions meet, time frozen for ever, is another solution."""
    names = ["slow", "turn-off", "turn-on", "fast"]

    def event(kind, surfaces, after, t, x, **more):
        return dict(t=t, kind=kind, surfaces=surfaces, mode_before=None if kind == "start" else [], mode_after=[], x=x,
                    regions_after=[after], **more)

    def solution():
        on, off = mpf(15) / 4, mpf(15) / 4 + 1
        q = 2 * on * on
        events = [event("start", names[:2], names[:2], mpf(0), [mpf(0)] * 4),
                  event("change_sliding", names[:3], ["turn-on"], on, [q, mpf(15), mpf(0), on], unique=False,
                        alternatives=[dict(mode=[], alpha=[])]),
                  event("enter_sliding", ["fast"], names[2:], off, [q, mpf(15), mpf(1), on])]
        left = 10 - off
        x = [q + 15 * left + 6 * left * left, 15 + 12 * left, mpf(1), on + left]
        half = mpf(1) / 2
        return dict(events=events, final=dict(t=mpf(10), x=x, mode=[], alpha=[], regions=[names[2:]],
                                              theta=[mpf(0), mpf(0), half, half]))

    return Explicit(model="hysteresis-car", solution=solution)


def slide_and_hide(model, rest):
    """`rest`: states that stay 0. At the origin the surfaces are the axes and do not act on each other."""
    curve = lambda: decimal("0.15")
    return Problem(
        model=model, names=["c1", "c2"], x0=lambda: [2 * mpmath.pi / 3, mpmath.pi / 3] + [0] * rest,
        f=lambda c, x, a: [-sgn(a[0]), -sgn(a[1])] + [mpf(0)] * rest,
        psi=lambda c, x: [x[0] + curve() * x[1] * x[1], x[1] - curve() / 3 * x[0] * x[0] * x[0]],
        psi_dot=lambda c, x, v: [v[0] + 2 * curve() * x[1] * v[1], v[1] - curve() * x[0] * x[0] * v[0]],
        until=lambda: 4, source=TAYLOR, max_step=0.2)


def block_train():
    def f(c, x, a):
        q, v = x[:7], x[7:]
        e = [q[i] - mpf(i) / 5 for i in range(7)]
        spring = [-5 * (e[i] - (e[i - 1] if i else 0)) for i in range(7)] + [mpf(0)]
        return list(v) + [spring[i] - spring[i + 1] - v[i] / 10 - decimal("0.4") * sgn(a[i]) for i in range(7)]

    return Problem(model="block-train", names=[f"v{i}" for i in range(1, 8)],
                   x0=lambda: [mpf(i) / 5 for i in range(1, 8)] + [0] * 7, f=f, psi=lambda c, x: x[7:],
                   psi_dot=lambda c, x, v: v[7:], until=lambda: 5, source=TAYLOR, max_step=0.3)


def tank_cascade():
    half = mpf(1) / 2

    def f(c, x, a):
        first = half * sqrt(x[0] - a[0] * (x[1] - half))
        second = half * sqrt(x[1] - a[1] * (x[2] - half))
        return [(half - first) / 10, (first - second) / 10, (second - half * sqrt(x[2])) / 10]

    return Problem(model="tank-cascade", names=[], x0=lambda: [mpf(1) / 10] * 3, f=f,
                   psi=lambda c, x: [x[1] - half, x[2] - half], psi_dot=lambda c, x, v: v[1:], until=lambda: 100,
                   source=TAYLOR, max_step=2)


def estimator():
    # Both speeds begin as 1/2: a kink without effect.
    final = lambda: dict(t=mpf(3), x=[mpf(1) / 2], mode=[], alpha=[])
    return Explicit(model="estimator", solution=lambda: dict(events=[], final=final()))


def problems():
    yield scalar("stewart-anitescu", lambda: decimal("-1.5"), lambda c, x, a: 2 - sgn(a), lambda: 2)
    yield turbo_car()
    yield hysteresis_car()
    yield slide_and_hide("slide-and-hide", 0)
    yield slide_and_hide("slide-and-hide-rates", 2)
    yield at_rest("cart-pole", "vp", [1, 0, 0, 0], "5")
    yield at_rest("voice-coil", "v1", [0] * 5, "0.08")
    yield at_rest("voice-coil-time", "v1", [0] * 5, "0.08")
    yield block_train()
    yield tank_cascade()
    yield estimator()
    yield at_rest("drift-car", "slip", [0] * 5, "4")
