"""Classics of mechanics, control, power electronics, biology and climate, written down independently of models/*.toml."""

import mpmath
from catalogue_problems import CLOSED, TAYLOR, decimal, mix, sgn
from mpmath import mpf
from series_functions import exp, sin
from taylor_events import Explicit, Problem


def stribeck_friction():
    def f(c, x, a):
        q, v = x
        slip = v - decimal("0.5")
        dry = lambda size: decimal("0.5") * (1 + exp(-size / decimal("0.3")))
        return [v, -q - decimal("0.05") * v - mix(a[0], dry(slip), -dry(-slip))]

    return Problem(model="stribeck-friction", names=["slip"], x0=lambda: [decimal("0.2"), 0], f=f,
                   psi=lambda c, x: [x[1] - decimal("0.5")], psi_dot=lambda c, x, v: [v[1]], until=lambda: 20,
                   source=TAYLOR, max_step=0.3)


def forced_friction():
    def f(c, x, a):
        return [x[1], c.cos - 4 * x[0] - x[1] / 10 - decimal("0.6") * sgn(a[0])]

    return Problem(model="forced-friction", names=["v"], x0=lambda: [0, 0], f=f, psi=lambda c, x: [x[1]],
                   psi_dot=lambda c, x, v: [v[1]], until=lambda: 25, source=TAYLOR, max_step=0.5)


def chua():
    def f(c, x, a):
        inner, outer = -mpf(8) / 7, -mpf(5) / 7
        knee = mix(a[0], x[0] + 1, -(x[0] + 1)) - mix(a[1], x[0] - 1, -(x[0] - 1))
        current = outer * x[0] + (inner - outer) / 2 * knee
        return [decimal("15.6") * (x[1] - x[0] - current), x[0] - x[1] + x[2], -28 * x[1]]

    return Problem(model="chua", names=[], x0=lambda: [decimal("0.7"), 0, 0], f=f,
                   psi=lambda c, x: [x[0] + 1, x[0] - 1], psi_dot=lambda c, x, v: [v[0], v[0]], until=lambda: 12,
                   source=TAYLOR, max_step=0.2, watched=[(lambda c, x: x[0], 0)])


def boost_converter():
    def f(c, x, a):
        i, v = x
        off, load = 1 - a[0], mix(a[1], mpf(1) / 20, mpf(1) / 10)
        return [(10 - off * v) / 5, (off * i - load * v) * 20]

    return Problem(model="boost-converter", names=["below"], x0=lambda: [0, 0], f=f,
                   psi=lambda c, x: [2 - x[0], 15 - c.t], psi_dot=lambda c, x, v: [-v[0], mpf(-1)], until=lambda: 30,
                   source=TAYLOR, max_step=0.3)


def servo():
    # v < 0 all the time: the curve is x = 0.7 v^2
    return Problem(model="servo", names=["curve"], x0=lambda: [1, 0], f=lambda c, x, a: [x[1], -sgn(a[0])],
                   psi=lambda c, x: [x[0] - decimal("0.7") * x[1] * x[1]],
                   psi_dot=lambda c, x, v: [v[0] - decimal("1.4") * x[1] * v[1]], until=lambda: 2, source=CLOSED)


def sliding_mode_pendulum():
    def f(c, x, a):
        return [x[1], -sin(x[0]) + c.sin / 2 - decimal("1.6") * sgn(a[0])]

    return Problem(model="sliding-mode-pendulum", names=["s"], x0=lambda: [0, 0], f=f,
                   psi=lambda c, x: [x[1] + x[0] - 2], psi_dot=lambda c, x, v: [v[1] + v[0]], until=lambda: 10,
                   source=TAYLOR, max_step=0.3)


def threshold_harvest():
    def f(c, x, a):
        prey, hunter = x
        eaten = prey * hunter / (1 + prey)
        return [prey * (1 - prey / 4) - eaten, eaten - hunter / 2 - decimal("0.4") * a[0] * hunter]

    return Problem(model="threshold-harvest", names=["plenty"], x0=lambda: [2, decimal("0.8")], f=f,
                   psi=lambda c, x: [x[1] - decimal("1.7")], psi_dot=lambda c, x, v: [v[1]], until=lambda: 40,
                   source=TAYLOR, max_step=0.4)


def welander():
    def f(c, x, a):
        mixing = 5 * a[0]
        return [1 - x[0] - mixing * x[0], (1 - x[1]) / 2 - mixing * x[1]]

    return Problem(model="welander", names=["dense"], x0=lambda: [decimal("0.5"), decimal("0.3")], f=f,
                   psi=lambda c, x: [decimal("1.2") * x[1] - x[0] + decimal("0.01")],
                   psi_dot=lambda c, x, v: [decimal("1.2") * v[1] - v[0]], until=lambda: 10, source=TAYLOR,
                   max_step=0.2)


def repressilator():
    def f(c, x, a):
        return [decimal("2.5") * (1 - a[2]) - x[0], decimal("2.5") * (1 - a[0]) - x[1],
                decimal("2.5") * (1 - a[1]) - x[2]]

    return Problem(model="repressilator", names=["laci", "tetr", "ci"],
                   x0=lambda: [decimal("0.2"), decimal("0.6"), decimal("1.7")], f=f,
                   psi=lambda c, x: [value - 1 for value in x], psi_dot=lambda c, x, v: list(v), until=lambda: 30,
                   source=TAYLOR, max_step=0.5)


