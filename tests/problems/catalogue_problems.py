"""The catalogue's problems for make_references.py, written down independently of models/*.toml, with closed forms."""

import mpmath
from mpmath import mpf
from taylor_events import Problem

TAYLOR = "Taylor series of degree 40 and 52 with 40 and 50 digits, events as roots of their polynomials"
CLOSED = "closed form, and Taylor series with 40 and 50 digits"


def sgn(alpha):
    return 2 * alpha - 1


def mix(alpha, above, below):
    return alpha * above + (1 - alpha) * below


def decimal(text):
    """A decimal constant, read at the precision in force."""
    return mpf(text)


def scalar(model, x0, rate, until, name="x", orientation=1, **more):
    """x' = rate(clock, x, alpha) with the surface x = 0, alpha = step(orientation*x)."""
    return Problem(model=model, names=[name], x0=lambda: [x0()], f=lambda c, x, a: [rate(c, x[0], a[0])],
                   psi=lambda c, x: [orientation * x[0]], psi_dot=lambda c, x, v: [orientation * v[0]], until=until,
                   source=CLOSED, **more)


def four_cases():
    crossing = lambda c, x, a: 2 - sgn(a)
    yield scalar("crossing", lambda: -1, crossing, lambda: 1)
    # the end is the double nearest to pi/4, as the tests use it
    yield scalar("crossing", lambda: -1, crossing, lambda: 0.7853981633974483, case="to pi/4")
    yield scalar("sliding", lambda: -1, lambda c, x, a: -sgn(a) + decimal("0.2") * c.sin, lambda: 2, frequency=5,
                 max_step=0.3)
    yield scalar("leaving-sliding", lambda: 0, lambda c, x, a: -sgn(a) + c.t, lambda: 1.5)
    modes = {1: [1.0], -1: [0.0], 0: [0.5]}
    for forced in (None, -1, 0):
        taken = 1 if forced is None else forced
        others = [dict(mode=[k], alpha=modes[k]) for k in (1, -1, 0) if k != taken]
        yield scalar("spontaneous-switch", lambda: 0, lambda c, x, a: sgn(a), lambda: 1, unique=False,
                     alternatives=others, initial_mode={} if forced is None else {"x": forced},
                     case="" if forced is None else f"initial_mode {forced}")


def scalar_problems():
    yield scalar("simplest-switch", lambda: -1, lambda c, x, a: mix(a, decimal("0.2"), 2), lambda: 1.5)
    yield scalar("entering-sliding", lambda: -mpmath.sqrt(2), lambda c, x, a: -sgn(a), lambda: 2)
    yield scalar("asymmetric-sliding", lambda: -mpmath.sqrt(2), lambda c, x, a: mix(a, -1, 3), lambda: 2)


def rotating_oscillator():
    def f(c, x, a):
        turn = -sgn(a[0]) * 2 * mpmath.pi
        return [x[0] - turn * x[1], turn * x[0] + x[1]]

    return Problem(model="rotating-oscillator", names=["x1^2+x2^2-1"], x0=lambda: [mpmath.exp(-1), 0], f=f,
                   psi=lambda c, x: [x[0] * x[0] + x[1] * x[1] - 1],
                   psi_dot=lambda c, x, v: [2 * (x[0] * v[0] + x[1] * v[1])], until=lambda: 1.5707963267948966,
                   source=CLOSED, max_step=0.4)


def dry_friction_oscillator():
    def problem(x0, case, overrides):
        return Problem(model="dry-friction-oscillator", names=["v"], x0=lambda: [decimal(x0), 0],
                       f=lambda c, x, a: [x[1], -x[0] - decimal("0.4") * sgn(a[0])], psi=lambda c, x: [x[1]],
                       psi_dot=lambda c, x, v: [v[1]], until=lambda: 15, source=CLOSED, case=case, overrides=overrides)

    yield problem("3", "", {})
    yield problem("0.25", "stuck from the start", {"x": 0.25})


