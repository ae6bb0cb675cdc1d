"""The optimal control problems of optimal_control.py in CasADi, for the contenders that are written in Python.

step(psi_j) is alpha_j: x' = f(x, u, alpha). The same problems as model files: MODELS in optimal_control.py.
"""

import dataclasses

import casadi as ca

INFINITY = float("inf")


@dataclasses.dataclass
class Problem:
    """min int_0^T f_q dt + f_T(x(T)), x(0) = x0, g_T(x(T)) = 0; bounds of states hold at all stages."""

    x: ca.SX
    u: ca.SX
    alpha: ca.SX
    f: ca.SX
    psi: ca.SX
    x0: list
    intervals: int
    stages: int
    horizon: float  # fixed, or where it begins
    elements: int = 3
    horizon_bounds: tuple | None = None  # of a free one, whose length is the objective
    x_bounds: tuple | None = None
    u_bounds: tuple = ((), ())
    f_q: ca.SX = dataclasses.field(default_factory=lambda: ca.SX(0))
    f_T: ca.SX = dataclasses.field(default_factory=lambda: ca.SX(0))
    g_T: ca.SX = dataclasses.field(default_factory=lambda: ca.SX(0, 1))
    x0_bounds: tuple | None = None  # of a free initial state
    cross: str = "fe_fe"


def turbo_car():
    x, u, alpha = ca.SX.sym("x", 2), ca.SX.sym("u"), ca.SX.sym("alpha")
    return Problem(x, u, alpha, ca.vertcat(x[1], u * (1 + 2 * alpha)), x[1] - 10, [0, 0], 10, 2, 10,
                   horizon_bounds=(1, 100), x_bounds=([-INFINITY, -25], [INFINITY, 25]), u_bounds=([-5], [5]),
                   g_T=ca.vertcat(x[0] - 200, x[1]))


def sliding_mode():
    x, u, alpha = ca.SX.sym("x", 2), ca.SX.sym("u", 2), ca.SX.sym("alpha", 2)
    psi = ca.vertcat(x[0] + 0.15 * x[1]**2, x[1] - 0.05 * x[0]**3)
    return Problem(x, u, alpha, 1 - 2 * alpha + u, psi, [2 * ca.pi / 3, ca.pi / 3], 6, 3, 4, u_bounds=([-2] * 2, [2] * 2),
                   f_q=ca.dot(u, u), g_T=ca.vertcat(x[0] + ca.pi / 6, x[1] + ca.pi / 4))


def cart_pole():
    x, u, alpha = ca.SX.sym("x", 4), ca.SX.sym("u"), ca.SX.sym("alpha")
    m1, m2, length, g, friction = 1, 0.1, 1, 9.81, 2
    theta, v, w = x[1], x[2], x[3]
    force = u + m2 * length * w**2 * ca.sin(theta) - friction * (2 * alpha - 1)
    gravity = -m2 * g * length * ca.sin(theta)
    det = (m1 + m2) * m2 * length**2 - (m2 * length * ca.cos(theta))**2
    f = ca.vertcat(v, w, (m2 * length**2 * force - m2 * length * ca.cos(theta) * gravity) / det,
                   ((m1 + m2) * gravity - m2 * length * ca.cos(theta) * force) / det)
    return Problem(x, u, alpha, f, v, [1, 0, 0, 0], 20, 2, 5, u_bounds=([-30], [30]),
                   x_bounds=([-5, *[-INFINITY] * 3], [5, *[INFINITY] * 3]), f_q=0.01 * x[0]**2 + u**2,
                   f_T=500 * x[0]**2 + 5000 * (theta - ca.pi)**2 + 200 * v**2 + 200 * w**2)


def motor(intervals, **more):
    x, u, alpha = ca.SX.sym("x", 5), ca.SX.sym("u"), ca.SX.sym("alpha")
    m1, m2, k, resistance, inductance, k_f, k_s, friction = 1.03, 0.56, 2400, 2, 2e-3, 12, 12, 2.1
    spring = k * (x[2] - x[0])
    f = ca.vertcat(x[1], (spring + k_f * x[4] - friction * (2 * alpha - 1)) / m1, x[3], -spring / m2,
                   (u - resistance * x[4] - k_s * x[1]) / inductance)
    return Problem(x, u, alpha, f, x[1], [0] * 5, intervals, 2, u_bounds=([-5], [5]),
                   g_T=ca.vertcat(x[0] - 0.01, x[1], x[2] - 0.01, x[3], x[4]), **({"f_q": u**2} | more))


def stewart_anitescu():
    x, alpha = ca.SX.sym("x"), ca.SX.sym("alpha")
    return Problem(x, ca.SX.sym("u", 0), alpha, 3 - 2 * alpha, x, [-1.5], 1, 2, 2, elements=25, f_q=x**2,
                   f_T=(x - 5 / 3)**2, x0_bounds=([-2], [5]), cross="fe_stage")


PROBLEMS = {
    "turbo car": turbo_car,
    "sliding mode": sliding_mode,
    "cart-pole": cart_pole,
    "motor, u^2": lambda: motor(53, horizon=0.08),
    "motor, T": lambda: motor(30, horizon=0.09, horizon_bounds=(0.01, 1), f_q=ca.SX(0)),
    "Stewart-Anitescu": stewart_anitescu,
}
