"""Runner of creep.py: MuJoCo."""

import json
import time

import mujoco

HEAD = '<mujoco><option timestep="{step}" cone="elliptic" impratio="{ratio}" gravity="{g}" {more}/><worldbody>'
SLOPE = HEAD + """<geom type="plane" size="5 5 .1" friction="1 0 0"/>
<body pos="0 0 .05"><freejoint/><geom type="box" size=".1 .1 .05" mass="1" friction="1 0 0"/></body></worldbody></mujoco>"""
PINCH = HEAD + """<body pos="-.15 0 0"><joint type="slide" axis="1 0 0"/><geom type="box" size=".05 .3 .3" mass="1" friction="1 0 0"/></body>
<body pos=".15 0 0"><joint type="slide" axis="1 0 0"/><geom type="box" size=".05 .3 .3" mass="1" friction="1 0 0"/></body>
<body pos="0 0 0"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>
<geom type="capsule" fromto="0 -.1 0 0 .1 0" size=".1" mass="1" friction="1 0 0"/></body></worldbody></mujoco>"""
GRAVITY = {"slope": "-1.9489461 0 -9.6144530", "pinch": "0 0 -9.81"}  # along and across a slope of 0.2 rad


def measure(problem, text, step, ratio, more):
    model = mujoco.MjModel.from_xml_string(text.format(step=step, ratio=ratio, g=GRAVITY[problem], more=more))
    data = mujoco.MjData(model)
    place, column = 0, {}
    if problem == "pinch":
        data.qfrc_applied[:2] = 50, -50
        place = 3
    begin = time.process_time()
    for second in range(1, 6):
        while data.time < second - step / 2:
            mujoco.mj_step(model, data)
        column[second] = float(data.qpos[place])
    seconds = time.process_time() - begin
    print(json.dumps({"problem": problem, "setting": f"step {step}, impratio {ratio}{', ' + more if more else ''}", "status": "completed",
                      "creep": abs(column[5] - column[1]) / 4, "seconds": seconds / 5}))


for name, xml in (("slope", SLOPE), ("pinch", PINCH)):
    for setting in ((0.002, 1, ""), (0.002, 10, ""), (0.002, 100, ""), (0.0005, 10, ""), (0.002, 10, 'noslip_iterations="10"')):
        measure(name, xml, *setting)
