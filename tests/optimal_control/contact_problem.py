"""A random optimal control problem with contacts, and a check of its result that shares nothing with the tool.

Bounds, targets and costs are taken from the controls and the end state of the file, gaps from its trajectory, and each
interval is simulated by Moreau's time stepping.
"""

import random

from solved_checks import faults_of_certificate, ranges_of

STEPS = 1000  # of a simulated interval
SWEEPS = 30  # of Gauss and Seidel over the contacts in a step
DEPTH = 5e-4  # that bodies may be in each other
TOUCH = 1e-4  # a gap below it is closed
TOUCH_AT_NODE = 5e-3  # likewise at the end of an interval, where an impact may be a few steps off
GRAVITY = 9.81


class ContactProblem:
    """M v' = f(v) + B u + N lambda_n + T lambda_t without restitution, with cost r int |u|^2 + sum w_i v_i(T)^2.

    Carts in a row, of which the first is driven and pushes the others; or a ball above a floor with friction. Targets
    are positions at the end.
    """

    family = "contacts"
    tolerance = 1e-3  # of verification

    def __init__(self, seed):
        dice = random.Random(seed)
        self.number = lambda low, high: round(dice.uniform(low, high), 2)
        number = self.number
        self.seed = seed
        self.horizon = number(2, 4)
        self.intervals = dice.randint(6, 10)
        self.effort = number(0.2, 2)
        self.damping = number(0, 2)
        if dice.random() < 0.5:
            self.draw_carts(dice.randint(2, 3))
        else:
            self.draw_ball()
        self.weight = [number(1, 100) for _ in self.positions]

    def draw_carts(self, count):
        number = self.number
        self.kind, self.width, self.friction = "carts", number(0.5, 2), 0.0
        self.positions = [f"q{i + 1}" for i in range(count)]
        self.mass = [number(0.5, 2) for _ in range(count)]
        places = [0.0]
        while len(places) < count:
            places.append(round(places[-1] + self.width + number(0.1, 1), 2))
        self.start = places
        self.controlled = [0]
        self.bound = number(15, 25)
        self.target = {0: number(-0.5, 0.5), count - 1: round(places[-1] + number(0.3, 1.5), 2)}

    def draw_ball(self):
        number = self.number
        self.kind, self.friction = "ball", number(0, 0.5)
        self.positions = ["x", "z"]
        self.mass = [1.0, 1.0]
        self.start = [0.0, number(0.1, 1)]
        self.controlled = [0, 1]
        self.bound = number(12, 20)
        self.target = {0: number(0.5, 4), 1: number(0.1, 1)}

    def names(self):
        return self.positions, [f"v_{q}" for q in self.positions], [f"u_{self.positions[i]}" for i in self.controlled]

    def gaps(self):
        """Of each contact its text, and its value and velocity as a function of positions or velocities."""
        if self.kind == "ball":
            return [("z", lambda q: q[1], [0.0, 1.0])]
        count = len(self.positions)
        rows = [[float(i == k + 1) - float(i == k) for i in range(count)] for k in range(count - 1)]
        return [(f"{self.positions[k + 1]} - {self.positions[k]} - {self.width}",
                 lambda q, k=k: q[k + 1] - q[k] - self.width, row) for k, row in enumerate(rows)]

    def text(self):
        q, v, u = self.names()
        quoted = lambda names: "[" + ", ".join(f'"{name}"' for name in names) + "]"
        lines = ["[model]", f'name = "random-contacts-{self.seed}"', "[states]"]
        lines += [f"{name} = {value}" for name, value in zip(q + v, self.start + [0.0] * len(v))] + ["[controls]"]
        lines += [f"{name} = {{ lower = {-self.bound}, upper = {self.bound} }}" for name in u]
        mass = [[m if i == j else 0 for j in range(len(q))] for i, m in enumerate(self.mass)]
        lines += ["[mechanics]", f"positions = {quoted(q)}", f"velocities = {quoted(v)}", f"mass = {mass}"]
        if self.kind == "ball":
            lines.append(f'potential = "{GRAVITY}*z"')
        driven = {i: f" + {name}" for i, name in zip(self.controlled, u)}
        force = ", ".join(f'{name} = "-{self.damping}*{name}{driven.get(i, "")}"' for i, name in enumerate(v))
        lines.append(f"force = {{ {force} }}")
        for k, (gap, _, _) in enumerate(self.gaps()):
            lines += ["[[contacts]]", f'name = "contact{k + 1}"', f'gap = "{gap}"']
            lines += ["tangent = { x = 1 }", f"friction = {self.friction}"] if self.kind == "ball" else []
        speeds = " + ".join(f"{w}*{name}^2" for w, name in zip(self.weight, v))
        targets = [f"{q[i]} == {value}" for i, value in self.target.items()]
        lines += ["[time_freezing]", "a_n = 20", "speed = { lower = 0.5, upper = 20 }", "[optimize]",
                  f"horizon = {self.horizon}", f"control_intervals = {self.intervals}", "elements = 3", "stages = 2",
                  f"verification_tolerance = {self.tolerance}",
                  f'running_cost = "{self.effort}*({" + ".join(f"{name}^2" for name in u)})"',
                  f'terminal_cost = "{speeds}"', f"terminal_constraints = {quoted(targets)}"]
        return "\n".join(lines) + "\n"

    def pressed(self, q, v, touch=TOUCH):
        """Velocities behind inelastic impacts and friction of the contacts that are closed, by Gauss and Seidel."""
        v = list(v)
        closed = [row for _, gap, row in self.gaps() if gap(q) <= touch]
        impulses = [0.0] * len(closed)
        for _ in range(SWEEPS if len(closed) > 1 else 1):
            for k, row in enumerate(closed):
                speed = sum(a * value for a, value in zip(row, v))
                response = sum(a * a / m for a, m in zip(row, self.mass))
                change = max(impulses[k] - speed / response, 0.0) - impulses[k]
                impulses[k] += change
                v = [value + a * change / m for a, m, value in zip(row, self.mass, v)]
        if self.kind == "ball" and closed:
            limit = self.friction * impulses[0] / self.mass[0]
            v[0] -= min(max(v[0], -limit), limit)
        return v

    def simulated(self, x, u, length):
        """Moreau's time stepping: of the order of a step, with contacts as they are at its end."""
        n, h = len(self.positions), length / STEPS
        q, v = x[:n], x[n:]
        drive = [0.0] * n
        for i, value in zip(self.controlled, u):
            drive[i] = value
        if self.kind == "ball":
            drive[1] -= GRAVITY
        for _ in range(STEPS):
            free = [s + h * (f - self.damping * s) / m for s, f, m in zip(v, drive, self.mass)]
            v = self.pressed([p + h * s for p, s in zip(q, free)], free)
            q = [p + h * s for p, s in zip(q, v)]
        return q + v

    def can_follow(self, result):
        return not result["verification"]["message"]

    def faults(self, result):
        """What a completed result states that its own numbers do not bear out."""
        found = faults_of_certificate(result)
        n = len(self.positions)
        nodes, end = [node[:2 * n] for node in result["start_values"]["nodes"]], result["final"]["x"]
        length, ranges = self.horizon / self.intervals, ranges_of(nodes)
        behind = lambda x: x[:n] + self.pressed(x[:n], x[n:], TOUCH_AT_NODE)
        for k, u in enumerate(result["u"]):
            found.expect(max(map(abs, u)) <= self.bound * (1 + 1e-8), f"controls {u} of interval {k}")
            ahead = behind(self.simulated(nodes[k], u, length))
            for i, (value, expected) in enumerate(zip(ahead, behind(nodes[k + 1]))):
                found.expect_near(value, expected, 0.03 * max(1.0, ranges[i]), f"state {i} simulated over interval {k}")
        for x in result["trajectory"]["x"]:
            for k, (_, gap, _) in enumerate(self.gaps()):
                found.expect(gap(x) >= -1.01 * DEPTH, f"gap {gap(x):.2e} of contact {k + 1}")
        for i, value in self.target.items():
            found.expect_near(end[i], value, 1e-6, f"target of {self.positions[i]}")
        effort = self.effort * length * sum(u * u for row in result["u"] for u in row)
        cost = effort + sum(w * v * v for w, v in zip(self.weight, end[n:]))
        found.expect_near(cost, result["objective"], 1e-6 * (1 + abs(cost)), "objective")
        return found