def two_lines():
    def problem(x0, y0, case, overrides):
        return Problem(model="two-lines", names=["x-y"], x0=lambda: [mpf(x0), mpf(y0)],
                       f=lambda c, x, a: [mix(a[0], -2, 2), mix(a[0], mpf(3) / 2, -3)],
                       psi=lambda c, x: [x[0] - x[1]], psi_dot=lambda c, x, v: [v[0] - v[1]], until=lambda: 1,
                       source=CLOSED, case=case, overrides=overrides)

    yield problem(1.5, 1, "", {})
    yield problem(1, 1.5, "from below", {"x": 1, "y": 1.5})


def stick_slip():
    def f(c, x, a):
        q, v = x
        return [v, -q + mix(a[0], -1 / (decimal("0.8") + v), 1 / (decimal("1.2") - v))]

    for model, x0 in (("stick-slip", ("0.04", "-0.01")), ("stick-slip-from-outside", ("-0.8", "-1"))):
        yield Problem(model=model, names=["slip"], x0=lambda x0=x0: [decimal(value) for value in x0], f=f,
                      psi=lambda c, x: [x[1] - decimal("0.2")], psi_dot=lambda c, x, v: [v[1]], until=lambda: 40,
                      source=TAYLOR, max_step=0.5)


def relay_feedback():
    def f(c, x, a):
        w, xi, s = mpf(25), decimal("0.05"), sgn(a[0])
        return [-(2 * xi * w + 1) * x[0] + x[1] - s, -(2 * xi * w + w * w) * x[0] + x[2] + 2 * s, -w * w * x[0] - s]

    return Problem(model="relay-feedback", names=["x1"], x0=lambda: [0, decimal("-0.001"), decimal("-0.02")], f=f,
                   psi=lambda c, x: [x[0]], psi_dot=lambda c, x, v: [v[0]], until=lambda: 10, source=TAYLOR,
                   max_step=0.2)


def relay_oscillator():
    return Problem(model="relay-oscillator", names=["x1"], x0=lambda: [0, 3 * mpmath.sqrt(2) / (2 * mpmath.pi), 0],
                   f=lambda c, x, a: [x[1], x[2], -3 * x[1] - 2 * x[2] - sgn(a[0])], psi=lambda c, x: [x[0]],
                   psi_dot=lambda c, x, v: [v[0]], until=lambda: 50, source=TAYLOR)


IRMA_NAMES = ["gal4", "swi5_low", "swi5_mid", "swi5_high", "ash1", "cbf1", "gal80"]
IRMA_THRESHOLDS = [(0, "0.01"), (1, "0.01"), (1, "0.06"), (1, "0.08"), (2, "0.035"), (3, "0.04"), (4, "0.01")]


def irma():
    decay = ["0.05", "0.04", "0.05", "0.02", "0.6"]
    basal = ["1.1e-4", "3e-4", "6e-4", "5e-4", "7.5e-4"]
    induced = ["9e-4", "0.15", "0.018", "0.03", "0.015"]

    def f(c, x, a):
        p, k1, k2 = ([decimal(value) for value in row] for row in (decay, basal, induced))
        return [
            -p[0] * x[0] + k1[0] + k2[0] * a[5],
            -p[1] * x[1] + k1[1] + k2[1] * a[0],
            -p[2] * x[2] + k1[2] + k2[2] * a[2],
            -p[3] * x[3] + k1[3] * a[1] + k2[3] * a[1] * (1 - a[4]),
            -p[4] * x[4] + k1[4] + k2[4] * a[3],
        ]

    for until in (1000, 100):
        yield Problem(model="irma", names=IRMA_NAMES,
                      x0=lambda: [decimal(value) for value in ("0.011", "0.09", "0.04", "0.05", "0.015")], f=f,
                      psi=lambda c, x: [x[i] - decimal(level) for i, level in IRMA_THRESHOLDS],
                      psi_dot=lambda c, x, v: [v[i] for i, _ in IRMA_THRESHOLDS], until=lambda until=until: until,
                      source=TAYLOR, max_step=5, case="" if until == 1000 else "to 100")


