"""Problems whose solutions reach the intersection of two surfaces, for make_references.py."""

from mpmath import mp, mpf
from taylor_events import Explicit, Problem, Series, Step, alphas, clock_at, decide, first_root, kind_of, start

from catalogue_problems import TAYLOR, decimal, mix


class TogetherProblem(Problem):
    """Surfaces that may be reached, or left, at the same time: one event then. They do not act on each other."""

    def ends(self, step):
        """(h, surface, side where its alpha ends) of everything that may end the step."""
        for j, k in enumerate(step.mode):
            if k != 0:
                yield first_root(step.psi[j], step.h), j, None
            elif isinstance(step.alpha[j], Series):
                yield first_root(step.alpha[j], step.h), j, -1
                yield first_root((1 - step.alpha[j]).to(len(step.alpha[j].c)), step.h), j, 1

    def solve(self, degree):
        t, x, until = mpf(0), [mpf(value) for value in self.x0()], mpf(self.until())
        mode, events = start(self, t, x)
        while t < until:
            step = Step(self, t, x, mode, degree)
            h = min(step.h, until - t)
            found = [entry for entry in self.ends(step) if entry[0] is not None and entry[0] <= h]
            if not found:
                t, x = (until if h == until - t else t + h), [series.at(h) for series in step.x]
                continue
            first = min(entry[0] for entry in found)
            together = [entry for entry in found if entry[0] - first < mpf(10) ** (-mp.dps // 2)]
            t, x = t + first, [series.at(first) for series in step.x]
            after = list(mode)
            for _, j, side in together:
                after[j] = side if side is not None else decide(self, t, x, mode, j)
            events.append(dict(t=t, kind=kind_of(mode, after), surfaces=[self.names[j] for _, j, _ in sorted(together, key=lambda e: e[1])],
                               mode_before=mode, mode_after=after, x=list(x)))
            mode = after
        return dict(events=events, final=dict(t=t, x=x, mode=mode, alpha=alphas(self, clock_at(t, 1), x, mode)))


def two_belts():
    def f(c, x, a):
        both = a[0] * a[1]
        first = mix(a[0], -1 / (decimal("0.8") + x[1]), 1 / (decimal("1.2") - x[1]))
        second = mix(a[1], -1 / (decimal("0.6") + x[2]), 1 / (decimal("1.4") - x[2]))
        pull = x[0] * (x[1] + decimal("0.8")) * (x[2] + decimal("0.6"))
        return [(x[1] + x[2]) / 2 + pull * both, first - x[0], second - x[0]]

    return TogetherProblem(model="two-belts", names=["first", "second"],
                           x0=lambda: [decimal("0.04"), decimal("-0.01"), decimal("-0.02")], f=f,
                           psi=lambda c, x: [x[1] - decimal("0.2"), x[2] - decimal("0.4")],
                           psi_dot=lambda c, x, v: [v[1], v[2]], until=lambda: 20, source=TAYLOR, max_step=0.2)


def two_genes(x1, x2, case=""):
    def f(c, x, a):
        low1, high1, low2, high2 = a
        return [decimal("-4.5") * x[0] + 40 * (1 - high1) * low2, decimal("-1.5") * x[1] + 40 * low1 * (1 - high2)]

    overrides = {} if not case else dict(x1=x1, x2=x2)
    return Problem(model="two-genes", names=["low1", "high1", "low2", "high2"], x0=lambda: [x1, x2], f=f,
                   psi=lambda c, x: [x[0] - 4, x[0] - 8, x[1] - 4, x[1] - 8],
                   psi_dot=lambda c, x, v: [v[0], v[0], v[1], v[1]], until=lambda: 1, source=TAYLOR, max_step=0.1,
                   case=case, overrides=overrides)


def sign(value):
    return 1 if value > 0 else -1


def turns(x, velocity, names, on=None):
    """Crossings of the axes by a solution with constant velocities per quadrant: exact but for rounding."""
    t, x = mpf(0), [mpf(value) for value in x]
    mode = [sign(value) for value in x]
    if on is not None:
        mode[on] = sign(velocity(mode)[on])
    while True:
        v = velocity(mode)
        h, j = min((-x[j] / v[j], j) for j in range(2) if x[j] * v[j] < 0)
        t += h
        x = [mpf(0) if i == j else x[i] + h * v[i] for i in range(2)]
        after = [-k if i == j else k for i, k in enumerate(mode)]
        yield dict(t=t, kind="crossing", surfaces=[names[j]], mode_before=mode, mode_after=after, x=x)
        mode = after


def filippov_spiral():
    def solution():
        velocity = lambda k: [mpf(-k[0] + 2 * k[1]), mpf(-2 * k[0] - k[1])]
        events = [dict(t=mpf(0), kind="start", surfaces=["x1"], mode_before=None, mode_after=[1, 1], x=[mpf(0), mpf(1)])]
        # Four cycles of four crossings must have shrunk, behind two to compare with: by then 1e-8 of the time is left.
        crossings = turns([0, 1], velocity, ["x1", "x2"], on=0)
        events += [next(crossings) for _ in range(FILIPPOV_CROSSINGS)]
        last = events[-1]
        events.append(dict(t=mpf(1) / 2, kind="accumulation", surfaces=["x1", "x2"], mode_before=last["mode_after"],
                           mode_after=[0, 0], x=last["x"], x_after=[mpf(0), mpf(0)]))
        return dict(events=events, final=dict(t=mpf(1), x=[mpf(0), mpf(0)], mode=[0, 0], alpha=[mpf(1) / 2, mpf(1) / 2]))

    return Explicit(model="filippov-spiral", solution=solution)


FILIPPOV_CROSSINGS = 25


def slow_spiral():
    """Up to t = 1, half of the way: 34 of the 918 crossings."""

    def solution():
        velocity = lambda k: [mpf(-5 * k[0] - 495 * k[1]), mpf(495 * k[0] - 5 * k[1])]
        events, until = [], mpf(1)
        for event in turns([10, 10], velocity, ["x1", "x2"]):
            if event["t"] > until:
                break
            events.append(event)
        last = events[-1]
        mode = last["mode_after"]
        x = [value + (until - last["t"]) * rate for value, rate in zip(last["x"], velocity(mode))]
        return dict(events=events, final=dict(t=until, x=x, mode=mode, alpha=[mpf((k + 1) // 2) for k in mode]))

    return Explicit(model="slow-spiral", solution=solution)


def problems():
    yield two_belts()
    yield two_genes(6, 6)
    for x1, x2 in ((12, 3), (3, 6), (12, 12)):
        yield two_genes(x1, x2, f"from ({x1}, {x2})")
    yield filippov_spiral()
    yield slow_spiral()


# Published, or from an independent integration of order 8
LITERATURE = {("two-belts", ""): ["0.2443307895604", "0.5549932424652", "3.2542010690042", "7.9900594166162"],
              ("two-genes", ""): ["0.0678551295400", "0.2619233325203"]}


def compare_with_literature(problem, entry):
    times = [event["t"] for event in entry["events"] if event["kind"] != "start"]
    for found, expected in zip(times, LITERATURE.get((problem.model, problem.case), [])):
        assert abs(found - mpf(expected)) < mpf("1e-12"), (problem.model, found, expected)
