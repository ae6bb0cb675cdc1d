"""Runner of creep.py: Saltus."""

import json
import time

import saltus

SLOPE = """[model]
name = "slope"
[states]
s = 0
n = 0.05
phi = 0
vs = 0
vn = 0
w = 0
[mechanics]
positions = ["s", "n", "phi"]
velocities = ["vs", "vn", "w"]
mass = [[1, 0, 0], [0, 1, 0], [0, 0, "(0.2^2 + 0.1^2)/12"]]
force = { vs = "-9.81*sin(0.2)", vn = "-9.81*cos(0.2)" }
[[contacts]]
name = "lower"
gap = "n - 0.1*sin(phi) - 0.05*cos(phi)"
tangent = { s = 1, phi = "0.05*cos(phi) + 0.1*sin(phi)" }
friction = 1
[[contacts]]
name = "upper"
gap = "n + 0.1*sin(phi) - 0.05*cos(phi)"
tangent = { s = 1, phi = "0.05*cos(phi) - 0.1*sin(phi)" }
friction = 1
[simulate]
until = 5
output = { times = [1, 5] }
"""
PINCH = """[model]
name = "pinch"
[states]
left = -0.1
x = 0
z = 0
right = 0.1
vleft = 0
vx = 0
vz = 0
vright = 0
[mechanics]
positions = ["left", "x", "z", "right"]
velocities = ["vleft", "vx", "vz", "vright"]
force = { vleft = 50, vz = -9.81, vright = -50 }
[[contacts]]
name = "l"
gap = "x - left - 0.1"
tangent = { z = 1 }
friction = 1
[[contacts]]
name = "r"
gap = "right - x - 0.1"
tangent = { z = 1 }
friction = 1
[simulate]
until = 5
output = { times = [1, 5] }
"""

for problem, text, name in (("slope", SLOPE, "s"), ("pinch", PINCH, "z")):
    model = saltus.Model.from_text(text)
    model.simulate()
    begin = time.process_time()
    result = model.simulate()
    seconds = time.process_time() - begin
    t, column = list(result.t), list(result[name])
    creep = abs(column[t.index(5.0)] - column[t.index(1.0)]) / 4
    print(json.dumps({"problem": problem, "setting": "default", "status": str(result.status), "creep": float(creep), "seconds": seconds / 5}))
