"""Runner of soft_walls.py: Saltus."""

import numpy
import saltus
from soft_walls_plant import A_RATE, B_RATE, D_RATE, DT, K, N, TIP, WALL, Q, R, loop, riccati

NAMES = ("x", "th", "v", "w")


def quadratic(matrix):
    return " + ".join(f"{float(matrix[i, j])!r}*{a}*{b}" for i, a in enumerate(NAMES) for j, b in enumerate(NAMES) if matrix[i, j])


def rate(i):
    return f"{float(A_RATE[i, 1])!r}*th + {float(B_RATE[i])!r}*u + {float(D_RATE[i])!r}*wall"


MODEL = f"""[model]
name = "soft-walls"
[states]
{chr(10).join(f"{name} = 0" for name in NAMES)}
[controls]
u = {{ lower = -200, upper = 200 }}
[definitions]
tip = "x + {TIP}*th"
wall = "{K}*max(0, -{WALL} - tip) - {K}*max(0, tip - {WALL})"
[dynamics]
x = "v"
th = "w"
v = "{rate(0)}"
w = "{rate(1)}"
[optimize]
horizon = {N * DT}
control_intervals = {N}
elements = 2
stages = 2
running_cost = "({quadratic(Q)} + {R[0, 0]}*u^2)/{DT}"
terminal_cost = "{quadratic(riccati())}"
"""


class Controller:
    def __init__(self):
        self.model, self.last = saltus.Model.from_text(MODEL), None

    def __call__(self, z):
        options = {"mpcc": {"first": "branch"}} if self.last is not None else {}
        self.last = self.model.optimize(set=dict(zip(NAMES, map(float, z), strict=True)), start=self.last, **options)
        return numpy.asarray(self.last["u"])[0]


loop("FESD, two elements and stages per interval", Controller())
