"""The problems of mpc.py, as a model file and in CasADi: numbers of nosnoc's examples of model predictive control."""

import dataclasses
import pathlib
import sys
from collections.abc import Callable

import casadi as ca

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "compare"))
import ocp_problems  # noqa: E402


@dataclasses.dataclass
class Loop:
    names: tuple
    controls: tuple
    start: tuple
    sampling: float
    samples: int
    text: str
    ocp: Callable


CART_POLE = """[model]
name = "cart-pole-mpc"
[states]
p = { initial = 1, lower = -10, upper = 10 }
th = 0
vp = 0
w = 0
[controls]
u = { lower = -20, upper = 20 }
[definitions]
force = "u + 0.1*w^2*sin(th) - 3*sign(vp)"
gravity = "-0.981*sin(th)"
det = "0.11 - (0.1*cos(th))^2"
[dynamics]
p = "vp"
th = "w"
vp = "(0.1*force - 0.1*cos(th)*gravity)/det"
w = "(1.1*gravity - 0.1*cos(th)*force)/det"
[optimize]
horizon = 1
control_intervals = 10
elements = 2
stages = 1
running_cost = "p^2 + 10*(th - pi)^2 + vp^2 + w^2 + 0.1*u^2"
terminal_cost = "1000*p^2 + 1000*(th - pi)^2 + vp^2 + w^2"
"""


def cart_pole():
    x, u, alpha = ca.SX.sym("x", 4), ca.SX.sym("u"), ca.SX.sym("alpha")
    force = u + 0.1 * x[3]**2 * ca.sin(x[1]) - 3 * (2 * alpha - 1)
    gravity, det = -0.981 * ca.sin(x[1]), 0.11 - (0.1 * ca.cos(x[1]))**2
    f = ca.vertcat(x[2], x[3], (0.1 * force - 0.1 * ca.cos(x[1]) * gravity) / det, (1.1 * gravity - 0.1 * ca.cos(x[1]) * force) / det)
    error = ca.vertcat(x[0], x[1] - ca.pi, x[2], x[3])
    return ocp_problems.Problem(x, u, alpha, f, x[2], [1, 0, 0, 0], 10, 1, 1.0, elements=2, u_bounds=([-20], [20]),
                                x_bounds=([-10, *[-ca.inf] * 3], [10, *[ca.inf] * 3]),
                                f_q=error.T @ ca.diag([1, 10, 1, 1]) @ error + 0.1 * u**2, f_T=error.T @ ca.diag([1000, 1000, 1, 1]) @ error)


# M q'' = u + G - C - 0.3 q' - M (0.7 sign q'): physical signs; friction 0.7 is taken from the accelerations.
ACROBOT = """[model]
name = "acrobot"
[states]
q1 = { initial = 0, lower = -6.283185307179586, upper = 6.283185307179586 }
q2 = { initial = 0, lower = -6.283185307179586, upper = 6.283185307179586 }
v1 = 0
v2 = 0
[controls]
u1 = { lower = -10, upper = 10 }
u2 = { lower = -10, upper = 10 }
[definitions]
M11 = "1/3 + 1.2*(1 + 0.48 + 1.2*cos(q2))"
M12 = "1.2*(0.48 + 0.6*cos(q2))"
M22 = "1.2*0.48"
r1 = "u1 + 0.72*sin(q2)*(2*v1*v2 + v2^2) - 9.81*(1.7*sin(q1) + 0.72*sin(q1 + q2)) - 0.3*v1"
r2 = "u2 - 0.72*sin(q2)*v1^2 - 9.81*0.72*sin(q1 + q2) - 0.3*v2"
det = "M11*M22 - M12^2"
[dynamics]
q1 = "v1"
q2 = "v2"
v1 = "(M22*r1 - M12*r2)/det - 0.7*sign(v1)"
v2 = "(M11*r2 - M12*r1)/det - 0.7*sign(v2)"
[optimize]
horizon = 2
control_intervals = 20
elements = 2
stages = 2
running_cost = "10*(q1 - pi)^2 + 10*q2^2 + 0.1*v1^2 + 0.1*v2^2 + 0.1*u1^2 + 0.1*u2^2"
terminal_cost = "100*((q1 - pi)^2 + q2^2 + v1^2 + v2^2)"
"""


def acrobot():
    x, u, alpha = ca.SX.sym("x", 4), ca.SX.sym("u", 2), ca.SX.sym("alpha", 2)
    q1, q2, v1, v2 = ca.vertsplit(x)
    m11, m12, m22 = 1 / 3 + 1.2 * (1.48 + 1.2 * ca.cos(q2)), 1.2 * (0.48 + 0.6 * ca.cos(q2)), 1.2 * 0.48
    r1 = u[0] + 0.72 * ca.sin(q2) * (2 * v1 * v2 + v2**2) - 9.81 * (1.7 * ca.sin(q1) + 0.72 * ca.sin(q1 + q2)) - 0.3 * v1
    r2 = u[1] - 0.72 * ca.sin(q2) * v1**2 - 9.81 * 0.72 * ca.sin(q1 + q2) - 0.3 * v2
    det = m11 * m22 - m12**2
    f = ca.vertcat(v1, v2, (m22 * r1 - m12 * r2) / det - 0.7 * (2 * alpha[0] - 1), (m11 * r2 - m12 * r1) / det - 0.7 * (2 * alpha[1] - 1))
    error, bound = ca.vertcat(q1 - ca.pi, q2, v1, v2), 2 * ca.pi
    return ocp_problems.Problem(x, u, alpha, f, x[2:], [0, 0, 0, 0], 20, 2, 2.0, elements=2, u_bounds=([-10] * 2, [10] * 2),
                                x_bounds=([-bound] * 2 + [-ca.inf] * 2, [bound] * 2 + [ca.inf] * 2),
                                f_q=error.T @ ca.diag([10, 10, 0.1, 0.1]) @ error + 0.1 * ca.sumsqr(u), f_T=100 * ca.sumsqr(error))


PROBLEMS = {"cart-pole": Loop(("p", "th", "vp", "w"), ("u",), (1, 0, 0, 0), 0.1, 30, CART_POLE, cart_pole),
            "acrobot": Loop(("q1", "q2", "v1", "v2"), ("u1", "u2"), (0, 0, 0, 0), 0.1, 10, ACROBOT, acrobot)}
