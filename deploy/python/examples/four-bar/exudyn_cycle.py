"""The four-bar in Exudyn with ideal joints: reaction forces of one settled cycle, from the Lagrange multipliers of the joints."""

import sys
from pathlib import Path

from four_bar import COUPLER, COUPLER_MASS, CRANK, GROUND, ROCKER, ROCKER_MASS, SPEED, reply, start_angles, start_rates

from hingewise.cycle import serve

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from exudyn_planar import Linkage  # noqa: E402  of this folder's parent

STEPS = 1000  # in a cycle
SETTLING = 1  # cycles


def linkage(torque):
    """The four-bar at its start, under a torque of the rocker [N m]."""
    (coupler, rocker), rates = start_angles(), start_rates()
    bodies = [(1.0, CRANK**2 / 12, (0.0, 0.0), (0.0, 0.0), 0.0)]
    lengths = (COUPLER_MASS, COUPLER, CRANK, coupler), (ROCKER_MASS, ROCKER, GROUND, rocker)
    bodies += [(mass, mass * rod**2 / 12, (rod / 2, 0.0), (x, 0.0), angle) for mass, rod, x, angle in lengths]
    velocities = [((0.0, 0.0), SPEED), ((0.0, CRANK * SPEED), rates[0]), ((0.0, 0.0), rates[1])]
    joints = [
        (0, (CRANK, 0.0), 1, (0.0, 0.0)),
        (1, (COUPLER, 0.0), 2, (ROCKER, 0.0)),
        (None, (GROUND, 0.0), 2, (0.0, 0.0)),
    ]
    return Linkage(bodies, velocities, joints, SPEED, torques=[(2, torque)])


def cycle(request):
    rows = linkage(request["sample"]["load_torque"]).simulate(request["period"], SETTLING, STEPS)
    angles = [(crank[2], coupler[2], rocker[2], abs(rocker[5] - coupler[5])) for _, (crank, coupler, rocker), _ in rows]
    return reply([time for time, _, _ in rows], angles, [forces for _, _, (forces, _) in rows])


if __name__ == "__main__":
    serve(cycle)
