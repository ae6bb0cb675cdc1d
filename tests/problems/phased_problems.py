"""Problems whose right-hand side jumps or bends at given times (samples, resets, points of a table), for
make_references.py: the Taylor series of taylor_events.py, begun anew at every such time."""

from dataclasses import dataclass, field

import mpmath
from mpmath import mp, mpf
from taylor_events import Problem, Step, alphas, clock_at, decide, kind_of, next_event, start

TAYLOR = "Taylor series of degree 40 and 52 with 40 and 50 digits, begun anew at every reset, sample or point"


@dataclass
class PhasedProblem(Problem):
    """`times()` are ascending; f and psi find the number of those that have passed in `phase[0]`."""

    times: object = None
    phase: list = field(default_factory=lambda: [0])
    kinks: tuple = ()  # names of switching functions that are nothing but kinks: no events

    def solve(self, degree):
        times = [mpf(time) for time in self.times()]
        until = mpf(self.until())
        t, x = mpf(0), [mpf(value) for value in self.x0()]
        self.phase[0] = sum(time <= t for time in times)
        mode, events = start(self, t, x)
        events = [event for event in events if self.shown(event)]
        while t < until:
            limit = min([until] + times[self.phase[0] : self.phase[0] + 1])
            step = Step(self, t, x, mode, degree)
            h = min(step.h, limit - t)
            event = next_event(step)
            if event is None or event[0] > h:
                reached = h == limit - t
                t, x = (limit if reached else t + h), [series.at(h) for series in step.x]
                if reached and limit < until:
                    self.phase[0] += 1
                    mode = self.change(t, x, mode, self.behind_break(t, x, mode), events)
                continue
            h, j, side = event
            t, x = t + h, [series.at(h) for series in step.x]
            after = list(mode)
            after[j] = side if side is not None else decide(self, t, x, mode, j)
            mode = self.change(t, x, mode, after, events)
        final_alpha = alphas(self, clock_at(t, self.frequency), x, mode)
        listed = [j for j, name in enumerate(self.names) if name not in self.kinks]
        return dict(events=events, final=dict(t=t, x=x, mode=[mode[j] for j in listed],
                                              alpha=[final_alpha[j] for j in listed]))

    def behind_break(self, t, x, mode):
        """Signs read anew; what slides and is still at zero is decided with the new fields."""
        after = list(mode)
        for j, value in enumerate(self.psi(clock_at(t, self.frequency), x)):
            if abs(value) > mpf(10) ** (-mp.dps // 2):
                after[j] = int(mpmath.sign(value))
            else:
                after[j] = decide(self, t, x, mode, j)
            assert after[j] is not None
        return after

    def shown(self, event):
        return not set(event["surfaces"]) & set(self.kinks)

    def change(self, t, x, before, after, events):
        changed = [j for j in range(len(before)) if before[j] != after[j] and self.names[j] not in self.kinks]
        if changed:
            listed = [j for j, name in enumerate(self.names) if name not in self.kinks]
            events.append(
                dict(t=t, kind=kind_of([before[j] for j in changed], [after[j] for j in changed]),
                     surfaces=[self.names[j] for j in changed], mode_before=[before[j] for j in listed],
                     mode_after=[after[j] for j in listed], x=list(x))
            )
        return after


def decimal(text):
    return mpf(text)


def buck_converter(voltage, case, end):
    phase = [0]
    period = lambda: decimal("400e-6")
    ramp = lambda c: decimal("3.8") + decimal("4.4") * (c.t - phase[0] * period()) / period()

    def f(c, x, a):
        return [(x[1] - x[0] / 22) / decimal("47e-6"), (voltage * a[0] - x[0]) / decimal("20e-3")]

    return PhasedProblem(
        model="buck-converter", case=case, overrides={} if voltage == 22 else {"Vin": voltage}, names=["control"],
        x0=lambda: [decimal("11.9982317"), decimal("0.5996358")], f=f,
        psi=lambda c, x: [ramp(c) - decimal("8.4") * (x[0] - decimal("11.3"))],
        psi_dot=lambda c, x, v: [decimal("4.4") / period() - decimal("8.4") * v[0]],
        until=lambda: decimal(end), times=lambda: [k * period() for k in range(1, 21)], phase=phase, source=TAYLOR,
        max_step=1e-4,
    )


ROAD = """1.0 0  1.5 0.004  2.0 0.003  2.5 0.009  3.0 0.006  3.5 0.011  4.0 0.008  4.5 0.012  5.0 0.010  5.3 0.050
5.6 0.075  5.9 0.070  6.2 0.020  6.5 0.005  7.0 -0.004  8.0 -0.010  9.0 0.002  10.0 0.007  11.0 0.001  12.0 -0.003
13.0 0""".split()


def quarter_car():
    phase = [0]
    points = lambda: [(mpf(ROAD[i]), mpf(ROAD[i + 1])) for i in range(0, len(ROAD), 2)]

    def road(x):
        k, table = phase[0], points()
        if k == 0 or k == len(table):
            return table[min(k, len(table) - 1)][1]
        (a, b), (c, d) = table[k - 1], table[k]
        return b + (d - b) / (c - a) * (x - a)

    load = lambda x: 160000 * (road(x[0]) - x[3]) + 285 * decimal("9.81")

    def f(c, x, a):
        stretch = x[2] - x[4]
        force = 16000 * (x[1] - x[3]) + (700 + 900 * a[0]) * stretch
        tyre = a[1] * load(x) - 285 * decimal("9.81")
        return [mpf(15), x[2], -force / 250, x[4], (force + tyre) / 35]

    def psi_dot(c, x, v):
        slope = 0
        if 0 < phase[0] < len(points()):
            (a, b), (e, d) = points()[phase[0] - 1], points()[phase[0]]
            slope = (d - b) / (e - a)
        return [v[2] - v[4], 160000 * (slope * v[0] - v[3])]

    return PhasedProblem(
        model="quarter-car", names=["stretch", "load"], kinks=("stretch", "load"), x0=lambda: [0, decimal("0.02"), 0, 0, 0], f=f,
        psi=lambda c, x: [x[2] - x[4], load(x)], psi_dot=psi_dot, until=lambda: decimal("1.5"),
        times=lambda: [x / 15 for x, _ in points()], phase=phase, source=TAYLOR, max_step=0.02,
    )


def stepped_drive():
    phase = [0]
    sample = lambda: phase[0] * decimal("0.05")
    force = lambda: 3 * mpmath.floor(4 * mpmath.sin(2 * mpmath.pi * sample()) + decimal("0.5")) / 4

    def f(c, x, a):
        return [force() - 2 * x[0] - decimal("1.6") * (2 * a[0] - 1)]

    return PhasedProblem(
        model="stepped-drive", names=["v"], x0=lambda: [0], f=f, psi=lambda c, x: [x[0]],
        psi_dot=lambda c, x, v: [v[0]], until=lambda: decimal("2.02"),
        times=lambda: [k * decimal("0.05") for k in range(1, 41)], phase=phase, source=TAYLOR, max_step=0.05,
    )


def compare_with_literature(problem, entry):
    """The converter at 22 V starts on its cycle of period T: there it must still be after twenty of them."""
    if problem.model == "buck-converter" and not problem.case:
        resets = [event for event in entry["events"] if event["mode_after"] == [-1]]
        assert len(resets) == 20, len(resets)
        assert abs(resets[-1]["x"][0] - mpf("11.9982317")) < 1e-7 and abs(resets[-1]["x"][1] - mpf("0.5996358")) < 1e-7


def problems():
    yield buck_converter(22, "", "0.0081")
    yield buck_converter(25, "Vin = 25", "0.0081")
    # Chaotic: what a simulation may get wrong grows by a factor of 1.5 or so in every period.
    yield buck_converter(33, "Vin = 33", "0.0041")
    yield quarter_car()
    yield stepped_drive()
