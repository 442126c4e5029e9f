"""Rotation behind a Hooke's joint in Exudyn: two rigid bodies in space whose cross arms stay square to each other."""

from __future__ import annotations

import json
import sys
import time

import exudyn as exu
import numpy as np
from exudyn.utilities import (
    AddRigidBody,
    GenericJoint,
    InertiaCuboid,
    MarkerBodyRigid,
    ObjectGround,
    RotationMatrixY,
    SensorBody,
)  # fmt: skip

case = json.loads(sys.argv[1])
BETA, SPEED, STEPS = case["angle"], 1.0, case["steps"]


def turn() -> list[float]:
    """Output speed over input speed, at even times over one turn of the input."""
    container = exu.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(ObjectGround())
    # Both bodies turn about their own z axes. The input fork is body 1's x axis, the output fork body 2's y axis.
    frames = [np.eye(3), RotationMatrixY(BETA)]
    markers, sensors = [], []
    for frame, heavy in zip(frames, (1e9, 1e-3), strict=True):
        inertia = InertiaCuboid(density=12.0 * heavy / 2.0, sideLengths=[1.0, 1.0, 1.0])
        ratio = 1.0 if heavy > 1 else 1.0 / np.cos(BETA)
        node, body = AddRigidBody(
            system, inertia, nodeType=str(exu.NodeType.RotationEulerParameters), position=[0, 0, 0],
            rotationMatrix=frame, angularVelocity=list(SPEED * ratio * frame[:, 2]), gravity=[0, 0, 0],
        )  # fmt: skip
        here = system.AddMarker(MarkerBodyRigid(bodyNumber=body, localPosition=[0, 0, 0]))
        there = system.AddMarker(MarkerBodyRigid(bodyNumber=ground, localPosition=[0, 0, 0]))
        # z axis of the body along the axis of its shaft: two rotations held, one free
        system.AddObject(
            GenericJoint(
                markerNumbers=[there, here], constrainedAxes=[1, 1, 1, 1, 1, 0],
                rotationMarker0=frame, rotationMarker1=np.eye(3),
            )
        )  # fmt: skip
        markers.append(here)
        sensors.append(
            system.AddSensor(
                SensorBody(
                    bodyNumber=body, storeInternal=True, writeToFile=False,
                    outputVariableType=exu.OutputVariableType.AngularVelocityLocal,
                )
            )
        )  # fmt: skip
    system.AddObject(GenericJoint(markerNumbers=markers, constrainedAxes=[0, 0, 0, 0, 0, 1]))
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = STEPS
    settings.timeIntegration.endTime = 2 * np.pi / SPEED
    settings.solutionSettings.writeSolutionToFile = False
    settings.solutionSettings.sensorsWritePeriod = 2 * np.pi / SPEED / STEPS
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.newton.relativeTolerance = 1e-10
    settings.timeIntegration.generalizedAlpha.spectralRadius = 1.0
    settings.timeIntegration.generalizedAlpha.computeInitialAccelerations = True
    system.SolveDynamic(settings)
    speeds = [np.asarray(system.GetSensorStoredData(one))[:, 3] for one in sensors]
    return [float(one) for one in speeds[1] / speeds[0]]


turn()
begin = time.perf_counter()
found = turn()
print("\n" + json.dumps({"values": found, "seconds": time.perf_counter() - begin, "version": exu.__version__}))
