"""Runner of creep.py: Drake."""

import json
import time

import numpy
from pydrake.all import (AddMultibodyPlantSceneGraph, Box, Capsule, CoulombFriction, DiagramBuilder, HalfSpace, PrismaticJoint, RigidTransform,
                         RollPitchYaw, Simulator, SpatialInertia, UnitInertia)

FRICTION = CoulombFriction(1.0, 1.0)


def begin(step, gravity):
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, step)
    plant.mutable_gravity_field().set_gravity_vector(gravity)
    return builder, plant


def finish(builder, plant, prepare, read):
    plant.Finalize()
    diagram = builder.Build()
    simulator = Simulator(diagram)
    context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
    prepare(context)
    simulator.Initialize()
    start, column = time.process_time(), {}
    for second in range(1, 6):
        simulator.AdvanceTo(second)
        column[second] = read(context)
    return abs(column[5] - column[1]) / 4, (time.process_time() - start) / 5


def slope(step):
    builder, plant = begin(step, numpy.array([-9.81 * numpy.sin(0.2), 0, -9.81 * numpy.cos(0.2)]))
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(), HalfSpace(), "ground", FRICTION)
    block = plant.AddRigidBody("block", SpatialInertia(1.0, numpy.zeros(3), UnitInertia.SolidBox(0.2, 0.2, 0.1)))
    plant.RegisterCollisionGeometry(block, RigidTransform(), Box(0.2, 0.2, 0.1), "block", FRICTION)
    return finish(builder, plant, lambda context: plant.SetFreeBodyPose(context, block, RigidTransform([0, 0, 0.05])),
                  lambda context: float(plant.EvalBodyPoseInWorld(context, block).translation()[0]))


def pinch(step):
    builder, plant = begin(step, numpy.array([0, 0, -9.81]))
    inertia = SpatialInertia(1.0, numpy.zeros(3), UnitInertia.SolidBox(0.1, 0.6, 0.6))
    plates = []
    for name, side in (("left", -1), ("right", 1)):
        plate = plant.AddRigidBody(name, inertia)
        plant.RegisterCollisionGeometry(plate, RigidTransform(), Box(0.1, 0.6, 0.6), name, FRICTION)
        joint = plant.AddJoint(PrismaticJoint(name, plant.world_frame(), plate.body_frame(), [1, 0, 0]))
        plates.append((joint, plant.AddJointActuator(name, joint), 0.15 * side, -50.0 * side))
    carriage = plant.AddRigidBody("carriage", SpatialInertia(1e-6, numpy.zeros(3), UnitInertia.SolidSphere(0.1)))
    capsule = plant.AddRigidBody("capsule", SpatialInertia(1.0, numpy.zeros(3), UnitInertia.SolidSphere(0.1)))
    turned = RigidTransform(RollPitchYaw(numpy.pi / 2, 0, 0), numpy.zeros(3))
    plant.RegisterCollisionGeometry(capsule, turned, Capsule(0.1, 0.2), "capsule", FRICTION)
    plant.AddJoint(PrismaticJoint("x", plant.world_frame(), carriage.body_frame(), [1, 0, 0]))
    height = plant.AddJoint(PrismaticJoint("z", carriage.body_frame(), capsule.body_frame(), [0, 0, 1]))

    def prepare(context):
        for joint, _, place, _ in plates:
            joint.set_translation(context, place)
        plant.get_actuation_input_port().FixValue(context, numpy.array([force for *_, force in plates]))

    return finish(builder, plant, prepare, lambda context: float(height.get_translation(context)))


for problem, run in (("slope", slope), ("pinch", pinch)):
    for dt in (1e-2, 1e-3):
        creep, seconds = run(dt)
        print(json.dumps({"problem": problem, "setting": f"step {dt}, SAP", "status": "completed", "creep": creep, "seconds": seconds}), flush=True)
