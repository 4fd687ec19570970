"""The four-bar in Exudyn with ideal joints: reaction forces of one settled cycle, from the Lagrange multipliers of the joints."""

from math import cos, sin

import exudyn as exu
from exudyn.itemInterface import (
    CoordinateConstraint,
    Torque,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    NodePointGround,
    NodeRigidBody2D,
    ObjectGround,
    ObjectJointRevolute2D,
    ObjectRigidBody2D,
)
from four_bar import COUPLER, COUPLER_MASS, CRANK, GROUND, ROCKER, ROCKER_MASS, SPEED, reply, start_angles, start_rates

from hingewise.cycle import serve

STEPS = 1000  # in a cycle
SETTLING = 1  # cycles


def body(mbs, mass, length, centre, angle, velocity, rate):
    node = NodeRigidBody2D(referenceCoordinates=[*centre, angle], initialVelocities=[*velocity, rate])
    number = mbs.AddNode(node)
    inertia = mass * length**2 / 12
    return mbs.AddObject(ObjectRigidBody2D(physicsMass=mass, physicsInertia=inertia, nodeNumber=number)), number


def cycle(request):
    period, torque = request["period"], request["sample"]["load_torque"]
    system = exu.SystemContainer()
    mbs = system.AddSystem()
    coupler, rocker = start_angles()
    rates = start_rates()
    ground = mbs.AddObject(ObjectGround())
    crank_body, crank_node = body(mbs, 1.0, CRANK, (0, 0), 0, (0, 0), SPEED)
    half = COUPLER / 2
    centre = CRANK + half * cos(coupler), half * sin(coupler)
    velocity = -half * rates[0] * sin(coupler), CRANK * SPEED + half * rates[0] * cos(coupler)
    coupler_body, coupler_node = body(mbs, COUPLER_MASS, COUPLER, centre, coupler, velocity, rates[0])
    half = ROCKER / 2
    centre = GROUND + half * cos(rocker), half * sin(rocker)
    velocity = -half * rates[1] * sin(rocker), half * rates[1] * cos(rocker)
    rocker_body, rocker_node = body(mbs, ROCKER_MASS, ROCKER, centre, rocker, velocity, rates[1])

    def joint(first, at_first, second, at_second):
        places = [(first, at_first), (second, at_second)]
        markers = [mbs.AddMarker(MarkerBodyRigid(bodyNumber=of, localPosition=[*at, 0])) for of, at in places]
        return mbs.AddObject(ObjectJointRevolute2D(markerNumbers=markers))

    joints = [
        joint(crank_body, (CRANK, 0), coupler_body, (-COUPLER / 2, 0)),
        joint(coupler_body, (COUPLER / 2, 0), rocker_body, (ROCKER / 2, 0)),
        joint(ground, (GROUND, 0), rocker_body, (-ROCKER / 2, 0)),
        joint(ground, (0, 0), crank_body, (0, 0)),
    ]
    mbs.AddLoad(Torque(markerNumber=mbs.AddMarker(MarkerBodyRigid(bodyNumber=rocker_body)), loadVector=[0, 0, torque]))
    fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()), coordinate=0))
    turning = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=crank_node, coordinate=2))
    mbs.AddObject(CoordinateConstraint(markerNumbers=[fixed, turning], velocityLevel=True, offset=SPEED))
    mbs.Assemble()

    time, angles, forces = [], [], []
    nodes = crank_node, coupler_node, rocker_node

    def collect(mbs, t):
        if t < (SETTLING - 0.5 / STEPS) * period:
            return True
        turned = [mbs.GetNodeOutput(node, exu.OutputVariableType.Coordinates)[2] for node in nodes]
        rates = [mbs.GetNodeOutput(node, exu.OutputVariableType.Coordinates_t)[2] for node in nodes]
        multipliers = mbs.systemData.GetAECoordinates()
        time.append(t - SETTLING * period)
        angles.append((turned[0], coupler + turned[1], rocker + turned[2], abs(rates[2] - rates[1])))
        found = []
        for number in joints[:3]:
            rows = mbs.systemData.GetObjectLTGAE(number)
            found.append(tuple(-multipliers[row] for row in rows[:2]))
        forces.append(found)
        return True

    mbs.SetPostStepUserFunction(collect)
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = (SETTLING + 1) * STEPS
    settings.timeIntegration.endTime = (SETTLING + 1) * period
    settings.timeIntegration.verboseMode = 0
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.solutionSettings.writeSolutionToFile = False
    if not mbs.SolveDynamic(settings):
        raise RuntimeError("the integration failed")
    return reply(time, angles, forces)


if __name__ == "__main__":
    serve(cycle)
