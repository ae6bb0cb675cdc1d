"""Competitor (d): time stepping of Siconos, Euler-Moreau with theta = 1/2 ("midpoint") or 1 ("euler"); the tolerance is
the length of the step. No event times: a switch is a change of lambda between -1, the inside and 1 from step to step.
Runs with Debian's python3; the nonlinear relations are compiled C functions, the loop over the steps is that of
Siconos."""

import os
import sys
import time

import gene_ring
import numpy
import python_protocol
import siconos.kernel as siconos

PLUGIN = os.environ.get("COMPARE_SICONOS_PLUGIN", "")


def nonlinear_relation(prefix):
    relation = siconos.FirstOrderNonLinearR()
    for setter, name in ((relation.setComputehFunction, "h"), (relation.setComputegFunction, "g"),
                         (relation.setComputeJachxFunction, "dh_dx"),
                         (relation.setComputeJachlambdaFunction, "dh_dlambda"),
                         (relation.setComputeJacglambdaFunction, "dg_dlambda"),
                         (relation.setComputeJacgxFunction, "dg_dx")):
        setter(PLUGIN, f"{prefix}_{name}")
    return relation


def stick_slip():
    system = siconos.FirstOrderLinearDS(numpy.array([0.04, -0.01]), numpy.array([[0.0, 1.0], [-1.0, 0.0]]))
    return system, nonlinear_relation("stick_slip"), 1, 1000.0


def irma():
    system = siconos.FirstOrderLinearDS(numpy.array([0.011, 0.09, 0.04, 0.05, 0.015]),
                                        -numpy.diag([0.05, 0.04, 0.05, 0.02, 0.6]))
    return system, nonlinear_relation("irma"), 7, 1000.0


def relay_feedback():
    w, xi = 25.0, 0.05
    matrix = numpy.array([[-(2 * xi * w + 1), 1, 0], [-(2 * xi * w + w * w), 0, 1], [-w * w, 0, 0]])
    system = siconos.FirstOrderLinearDS(numpy.array([0.0, -0.001, -0.02]), matrix)
    relation = siconos.FirstOrderLinearTIR(numpy.array([[1.0, 0.0, 0.0]]), numpy.array([[1.0], [-2.0], [1.0]]))
    return system, relation, 1, 10.0


def ring(inactive):
    network = gene_ring.Network(inactive)
    n = gene_ring.PROTEINS
    system = siconos.FirstOrderLinearDS(numpy.array(network.start) / 1000,
                                        -numpy.diag([float(decay) for decay in network.decay]))
    thresholds = [(i, j) for i in range(n) for j in range(len(network.thresholds[i]))]
    to_y, to_r = numpy.zeros((len(thresholds), n)), numpy.zeros((n, len(thresholds)))
    shift, constant = numpy.zeros(len(thresholds)), numpy.array([float(c) for c in network.constant])
    for k, (i, j) in enumerate(thresholds):
        to_y[k, i] = 1.0
        shift[k] = -float(network.thresholds[i][j])
        following, weight = (i + 1) % n, float(network.weight(j))
        to_r[following, k] = weight / 2 * (1 if following == 0 else -1)  # step = (1 - lambda) / 2
        constant[following] += weight / 2
    system.setbPtr(constant)
    relation = siconos.FirstOrderLinearTIR(to_y, to_r)
    relation.setePtr(shift)
    return system, relation, len(thresholds), float(gene_ring.UNTIL)


PROBLEMS = {"stick-slip": stick_slip, "irma": irma, "relay-feedback": relay_feedback,
            "gene-ring": lambda: ring(gene_ring.INACTIVE), "gene-ring-active": lambda: ring(0)}
THETA = {"midpoint": 0.5, "euler": 1.0}


def simulation_of(problem, theta, h):
    system, relation, relays, until = PROBLEMS[problem]()
    interaction = siconos.Interaction(siconos.RelayNSL(relays), relation)
    model = siconos.NonSmoothDynamicalSystem(0.0, until)
    model.insertDynamicalSystem(system)
    model.link(interaction, system)
    simulation = siconos.TimeStepping(model, siconos.TimeDiscretisation(0.0, h), siconos.EulerMoreauOSI(theta),
                                      siconos.Relay())
    simulation.setNewtonTolerance(1e-11)
    simulation.setNewtonMaxIteration(30)
    return simulation, system, interaction, model


def switches(problem, theta, h):
    """Steps, and times at which a relay changes between off, on and in between."""
    simulation, system, interaction, _model = simulation_of(problem, theta, h)
    modes, steps, events = None, 0, []
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        simulation.nextStep()
        steps += 1
        multipliers = numpy.asarray(interaction.lambda_(0))
        now = numpy.where(numpy.abs(multipliers) > 1.0 - 1e-9, numpy.sign(multipliers), 0.0)
        if modes is not None and (now != modes).any():
            events.append(steps * h)
        modes = now
    until = PROBLEMS[problem]()[3]
    if abs(steps * h - until) > 1e-6 * h:  # another time would be another solution
        sys.exit(f"{steps} steps of {h} do not end at {until}")
    return {"status": "completed", "x": [float(value) for value in system.x()], "events": events, "steps": steps,
            "evaluations": steps}


def timed(problem, theta, h):
    simulation, system, interaction, model = simulation_of(problem, theta, h)
    begin = time.process_time()
    simulation.run()
    return time.process_time() - begin


def main():
    case, budget, steps = python_protocol.request()
    if case["problem"] not in PROBLEMS or case["method"] not in THETA:
        sys.exit(f"no such case: {case}")
    theta = THETA[case["method"]]
    for h in steps:
        times = [timed(case["problem"], theta, h)]
        while sum(times) < budget and len(times) < 21:
            times.append(timed(case["problem"], theta, h))
        run = switches(case["problem"], theta, h)
        python_protocol.report(case, h, (sorted(times)[len(times) // 2], len(times)), run)


if __name__ == "__main__":
    main()