def mckean_neuron():
    low, high = mpf(1) / 8, mpf(5) / 8

    def f(c, x, a):
        v, w = x
        current = mix(a[1], 1 - v, mix(a[0], v - mpf(1) / 4, -v))
        return [current - w + decimal("0.6"), decimal("0.08") * (v - w / 2)]

    return Problem(model="mckean-neuron", names=[], x0=lambda: [0, 0], f=f,
                   psi=lambda c, x: [x[0] - low, x[0] - high], psi_dot=lambda c, x, v: [v[0], v[0]],
                   until=lambda: 80, source=TAYLOR, max_step=0.5, watched=[(lambda c, x: x[0] - mpf(1) / 2, 1)])


def suspension_bridge():
    def f(c, x, a):
        return [x[1], 10 + 3 * c.sin - x[1] / 10 - 17 * a[0] * x[0]]

    return Problem(model="suspension-bridge", names=[], x0=lambda: [mpf(10) / 17, 5], f=f, psi=lambda c, x: [x[0]],
                   psi_dot=lambda c, x, v: [v[0]], until=lambda: 15, source=TAYLOR, frequency=4, max_step=0.15,
                   watched=[(lambda c, x: x[1], 0)])


def gear_backlash():
    def f(c, x, a):
        push = a[0] * (x[0] - 1) + (1 - a[1]) * (x[0] + 1)
        return [x[1], decimal("0.1") + decimal("0.4") * c.cos - x[1] / 10 - push]

    return Problem(model="gear-backlash", names=[], x0=lambda: [0, 0], f=f,
                   psi=lambda c, x: [x[0] - 1, x[0] + 1], psi_dot=lambda c, x, v: [v[0], v[0]], until=lambda: 30,
                   source=TAYLOR, max_step=0.5, watched=[(lambda c, x: x[1], -1)])


def anti_lock_brake():
    def f(c, x, a):
        v, wheel = x
        slip = (v - wheel) / v
        grip = decimal("9.81") * decimal("0.36") * slip / (decimal("0.04") + slip * slip)
        return [-grip, 20 * decimal("0.9") * grip - mix(a[0], 100, 400)]

    return Problem(model="anti-lock-brake", names=["excess"], x0=lambda: [30, 30], f=f,
                   psi=lambda c, x: [x[0] * 4 / 5 - x[1]], psi_dot=lambda c, x, v: [v[0] * 4 / 5 - v[1]],
                   until=lambda: 3, source=TAYLOR, max_step=0.05, watched=[(lambda c, x: x[0] - 15, -1)])


def bridge_rectifier():
    def f(c, x, a):
        v = x[0]
        charge = a[0] * (10 * c.sin - v) + a[1] * (-10 * c.sin - v)
        return [20 * charge - v / 10]

    return Problem(model="bridge-rectifier", names=[], x0=lambda: [3], f=f,
                   psi=lambda c, x: [10 * c.sin - x[0], -10 * c.sin - x[0]],
                   psi_dot=lambda c, x, v: [10 * c.cos - v[0], -10 * c.cos - v[0]], until=lambda: 20, source=TAYLOR,
                   max_step=0.15, watched=[(lambda c, x: x[0] - 9, 0)])


def smoothed_pss():
    """Both rates are a - tanh(x/sigma): sigma times an integral that is known."""
    sigma = decimal("1e-7")

    def end(rate, x0, until):
        # dt/du = sigma/(a - tanh u) integrates to sigma (a u + log|a cosh u - sinh u|)/(a^2 - 1).
        age = lambda u: (rate * u + mpmath.log(abs(rate * mpmath.cosh(u) - mpmath.sinh(u)))) / (rate * rate - 1)
        reached = age(x0 / sigma) + until / sigma
        return sigma * mpmath.findroot(lambda u: age(u) - reached, (until + x0 * 3 / (rate + 1)) / (3 * sigma))

    # y is at its resting point sigma atanh(1/5) but for exp(-10^7).
    return dict(events=[], final=dict(t=mpf(1), x=[end(mpf(2), mpf(-1), 1), sigma * mpmath.atanh(mpf(1) / 5)], mode=[],
                                      alpha=[]))


def classics():
    yield stribeck_friction()
    yield forced_friction()
    yield chua()
    yield boost_converter()
    yield servo()
    yield sliding_mode_pendulum()
    yield threshold_harvest()
    yield welander()
    yield repressilator()
    yield mckean_neuron()
    yield suspension_bridge()
    yield gear_backlash()
    yield anti_lock_brake()
    yield bridge_rectifier()
    yield Explicit(model="smoothed-pss", solution=smoothed_pss)


def closed_forms():
    """(model, case) -> (event times without the start, end state)."""
    gain = mpf(7) / 10
    reached = 1 / mpmath.sqrt(mpf(1) / 2 + gain)
    speed = -reached + (2 - reached) / (2 * gain)
    return {("servo", ""): ([reached], [gain * speed * speed, speed])}