def friction_blocks():
    def f(c, x, a):
        q, v = x[:3], x[3:]
        dry = [decimal("0.3") * sgn(alpha) for alpha in a]
        return list(v) + [
            -2 * q[0] + q[1] - v[0] - dry[0],
            q[0] - 2 * q[1] + q[2] - v[1] - dry[1],
            q[1] - q[2] - v[2] - dry[2],
        ]

    return Problem(model="friction-blocks", names=["v1", "v2", "v3"], x0=lambda: [-1, 1, -1, -1, 1, 1], f=f,
                   psi=lambda c, x: x[3:], psi_dot=lambda c, x, v: v[3:], until=lambda: 12, source=TAYLOR)


def half_plane():
    return Problem(model="half-plane", names=["-1-x2"], x0=lambda: [mpmath.sqrt(2), mpmath.sqrt(2)],
                   f=lambda c, x, a: [x[1], -x[0] + 3 * a[0]], psi=lambda c, x: [-1 - x[1]],
                   psi_dot=lambda c, x, v: [-v[1]], until=lambda: 4.611844073359521, source=CLOSED)


def sweeping_disc():
    def f(c, x, a):
        push = 4 * (1 - a[0])
        return [push * (c.sin - x[0]), push * (c.cos - x[1])]

    def psi_dot(c, x, v):
        return [-2 * (x[0] - c.sin) * (v[0] - c.cos) - 2 * (x[1] - c.cos) * (v[1] + c.sin)]

    def psi(c, x):
        return [mpf(1) / 4 - (x[0] - c.sin) * (x[0] - c.sin) - (x[1] - c.cos) * (x[1] - c.cos)]

    return Problem(model="sweeping-disc", names=["rim"], x0=lambda: [0, 1], f=f, psi=psi, psi_dot=psi_dot,
                   until=lambda: 10, source=CLOSED, max_step=0.2)


def circle():
    def f(c, x, a):
        turn, pull = 1 + x[0] / 2, sgn(a[0])
        return [-turn * x[1] - pull * x[0], turn * x[0] - pull * x[1] / 2 + decimal("0.3")]

    return Problem(model="circle", names=["x1^2+x2^2-1"], x0=lambda: [mpf(3) / 2, 0], f=f,
                   psi=lambda c, x: [x[0] * x[0] + x[1] * x[1] - 1],
                   psi_dot=lambda c, x, v: [2 * (x[0] * v[0] + x[1] * v[1])], until=lambda: 10, source=TAYLOR,
                   max_step=0.3)


def quadrants():
    def f(c, x, a):
        apart = a[0] * (1 - a[1]) + (1 - a[0]) * a[1]
        return [-x[0] / 10 + mix(apart, 1, 4) * x[1], -mix(apart, 4, 1) * x[0] - x[1] / 10]

    return Problem(model="quadrants", names=["right", "upper"], x0=lambda: [decimal("0.1")] * 2, f=f,
                   psi=lambda c, x: list(x), psi_dot=lambda c, x, v: list(v), until=lambda: 6, source=CLOSED,
                   max_step=0.3)


def problems():
    yield from four_cases()
    yield from scalar_problems()
    yield rotating_oscillator()
    yield from dry_friction_oscillator()
    yield from two_lines()
    yield from stick_slip()
    yield relay_feedback()
    yield relay_oscillator()
    yield from irma()
    yield friction_blocks()
    yield half_plane()
    yield sweeping_disc()
    yield circle()
    yield quadrants()


