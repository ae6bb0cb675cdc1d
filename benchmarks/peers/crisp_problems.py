"""The problems of crisp.py: writes them as JSON of CasADi, and simulates found controls in continuous time by the event engine.

    crisp_problems.py write FOLDER            crisp_problems.py grid PROBLEM RESULT.json

Implicit Euler: z_{k+1} = z_k + dt f(z_{k+1}, u_k, forces_{k+1}). Ours, as the sources leave them open: goals (transport 2 m), start and bound of the
push-bot (0.4 rad, 12 N), the path of `push`, which has one face of the T (no change of the face).
"""

import json
import pathlib
import sys

import casadi as ca
import numpy


class Program:
    """Variables, rows and pairs as they come."""

    def __init__(self):
        self.w, self.low, self.high, self.start, self.rows, self.G, self.H, self.cost = [], [], [], [], [], [], [], 0

    def variable(self, name, size, low=-numpy.inf, high=numpy.inf, start=0.0):
        symbol = ca.SX.sym(name, size)
        self.w.append(symbol)
        for values, value in ((self.low, low), (self.high, high), (self.start, start)):
            values.extend(float(v) for v in numpy.broadcast_to(value, size))
        return symbol

    def pair(self, side, other, start=0.0):
        """0 <= side (a variable), 0 <= other (an expression), one of them zero."""
        self.G.append(side)
        self.H.append(self.variable("d", 1, 0, start=start))
        self.rows.append(self.H[-1] - other)

    def write(self, file):
        w, p = ca.vertcat(*self.w), ca.SX.sym("p", 1)

        def function(name, value):
            return ca.Function(name, [w, p], [value]).serialize()

        zeros = [0.0] * len(self.rows)
        text = {"w": w.serialize() if hasattr(w, "serialize") else "", "w0": self.start, "lbw": self.low, "ubw": self.high, "p0": [0.0],
                "g_fun": function("g", ca.vertcat(*self.rows)), "lbg": zeros, "ubg": zeros, "G_fun": function("G", ca.vertcat(*self.G)),
                "H_fun": function("H", ca.vertcat(*self.H)), "augmented_objective_fun": function("f", self.cost),
                "objective_fun": function("f", self.cost), "p": p.serialize() if hasattr(p, "serialize") else ""}
        file.write_text(json.dumps(text), encoding="utf-8")


def friction(program, speed, largest):
    """A force against a speed: largest step(-speed) - largest step(speed)."""
    force = program.variable("f", 1, -largest, largest)
    plus, minus = program.variable("sp", 1, 0), program.variable("sm", 1, 0)
    program.rows.append(speed - plus + minus)
    program.pair(plus, largest + force, largest)
    program.pair(minus, largest - force, largest)
    return force


def transport():
    program, z, m1, m2, dt = Program(), ca.SX([0, 0, 0, 0]), 1.0, 2.0, 0.02
    for _ in range(200):
        u, new = program.variable("u", 1), program.variable("z", 4)
        force = friction(program, new[3] - new[2], 0.2 * m2 * 9.81)  # on the load, against its speed on the cart
        rate = ca.vertcat(new[2], new[3], (u - force) / m1, force / m2)
        program.rows += ca.vertsplit(new - z - dt * rate)
        distance = program.variable("l", 1, -1.0, 1.0)  # abs(x1 - x2) <= 1
        program.rows.append(distance - (new[0] - new[1]))
        program.cost += 1e-4 * u**2
        z = new
    goal = ca.vertcat(2, 2)
    program.cost += 1e5 * ca.sumsqr(z[:2] - goal) + 10 * ca.sumsqr(z[2:])
    return program


def push_bot():
    program, z, dt, k = Program(), ca.SX([0, 0.4, 0, 0]), 0.02, 200.0
    for _ in range(100):
        u, new = program.variable("u", 1, -12, 12), program.variable("z", 4, start=[0, 0.4, 0, 0])
        walls = []
        for side in (1, -1):
            force = program.variable("w", 1, 0)
            program.pair(force, force / k + 1 - side * (new[0] + 0.8 * ca.sin(new[1])), 1)
            walls.append(force)
        program.rows += ca.vertsplit(new - z - dt * cart_pole(new, u, walls[1] - walls[0]))
        program.cost += 1e-4 * u**2
        z = new
    program.cost += 1e3 * ca.sumsqr(z[:2]) + 10 * ca.sumsqr(z[2:])
    return program


