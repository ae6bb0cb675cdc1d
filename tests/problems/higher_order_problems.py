"""Higher-order sliding, up to some time before its limit, and ambiguous intersections, for make_references.py."""

from mpmath import exp, mp, mpf, pi, sin, sqrt
import mpmath
from taylor_events import Explicit


def twisting():
    """Parabolas until t = 9. On each, x1 and x2 are polynomials; z' = x1 - z/5 is solved with them."""

    def solution():
        until, t = mpf(9), mpf(0)
        x1, x2, z = mpf(10), mpf(10), mpf(5)
        mode, events, rate = [1, 1], [], mpf(1) / 5

        def after(h, force):
            # z = p(h) + (z0 - p(0)) exp(-h/5) with p' = x1 - p/5: p = c0 + c1 h + c2 h^2 for x1 = x1 + x2 h + force h^2/2
            c2 = force / 2 / rate
            c1 = (x2 - 2 * c2) / rate
            c0 = (x1 - c1) / rate
            return x1 + x2 * h + force * h * h / 2, x2 + force * h, c0 + c1 * h + c2 * h * h + (z - c0) * exp(-rate * h)

        while True:
            force = -10 * mode[0] - 3 * mode[1]
            turn = -x2 / force if x2 != 0 else mpf(-1)
            root = sqrt(x2 * x2 - 2 * force * x1)
            zeros = [h for h in ((-x2 + root) / force, (-x2 - root) / force) if h > mpf(10) ** -20 and x1 != 0]
            if x1 == 0:
                zeros = [-2 * x2 / force]
            h, j = min([(h, 0) for h in zeros if h > 0] + ([(turn, 1)] if turn > 0 else []))
            if t + h > until:
                x1, x2, z = after(until - t, force)
                return dict(events=events, final=dict(t=until, x=[x1, x2, z], mode=mode,
                                                      alpha=[mpf((k + 1) // 2) for k in mode]))
            x1, x2, z = after(h, force)
            if j == 0:
                x1 = mpf(0)
            else:
                x2 = mpf(0)
            t, before = t + h, mode
            mode = [-k if i == j else k for i, k in enumerate(before)]
            events.append(dict(t=t, kind="crossing", surfaces=[f"x{j + 1}"], mode_before=before, mode_after=mode,
                               x=[x1, x2, z]))

    return Explicit(model="twisting", solution=solution)


def super_twisting():
    """In the time s with dt = 2 w ds, w = sqrt(x1), a half turn is linear: w = x20 exp(-k1 s/2) sin(omega s)/omega."""

    def solution():
        k1, k2, until = mpf(3) / 2, mpf(11) / 10, mpf(6) / 5
        omega = sqrt(2 * k2 - k1 * k1 / 4)
        r = exp(-pi * k1 / 2 / omega)
        first = (1 + r) / k2
        events = [dict(t=mpf(0), kind="start", surfaces=["x1"], mode_before=None, mode_after=[1], x=[mpf(0), mpf(1)]),
                  dict(t=first, kind="crossing", surfaces=["x1"], mode_before=[1], mode_after=[-1], x=[mpf(0), -r])]
        # The second half turn, mirrored, until t = 1.2: x2 is known, x1 at the s where it is that.
        size, x2 = r, -r + k2 * (until - first)
        w = lambda s: size * exp(-k1 * s / 2) * mpmath.sin(omega * s) / omega
        slope = lambda s: size * exp(-k1 * s / 2) * (mpmath.cos(omega * s) - k1 / 2 / omega * mpmath.sin(omega * s))
        # w' = -k1 w + |x2|, mirrored: x2 = -(w' + k1 w).
        s = mpmath.findroot(lambda s: slope(s) + k1 * w(s) + x2, (mpf(1) / 10, pi / omega - mpf(1) / 10),
                            solver="anderson", tol=mpf(10) ** (-2 * mp.dps + 10))
        return dict(events=events, final=dict(t=until, x=[-w(s) ** 2, x2], mode=[-1], alpha=[mpf(0)]))

    return Explicit(model="super-twisting", solution=solution)


def ambiguous(model, until, fields, other_modes):
    """Constant fields, columns --, -+, +-, ++; from (0, -1) along x = 0 to the intersection, which holds the solution.

    Selections of sliding on both: the multi-affine g(alpha) = 0 with det G > 0.
    """

    def solution():
        f = [[mpf(text) for text in row] for row in fields]
        below = f[0][0] / (f[0][0] - f[0][2])
        rate = f[1][0] + below * (f[1][2] - f[1][0])
        g = lambda j, a, b: ((1 - a) * ((1 - b) * f[j][0] + b * f[j][1]) + a * ((1 - b) * f[j][2] + b * f[j][3]))
        g_a = lambda j, b: (1 - b) * (f[j][2] - f[j][0]) + b * (f[j][3] - f[j][1])
        g_b = lambda j, a: (1 - a) * (f[j][1] - f[j][0]) + a * (f[j][3] - f[j][2])
        alpha = lambda b: g(0, 0, b) / (g(0, 0, b) - g(0, 1, b))
        # The first root on the branch of g1 = 0 through its entry.
        b = next(k for k in range(1, 1000) if g(1, alpha(mpf(k) / 1000), mpf(k) / 1000) < 0)
        b = mpmath.findroot(lambda b: g(1, alpha(b), b), (mpf(b - 1) / 1000, mpf(b) / 1000), solver="anderson",
                            tol=mpf(10) ** (-2 * mp.dps + 10))
        a = alpha(b)
        assert g_a(0, b) * g_b(1, a) - g_b(0, a) * g_a(1, b) > 0

        def other(mode):
            """A motion that Definition 2.1 of the paper admits as well; on both surfaces: the root with det G < 0."""
            if mode == [0, 0]:
                steps = [k for k in range(1, 1000) if g(1, alpha(mpf(k) / 1000), mpf(k) / 1000) < 0]
                high = mpmath.findroot(lambda b: g(1, alpha(b), b), (mpf(steps[-1]) / 1000, mpf(steps[-1] + 1) / 1000),
                                       solver="anderson", tol=mpf(10) ** (-2 * mp.dps + 10))
                return dict(mode=mode, alpha=[alpha(high), high])
            if mode == [0, 1]:
                return dict(mode=mode, alpha=[f[0][1] / (f[0][1] - f[0][3]), mpf(1)])
            if mode == [1, 0]:
                return dict(mode=mode, alpha=[mpf(1), f[1][2] / (f[1][2] - f[1][3])])
            return dict(mode=mode, alpha=[mpf((k + 1) // 2) for k in mode])

        events = [dict(t=mpf(0), kind="start", surfaces=["x_zero"], mode_before=None, mode_after=[0, -1],
                       x=[mpf(0), mpf(-1)]),
                  dict(t=1 / rate, kind="enter_sliding", surfaces=["y_zero"], mode_before=[0, -1], mode_after=[0, 0],
                       x=[mpf(0), mpf(0)], unique=False, alternatives=[other(mode) for mode in other_modes])]
        return dict(events=events, final=dict(t=mpf(until), x=[mpf(0), mpf(0)], mode=[0, 0], alpha=[a, b]))

    return Explicit(model=model, solution=solution)


def motions(f):
    """Modes of two surfaces that some constant selections continue with, and these; f = {(k1, k2): (f1, f2)}.

    Leaving both: both components point away. On one: those of its two fields have opposite signs (towards it or not),
    and their mixture points away from the other surface.
    """
    found = []
    for k in f:
        if k[0] * f[k][0] > 0 and k[1] * f[k][1] > 0:
            found.append((list(k), [mpf((k[0] + 1) // 2), mpf((k[1] + 1) // 2)]))
    for on in (0, 1):
        for side in (-1, 1):
            below, above = (f[(k, side) if on == 0 else (side, k)] for k in (-1, 1))
            if below[on] * above[on] >= 0:
                continue
            alpha = below[on] / (below[on] - above[on])
            if side * ((1 - alpha) * below[1 - on] + alpha * above[1 - on]) > 0:
                mode, selections = [side, side], [mpf((side + 1) // 2)] * 2
                mode[on], selections[on] = 0, alpha
                found.append((mode, selections))
    return found


def parting(model, product, chosen, until, final):
    """From the origin, held there until t = 1; g1 = (t - 1)/4 s1 + s2 + product s1 s2, g2 = -s1/2 + s2 + s1 s2/5."""

    def others(t, mode):
        f = {(a, b): (mpf(t - 1) / 4 * a + b + product * a * b, mpf(-a) / 2 + b + mpf(a * b) / 5)
             for a in (-1, 1) for b in (-1, 1)}
        found = [dict(mode=k, alpha=alpha) for k, alpha in motions(f) if k != mode]
        # On both: s1 = s2 = 0, and where s2 = s1/2/(1 + s1/5) meets the other branch, which does not attract.
        b = mpf(t - 1) / 4
        s1 = -(b + mpf(1) / 2) / (b / 5 + product / 2)
        roots = ([] if mode == [0, 0] else [mpf(0)]) + ([s1] if abs(s1) < 1 else [])
        return found + [dict(mode=[0, 0], alpha=[(1 + s) / 2, (1 + s / 2 / (1 + s / 5)) / 2]) for s in roots]

    def solution():
        origin = [mpf(0), mpf(0)]
        left = [name for name, k in zip(("x", "y"), chosen) if k != 0]
        assert chosen in [entry["mode"] for entry in others(1, None)]
        events = [dict(t=mpf(0), kind="start", surfaces=["x", "y"], mode_before=None, mode_after=[0, 0], x=origin,
                       unique=False, alternatives=others(0, [0, 0])),
                  dict(t=mpf(1), kind="leave_sliding", surfaces=left, mode_before=[0, 0], mode_after=chosen, x=origin,
                       unique=False, alternatives=others(1, chosen))]
        x, alpha = final()
        return dict(events=events, final=dict(t=mpf(until), x=x, mode=chosen, alpha=alpha))

    return Explicit(model=model, solution=solution, initial_mode=dict(x=0, y=0))


def part_ways():
    return parting("part-ways", mpf(1) / 2, [1, 1], 3,
                   lambda: ([mpf(4) / 8 + 3, mpf(7) / 5], [mpf(1), mpf(1)]))


def slide_or_leave():
    """On x = 0 behind t = 1: s1 = 1/(3/2 - (t - 1)/4), y' = 1 - 3 s1/10."""
    return parting("slide-or-leave", mpf(-3) / 2, [0, 1], 2,
                   lambda: ([mpf(0), 1 - mpf(6) / 5 * mpmath.log(mpf(6) / 5)], [mpf(9) / 10, mpf(1)]))


def consensus():
    """Velocities are constant but for the pull t/2; the pairs meet, then all, and the fourth one leaves at t = 8."""

    def solution():
        half, one = mpf(1) / 2, [1, 1, 1, 1, 1, 1]
        pair = [0, 1, 1, 1, 1, 1]
        second = 4 - sqrt(mpf(12))  # x3 - x4 = -1 + 2 t - t^2/4
        both = [0, 1, 1, 1, 1, 0]
        # Pairs at 2 and -2 + t/4: t^2/8 - 4 t + 2 + second - second^2/8 = 0.
        rest = 2 + second - second * second / 8
        all_meet = 16 - sqrt(256 - 8 * rest)
        mean = lambda t: mpf(3) / 4 + t * t / 16
        three = lambda t: 2 * t - half
        fourth = lambda t: mpf(5) / 2 - 3 * t + t * t / 4
        events = [
            dict(t=half, kind="enter_sliding", surfaces=["x2-x1"], mode_before=one, mode_after=pair,
                 x=[half, half, 1 - half + half, fourth(half)]),
            dict(t=second, kind="enter_sliding", surfaces=["x4-x3"], mode_before=pair, mode_after=both,
                 x=[three(second)] * 2 + [fourth(second)] * 2),
            dict(t=all_meet, kind="enter_sliding", surfaces=["x3-x1", "x4-x1", "x3-x2", "x4-x2"], mode_before=both,
                 mode_after=[0] * 6, x=[three(all_meet)] * 4),
            dict(t=mpf(8), kind="leave_sliding", surfaces=["x4-x1", "x4-x2", "x4-x3"], mode_before=[0] * 6,
                 mode_after=[0, 0, 1, 0, 1, 1], x=[mean(8)] * 4)]
        assert abs(three(all_meet) - mean(all_meet)) < mpf(10) ** -30
        # Two conditions for three selections: not determined.
        return dict(events=events, final=dict(t=mpf(10), x=[mean(8) + 2] * 3 + [mean(8) + 3],
                                              mode=[0, 0, 1, 0, 1, 1], alpha=[None, None, mpf(1), None, mpf(1), mpf(1)]))

    return Explicit(model="consensus", solution=solution)


def problems():
    yield twisting()
    yield super_twisting()
    yield ambiguous("stay-or-leave", 6, [["0.5223", "-0.194", "-1.7734", "1.011"], ["0.609", "0.3146", "-0.9416", "0.115"]],
                    [[0, 1], [1, 0], [-1, 1], [1, 1]])
    yield ambiguous("stay-or-slide", 36, [["0.4168", "1.8276", "-1.4013", "-1.7031"],
                                         ["0.3463", "-0.1174", "-0.904", "0.5849"]], [[0, 0], [0, 1]])
    yield part_ways()
    yield slide_or_leave()
    yield consensus()
