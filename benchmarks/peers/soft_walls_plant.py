"""Equations, plant and closed loop of soft_walls.py: z = (cart, angle, rates), tip = cart + 0.6 angle, walls at +-0.35."""

import json
import time

import numpy

DT, N, STEPS, K, WALL, TIP = 0.01, 10, 60, 100.0, 0.35, 0.6
MP, MC, LC, G = 0.411, 0.978, 0.4267, 9.81
Q, R = numpy.diag([10.0, 2.0, 1.0, 1.0]), numpy.array([[1.0]])
START = numpy.array([0.1, 0.05, 1.2, 0.4])
MASS = numpy.linalg.inv([[MC + MP, MP * LC], [MP * LC, MP * LC**2]])
A_RATE = MASS @ numpy.array([[0, 0], [0, MP * G * LC]])
B_RATE = MASS @ numpy.array([1.0, 0.0])
E_TIP = numpy.array([1.0, TIP])
D_RATE = MASS @ E_TIP  # of a force on the tip
# One step of the controllers: rates first, then positions with the new rates.
A = numpy.eye(4)
A[2:, :2] += DT * A_RATE
A[:2] += DT * A[2:]
B = numpy.concatenate([DT * DT * B_RATE, DT * B_RATE])
D = numpy.concatenate([DT * DT * D_RATE, DT * D_RATE])


def riccati():
    p = Q.copy()
    for _ in range(5000):
        b = B[:, None]
        p = Q + A.T @ p @ A - A.T @ p @ b @ numpy.linalg.solve(R + b.T @ p @ b, b.T @ p @ A)
    return p


def plant(z, u, parts=100):
    for _ in range(parts):
        tip = E_TIP @ z[:2]
        wall = K * (max(0.0, -WALL - tip) - max(0.0, tip - WALL))
        rate = A_RATE @ z[:2] + B_RATE * u + D_RATE * wall
        z = z + DT / parts * numpy.concatenate([z[2:] + 0.5 * DT / parts * rate, rate])
    return z


def loop(method, control, samples=STEPS):
    """Runs `control(z) -> u`, prints the row; a loop of fewer `samples` has no cost."""
    z, cost, seconds, first = START, 0.0, [], None
    for _ in range(samples):
        begin = time.process_time()
        u = float(control(z))
        seconds.append(1e3 * (time.process_time() - begin))
        first = u if first is None else first
        cost += float(z @ Q @ z + R[0, 0] * u * u)
        z = plant(z, u)
    is_complete = len(seconds) == STEPS
    print(json.dumps({"method": method, "status": "completed" if is_complete else "first samples only", "samples": len(seconds), "first": first,
                      "cost": cost if is_complete else None, "median": float(numpy.median(seconds[1:])), "largest": max(seconds[1:])}))