def cart_pole(z, u, wall, mc=1.0, mp=0.1, length=0.8):
    """th = 0 stands; a point mass at the end of the pole, which the wall pushes."""
    sin, cos = ca.sin(z[1]), ca.cos(z[1])
    right = ca.vertcat(u + wall + mp * length * z[3] ** 2 * sin, mp * 9.81 * length * sin + wall * length * cos)
    det = (mc + mp) * mp * length**2 - (mp * length * cos) ** 2
    return ca.vertcat(z[2], z[3], (mp * length**2 * right[0] - mp * length * cos * right[1]) / det,
                      ((mc + mp) * right[1] - mp * length * cos * right[0]) / det)


def push():
    """Quasi-static: the velocity of the body is the force, in units in which the limit surface is a ball; its finger slides on a face."""
    program, z, dt, mu, half = Program(), ca.SX([0, 0, 0, 0]), 0.05, 0.4, 0.05
    for _ in range(50):
        normal, tangent = program.variable("n", 1, 0, 0.3), program.variable("t", 1, -0.12, 0.12)
        new = program.variable("z", 4, [-numpy.inf] * 3 + [-half], [numpy.inf] * 3 + [half])
        plus, minus = program.variable("sp", 1, 0), program.variable("sm", 1, 0)
        program.pair(plus, mu * normal - tangent)
        program.pair(minus, mu * normal + tangent)
        sin, cos = ca.sin(new[2]), ca.cos(new[2])
        rate = ca.vertcat(cos * normal - sin * tangent, sin * normal + cos * tangent, (-new[3] * normal - half * tangent) / half**2 * 0.4, plus - minus)
        program.rows += ca.vertsplit(new - z - dt * rate)
        program.cost += 1e-2 * (normal**2 + tangent**2) + 1e-3 * (plus**2 + minus**2)
        z = new
    program.cost += 100 * ca.sumsqr(z[:2] - ca.vertcat(0.2, 0.1)) + 10 * (z[2] - 0.8) ** 2
    return program


PROBLEMS = {"transport": transport, "push-bot": push_bot, "push": push}
MODELS = {
    "transport": ("x1 x2 v1 v2", [0, 0, 0, 0], 200, 0.02, {"x1": "v1", "x2": "v2", "v1": "u + 3.924*sign(v2 - v1)", "v2": "-1.962*sign(v2 - v1)"}),
    "push-bot": ("x th v w", [0, 0.4, 0, 0], 100, 0.02, {
        "x": "v", "th": "w", "v": "(0.064*r1 - 0.08*cos(th)*r2)/det", "w": "(1.1*r2 - 0.08*cos(th)*r1)/det"}),
}
DEFINITIONS = """[definitions]
tip = "x + 0.8*sin(th)"
wall = "200*max(0, -1 - tip) - 200*max(0, tip - 1)"
r1 = "u + wall + 0.08*w^2*sin(th)"
r2 = "0.7848*sin(th) + 0.8*wall*cos(th)"
det = "0.0704 - 0.0064*cos(th)^2"
"""


def difference(problem, file):
    """Largest difference of the end state in continuous time from that of the grid; None where the problem has no model."""
    if problem not in MODELS:
        return None
    import saltus

    names, start, count, dt, rates = MODELS[problem]
    names = names.split()
    program = PROBLEMS[problem]()
    values, place, controls, last = json.loads(pathlib.Path(file).read_text(encoding="utf-8"))["x"], 0, [], None
    for symbol in program.w:
        name, part = str(symbol[0]).split("_")[0], values[place:place + symbol.numel()]
        place += symbol.numel()
        if name == "u":
            controls.append(part[0])
        if name == "z" or symbol.numel() == 4:
            last = part
    text = f'[model]\nname = "{problem}"\n[states]\n' + "".join(f"{n} = {v}\n" for n, v in zip(names, start, strict=True))
    text += "[controls]\nu = 0\n" + (DEFINITIONS if problem == "push-bot" else "") + "[dynamics]\n" + "".join(f'{n} = "{e}"\n' for n, e in rates.items())
    model, state = saltus.Model.from_text(text), dict(zip(names, start, strict=True))
    for k in range(count):
        final = model.simulate(until=dt, set={**state, "u": controls[k]}).final
        state = {n: float(final[n]) for n in names}
    return max(abs(state[n] - v) for n, v in zip(names, last, strict=True))


def main():
    if sys.argv[1] == "write":
        for name, problem in PROBLEMS.items():
            problem().write(pathlib.Path(sys.argv[2]) / f"{name}.json")
    else:
        print(json.dumps(difference(sys.argv[2], sys.argv[3])))


if __name__ == "__main__":
    main()
