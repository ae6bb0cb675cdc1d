"""Runner of contact_precision.py: Saltus."""

import json
import time

import saltus

BLOCK = """[model]
name = "rocking-block"
[parameters]
b = 0.1
h = 0.5
g = 9.81
[states]
x = "-0.1 + 0.1*cos(0.1) + 0.5*sin(0.1)"
z = "0.1*sin(0.1) + 0.5*cos(0.1)"
phi = -0.1
vx = 0
vz = 0
w = 0
[mechanics]
positions = ["x", "z", "phi"]
velocities = ["vx", "vz", "w"]
mass = [[1, 0, 0], [0, 1, 0], [0, 0, "(b^2 + h^2)/3"]]
force = { vz = "-g" }
[[contacts]]
name = "left"
gap = "z - b*sin(phi) - h*cos(phi)"
tangent = { x = 1, phi = "h*cos(phi) + b*sin(phi)" }
friction = 5
[[contacts]]
name = "right"
gap = "z + b*sin(phi) - h*cos(phi)"
tangent = { x = 1, phi = "h*cos(phi) - b*sin(phi)" }
friction = 5
"""
CHAIN = """[model]
name = "bouncing-chain"
[states]
a = 0.5
b = 0.7
c = 0.9
va = 0
vb = 0
vc = 0
[mechanics]
positions = ["a", "b", "c"]
velocities = ["va", "vb", "vc"]
potential = "9.81*(a + b + c) + 200*(b - a - 0.2)^2 + 200*(c - b - 0.2)^2"
[[contacts]]
name = "ground"
gap = "a"
restitution = 0.5
"""
PROBLEMS = {"rod": (saltus.catalogue("falling-rod"), 1.0, ("x", "z", "phi")), "block": (saltus.Model.from_text(BLOCK), 2.0, ("phi",)),
            "chain": (saltus.Model.from_text(CHAIN), 1.5, ("a", "b", "c"))}

for name, (model, until, of) in PROBLEMS.items():
    model.simulate(until=until, output="steps")
    for setting, options in [("reference", {"rtol": 1e-13, "atol": 1e-15, "integrator": "dop853"})] + [
            (f"rtol {rtol:g}", {"rtol": rtol, "atol": rtol / 100}) for rtol in (1e-4, 1e-6, 1e-8, 1e-10)]:
        begin = time.process_time()
        result = model.simulate(until=until, output="steps", **options)
        seconds = time.process_time() - begin
        print(json.dumps({"problem": name, "setting": setting, "status": str(result.status), "values": [float(result.final[s]) for s in of], "seconds": seconds}))
