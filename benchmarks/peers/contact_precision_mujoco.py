"""Runner of contact_precision.py: MuJoCo. A plane motion: slides along x and z, a hinge about y."""

import json
import math
import time

import mujoco

HEAD = """<mujoco><option timestep="{step}" cone="elliptic" impratio="10" gravity="0 0 -9.81"/>
<worldbody><geom type="plane" size="9 9 .1" friction="{mu} 0 0" solref="{stiff} 1"/>
<body pos="{x} 0 {z}" euler="0 {angle} 0"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 1 0"/>
<inertial pos="0 0 0" mass="1" diaginertia="1 {inertia} 1"/>"""
ENDS = '<geom type="sphere" size="1e-4" pos="{0} 0 {2}" friction="{mu} 0 0" solref="{stiff} 1"/><geom type="sphere" size="1e-4" pos="{1} 0 {2}" friction="{mu} 0 0" solref="{stiff} 1"/>'


def measure(problem, step, until, mu, x, z, angle, inertia, ends, read):
    stiff = max(2 * step, 1e-4)
    text = HEAD.format(step=step, mu=mu, stiff=stiff, x=0, z=z, angle=0, inertia=inertia) + ENDS.format(*ends, mu=mu, stiff=stiff)
    model = mujoco.MjModel.from_xml_string(text + "</body></worldbody></mujoco>")
    data = mujoco.MjData(model)
    data.qpos[:] = x, 0, -angle  # the hinge about y turns the other way
    begin = time.process_time()
    for _ in range(round(until / step)):
        mujoco.mj_step(model, data)
    print(json.dumps({"problem": problem, "setting": f"step {step:g}", "status": "completed", "values": read(data.qpos), "seconds": time.process_time() - begin}))


for dt in (2e-3, 5e-4, 1e-4):
    measure("rod", dt, 1.0, 0.3, 0, 1.0, 0.6, 1 / 12, (-0.5, 0.5, 0), lambda q: [float(q[0]), float(q[1]) + 1.0, -float(q[2])])
    measure("block", dt, 2.0, 5, -0.1 + 0.1 * math.cos(0.1) + 0.5 * math.sin(0.1), 0.1 * math.sin(0.1) + 0.5 * math.cos(0.1), -0.1, 0.26 / 3, (-0.1, 0.1, -0.5),
            lambda q: [-float(q[2])])
