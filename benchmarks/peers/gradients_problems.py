"""The seven problems of gradients.py: model text for Saltus, closed forms; the runners of the peers write the equations again."""

import math

HEAD = '[model]\nname = "gradient"\n'
# crossing:  x' = 2 - sign(x): with x0 < 0 it arrives at t = -x0/3, then x' = 1: x(2) = 2 + x0/3.
# arrival:   x' = -sign(x), y' = abs(x): x stays at 0 from t = x0 on, y = x0^2/2.
# exit:      x' = p t - sign(x) from 0: it leaves at t = 1/p, x(2) = 2 p - 2 + 1/(2 p).
# brake:     v' = -sign(v)/2, q' = v: q(6) = v0^2.
# relay:     x' = -sign(y) ... two crossings: y' = x, x' = -sign(y) from y = 0, x = x0: half periods 2 x0; x(T) of the third arc.
# bounce:    z'' = -g, e = 1/2 from z = 1: z(1) by the height.
# fire:      x' = I - x, reset to 0 at 1: x(2) after one spike.
G = 9.81
V1 = math.sqrt(2 * G)


def bounce(h):
    fall = math.sqrt(2 * h / G)
    rest = 0.7 - fall
    return 0.5 * math.sqrt(2 * G * h) * rest - 0.5 * G * rest * rest


def fire(drive):
    spike = math.log(drive / (drive - 1))
    return drive * (1 - math.exp(-(1.0 - spike)))


def slope(function, x, step=1e-6):
    return (function(x + step) - function(x - step)) / (2 * step)


PROBLEMS = {
    "crossing": {"by": "x(2) by x(0) = -1", "exact": 1 / 3, "until": 2, "state": "x", "set": "x",
                 "text": HEAD + '[states]\nx = -1\n[dynamics]\nx = "2 - sign(x)"\n'},
    "arrival": {"by": "y(2) by x(0) = 1", "exact": 1.0, "until": 2, "state": "y", "set": "x",
                "text": HEAD + '[states]\nx = 1\ny = 0\n[dynamics]\nx = "-sign(x)"\ny = "abs(x)"\n'},
    "exit": {"by": "x(2) by p = 1", "exact": 1.5, "until": 2, "state": "x", "set": "p",
             "text": HEAD + '[parameters]\np = 1\n[states]\nx = 0\n[dynamics]\nx = "p*t - sign(x)"\n'},
    "brake": {"by": "q(6) by v(0) = 2", "exact": 4.0, "until": 6, "state": "q", "set": "v",
              "text": HEAD + '[states]\nq = 0\nv = 2\n[dynamics]\nq = "v"\nv = "-0.5*sign(v)"\n'},
    "relay": {"by": "x(3) by x(0) = 1", "exact": -3.0, "until": 3, "state": "x", "set": "x",
              "text": HEAD + '[states]\nx = 1\ny = 0\n[dynamics]\nx = "-sign(y)"\ny = "x"\n'},
    "bounce": {"by": "z(0.7) by z(0) = 1", "exact": slope(bounce, 1.0), "until": 0.7, "state": "z", "set": "z",
               "text": HEAD + '[states]\nz = 1\nv = 0\n[dynamics]\nz = "v"\nv = -9.81\n[[jumps]]\nwhen = "z"\ndirection = "down"\nset = { v = "-v/2" }\n'},
    "fire": {"by": "x(1) by I = 2", "exact": slope(fire, 2.0), "until": 1.0, "state": "x", "set": "I",
             "text": HEAD + '[parameters]\nI = 2\n[states]\nx = 0\n[dynamics]\nx = "I - x"\n[[jumps]]\nwhen = "x - 1"\ndirection = "up"\nset = { x = 0 }\n'},
}
