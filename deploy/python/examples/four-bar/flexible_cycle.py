"""The four-bar with a flexible coupler in Exudyn: a beam of aluminium, of which the sample has the thickness, with ideal joints."""

import sys
from math import atan2, cos, hypot, sin
from pathlib import Path

from four_bar import COUPLER, COUPLER_MASS, CRANK, GROUND, ROCKER, ROCKER_MASS, SPEED, start_angles, start_rates

from hingewise.cycle import in_frame, serve

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import exudyn as exu  # noqa: E402
from exudyn.beams import GenerateBeamElementsAlongLine  # noqa: E402
from exudyn.itemInterface import Cable2D, MarkerNodePosition, ObjectJointRevolute2D  # noqa: E402
from exudyn_planar import Linkage  # noqa: E402  of this folder's parent

STEPS = 1000  # in a cycle
SETTLING = 1  # cycles
ELEMENTS = 8
MODULUS, DENSITY = 70e9, 2700.0
# Time in which bending strain is damped [s].
DAMPING = 1e-5


class Flexible(Linkage):
    """Crank and rocker with a beam between them."""

    def __init__(self, torque, thickness):
        (coupler, rocker), (rate, rocking) = start_angles(), start_rates()
        bodies = [
            (1.0, CRANK**2 / 12, (0.0, 0.0), (0.0, 0.0), 0.0),
            (ROCKER_MASS, ROCKER_MASS * ROCKER**2 / 12, (ROCKER / 2, 0.0), (GROUND, 0.0), rocker),
        ]
        rates = [((0.0, 0.0), SPEED), ((0.0, 0.0), rocking)]
        super().__init__(bodies, rates, [(None, (GROUND, 0.0), 1, (0.0, 0.0))], SPEED, torques=[(1, torque)])
        area = COUPLER_MASS / COUPLER / DENSITY
        bending = MODULUS * area * thickness**2 / 12
        beam = Cable2D(
            massPerLength=COUPLER_MASS / COUPLER,
            bendingStiffness=bending,
            axialStiffness=MODULUS * area,
            bendingDamping=DAMPING * bending,
            axialDamping=DAMPING * MODULUS * area,
        )
        along = cos(coupler), sin(coupler)
        ends = [CRANK, 0, 0], [CRANK + COUPLER * along[0], COUPLER * along[1], 0]
        self.beam = GenerateBeamElementsAlongLine(self.mbs, *ends, ELEMENTS, beam)["nodes"]
        self.straight = along
        for k, node in enumerate(self.beam):
            r = rate * COUPLER * k / ELEMENTS
            motion = [-r * along[1], CRANK * SPEED + r * along[0], -rate * along[1], rate * along[0]]
            self.mbs.SetNodeParameter(node, "initialVelocities", motion)
        for node, body, place in (self.beam[0], 0, (CRANK, 0.0)), (self.beam[-1], 1, (ROCKER, 0.0)):
            markers = [self.mbs.AddMarker(MarkerNodePosition(nodeNumber=node)), self.marker(body, place)]
            self.joints.append(self.mbs.AddObject(ObjectJointRevolute2D(markerNumbers=markers)))

    def state(self):
        """That of crank and rocker; angles and rates of the ends of the beam, and its deflection [m]."""
        found, ends = super().state(), []
        for node in (self.beam[0], self.beam[-1]):
            _, _, x, y = self.mbs.GetNodeOutput(node, exu.OutputVariableType.Coordinates)
            _, _, vx, vy = self.mbs.GetNodeOutput(node, exu.OutputVariableType.Coordinates_t)
            x, y = x + self.straight[0], y + self.straight[1]
            ends.append((atan2(y, x), (x * vy - y * vx) / hypot(x, y) ** 2))
        places = [self.mbs.GetNodeOutput(node, exu.OutputVariableType.Position) for node in self.beam]
        (x0, y0, _), (x, y, _), (x1, y1, _) = places[0], places[ELEMENTS // 2], places[-1]
        return found, ends, abs((x - x0) * (y1 - y0) - (y - y0) * (x1 - x0)) / hypot(x1 - x0, y1 - y0)


def cycle(request):
    sample = request["sample"]
    flexible = Flexible(sample["load_torque"], sample["rod_thickness"])
    rows = flexible.simulate(request["period"], SETTLING, STEPS)
    crank, rocker = ([state[0][body][2] for _, state, _ in rows] for body in (0, 1))
    near, far = ([state[1][end][0] for _, state, _ in rows] for end in (0, 1))
    # The rocker's joint is the first one; the coupler is the bushing at the crank and the journal at the rocker.
    at_frame, at_crank, at_rocker = ([forces[k] for _, _, (forces, _) in rows] for k in range(3))
    at_rocker = [(-x, -y) for x, y in at_rocker]
    sides = {"crank": (crank, near, at_crank), "coupler": (far, rocker, at_rocker), "rocker": (None, rocker, at_frame)}
    joints = {}
    for name, (journal, bushing, forces) in sides.items():
        turn = [(0.0 if journal is None else journal[k]) - bushing[k] for k in range(len(rows))]
        joints[name] = {"angle": turn, **in_frame(forces, bushing)}
    speed = max(abs(state[0][1][5] - state[1][1][1]) for _, state, _ in rows)
    outputs = {"coupler_joint_speed": speed, "deflection": max(state[2] for _, state, _ in rows)}
    return {"time": [time for time, _, _ in rows], "joints": joints, "outputs": outputs}


if __name__ == "__main__":
    serve(cycle)
