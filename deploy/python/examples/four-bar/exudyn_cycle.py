"""The four-bar in Exudyn: one settled cycle with ideal joints, whose reaction forces are the Lagrange multipliers, or with the argument
`contact` by the contact law of Hingewise on the bores of the request."""

import sys
from math import sqrt
from pathlib import Path

from four_bar import COUPLER, COUPLER_MASS, CRANK, GROUND, ROCKER, ROCKER_MASS, SPEED, reply, start_angles, start_rates

from hingewise.cycle import serve

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from exudyn_planar import HEAVY, Bore, Contact, Linkage  # noqa: E402  of this folder's parent

STEPS = 1000  # in a cycle
SETTLING = 1  # cycles
TOLERANCE = 1e-6
JOURNAL, BUSHING = 4e-3, 4.03e-3
DAMPING, FILM, FRICTION, FRICTION_SPEED = 2.0, 100.0, 0.05, 5e-3


def linkage(torque, contacts=None):
    """The four-bar at its start, under a torque of the rocker [N m], with ideal joints or these contacts."""
    (coupler, rocker), rates = start_angles(), start_rates()
    crank = (1.0, CRANK**2 / 12) if contacts is None else (HEAVY, HEAVY)
    bodies = [(*crank, (0.0, 0.0), (0.0, 0.0), 0.0)]
    lengths = (COUPLER_MASS, COUPLER, CRANK, coupler), (ROCKER_MASS, ROCKER, GROUND, rocker)
    bodies += [(mass, mass * rod**2 / 12, (rod / 2, 0.0), (x, 0.0), angle) for mass, rod, x, angle in lengths]
    velocities = [((0.0, 0.0), SPEED), ((0.0, CRANK * SPEED), rates[0]), ((0.0, 0.0), rates[1])]
    joints = [
        (0, (CRANK, 0.0), 1, (0.0, 0.0)),
        (1, (COUPLER, 0.0), 2, (ROCKER, 0.0)),
        (None, (GROUND, 0.0), 2, (0.0, 0.0)),
    ]
    return Linkage(bodies, velocities, joints, SPEED, torques=[(2, torque)], contacts=contacts)


def cycle(request):
    rows = linkage(request["sample"]["load_torque"]).simulate(request["period"], SETTLING, STEPS)
    angles = [(crank[2], coupler[2], rocker[2], abs(rocker[5] - coupler[5])) for _, (crank, coupler, rocker), _ in rows]
    return reply([time for time, _, _ in rows], angles, [forces for _, _, (forces, _) in rows])


def stiffness():
    """Hertz's K_n [N/m^1.5] of a steel journal in a bronze bushing."""
    compliance = (1 - 0.3**2) / 206e9 + (1 - 0.34**2) / 105e9
    return 4 / 3 / compliance * sqrt(JOURNAL * BUSHING / (BUSHING - JOURNAL))


def contact_cycle(request):
    names = "crank", "coupler", "rocker"
    law = stiffness(), DAMPING, FILM, FRICTION, FRICTION_SPEED
    contacts = [Contact(JOURNAL, Bore(request["joints"][name]["bushing"]), *law) for name in names]
    four = linkage(request["sample"]["load_torque"], contacts)
    # Steps of any length, of which the last one before the cycle may be among the rows.
    rows = [row for row in four.simulate(request["period"], SETTLING, STEPS, TOLERANCE) if row[0] >= 0]
    joints = {}
    for k, name in enumerate(names):
        columns = {key: [] for key in ("eccentricity_x", "eccentricity_y", "force_x", "force_y", "sliding", "angle")}
        for _, state, _ in rows:
            e, _, (normal, _, (x, y), _, slip) = four.contact(k, state)
            angle = four.joint(k, state, None)[0]
            for column, value in zip(columns.values(), (*e, normal * x, normal * y, slip, angle)):
                column.append(value)
        joints[name] = columns
    speed = max(abs(rocker[5] - coupler[5]) for _, (_, coupler, rocker), _ in rows)
    return {"time": [time for time, _, _ in rows], "joints": joints, "outputs": {"coupler_joint_speed": speed}}


if __name__ == "__main__":
    serve(contact_cycle if sys.argv[1:] == ["contact"] else cycle)
