"""Runner of contact_precision.py: SciPy, with the modes of the chain (in flight, at rest on the ground) written out."""

import json
import time

import numpy
from scipy.integrate import solve_ivp

K, REST, G, E, END = 400.0, 0.2, 9.81, 0.5, 1.5


def spring(y):
    low, high = K * (y[1] - y[0] - REST), K * (y[2] - y[1] - REST)
    return numpy.array([low - G, high - low - G, -high - G])


def fly(t, y):
    return numpy.concatenate([y[3:], spring(y)])


def stand(t, y):
    rate = fly(t, y)
    rate[[0, 3]] = 0
    return rate


def hits(t, y):
    return y[0]


def lifts(t, y):
    return spring(y)[0]


hits.terminal, hits.direction = True, -1
lifts.terminal, lifts.direction = True, 1


def simulate(rtol, is_careful):
    """Careful: a short first step, so that a restart on the ground is not taken for a hit, and short steps, so that no bounce is stepped over."""
    t, y, field, event = 0.0, numpy.array([0.5, 0.7, 0.9, 0, 0, 0]), fly, hits
    while t < END:
        done = solve_ivp(field, (t, END), y, method="DOP853", rtol=rtol, atol=rtol / 100, events=event,
                         **({"first_step": min(1e-12, END - t), "max_step": 1e-3} if is_careful else {}))
        t, y = done.t[-1], done.y[:, -1].copy()
        if done.status != 1:
            break
        y[0] = 0
        if event is hits:
            y[3] *= -E
            if y[3] < 1e-9 and spring(y)[0] <= 0:
                y[3], field, event = 0.0, stand, lifts
        else:
            field, event = fly, hits
    return y[:3]


for is_careful in (False, True):
    for rtol in (1e-6, 1e-8, 1e-10):
        begin = time.process_time()
        values = simulate(rtol, is_careful)
        setting = f"DOP853, rtol {rtol:g}, modes by the user{', steps up to 1e-3' if is_careful else ''}"
        print(json.dumps({"problem": "chain", "setting": setting, "status": "completed", "values": list(map(float, values)), "seconds": time.process_time() - begin}))