# ------------------------------------------------------------------------------------------------------------ closed forms
def swept_point(t):
    """sweeping-disc: u = tan(theta/2) obeys u' = ((u - 2)^2 - 3)/2, a Moebius function of exp(sqrt(3) t)."""
    contact, root = 2 * mpmath.asin(mpf(1) / 4), mpmath.sqrt(3)
    u = mpmath.tan(contact / 4)
    ratio = (u - 2 - root) / (u - 2 + root) * mpmath.exp(root * (t - contact))
    u = 2 + root * (1 + ratio) / (1 - ratio)
    phi = 2 * mpmath.atan(u) - t  # direction from the point to the centre
    return [mpmath.sin(t) - mpmath.cos(phi) / 2, mpmath.cos(t) - mpmath.sin(phi) / 2]


def closed_forms():
    """(model, case) -> (event times without the start, end state)."""
    pi, sqrt, exp = mpmath.pi, mpmath.sqrt, mpmath.exp
    turn = mpf(1.5707963267948966) - 1
    reach = mpmath.findroot(lambda t: -1 + t + (1 - mpmath.cos(5 * t)) / 25, 0.94)
    first, last = mpmath.atan(2) / 2, 6 - mpmath.atan(2) / 2 - 3 * pi / 2
    far = 64 * sqrt(mpf(1) / 20) * exp(-mpf(6) / 10)
    end = mpf(4.611844073359521) - 5 * pi / 12 - sqrt(3)
    return {
        ("crossing", ""): ([mpf(1) / 3], [mpf(2) / 3]),
        ("crossing", "to pi/4"): ([mpf(1) / 3], [mpf(0.7853981633974483) - mpf(1) / 3]),
        ("sliding", ""): ([reach], [0]),
        ("leaving-sliding", ""): ([1], [mpf(1) / 8]),
        ("spontaneous-switch", ""): ([], [1]),
        ("spontaneous-switch", "initial_mode -1"): ([], [-1]),
        ("spontaneous-switch", "initial_mode 0"): ([], [0]),
        ("simplest-switch", ""): ([mpf(1) / 2], [mpf(1) / 5]),
        ("entering-sliding", ""): ([sqrt(2)], [0]),
        ("asymmetric-sliding", ""): ([sqrt(2) / 3], [0]),
        ("rotating-oscillator", ""): (
            [1],
            [exp(turn) * mpmath.cos(2 * pi * turn), -exp(turn) * mpmath.sin(2 * pi * turn)],
        ),
        ("dry-friction-oscillator", ""): ([k * pi for k in (1, 2, 3, 4)], [-mpf(1) / 5, 0]),
        ("dry-friction-oscillator", "stuck from the start"): ([], [mpf(1) / 4, 0]),
        ("two-lines", ""): ([mpf(1) / 7], [mpf(31) / 34] * 2),
        ("two-lines", "from below"): ([mpf(1) / 10], [mpf(6) / 5 - mpf(6) / 17 * mpf(9) / 10] * 2),
        ("half-plane", ""): ([5 * pi / 12, 5 * pi / 12 + sqrt(3)], [-mpmath.sin(end), -mpmath.cos(end)]),
        ("quadrants", ""): (
            [first + k * pi / 4 for k in range(7)],
            [-far * mpmath.cos(2 * last), 2 * far * mpmath.sin(2 * last)],
        ),
        ("sweeping-disc", ""): ([2 * mpmath.asin(mpf(1) / 4)], swept_point(mpf(10))),
    }


def compare_with_closed_form(problem, entry, closed):
    expected = closed.get((problem.model, problem.case))
    if expected is None:
        assert problem.source != CLOSED, f"{problem.model} claims a closed form"
        return
    times = [event["t"] for event in entry["events"] if event["kind"] != "start"]
    assert len(times) == len(expected[0]), (problem.model, times)
    for found, exact in zip(times + entry["final"]["x"], list(expected[0]) + list(expected[1])):
        assert abs(found - exact) < mpf(10) ** -25, (problem.model, problem.case, found, exact)
