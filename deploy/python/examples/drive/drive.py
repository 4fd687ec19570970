"""The drive of a flapping wing of Hingewise (scene `flapping-wing`) in Exudyn [m, kg, s, N, rad]."""

import sys
from math import acos, atan2, cos, hypot, pi, radians, sin, sqrt
from pathlib import Path

sys.path[:0] = [str(Path(__file__).resolve().parents[k]) for k in (1, 2)]

from exudyn_planar import HEAVY, Bore, Contact, Linkage, turned  # noqa: E402  of this folder's parent

CRANK, SPEED = 8e-3, 480 * 2 * pi / 60
PERIOD = 2 * pi / SPEED
ROD = 40.0549e-3 * cos(radians(3))
ROD_MASS = 0.57e-3
PIVOT = 15.535e-3, 39.951e-3
FRONT, REAR = 16.179e-3, 29e-3
ROCKER_MASS, ROCKER_INERTIA, ROCKER_CENTRE = 1.94e-3, 6.07e-7, 0.3e-3
LOAD, FREE_LENGTH = 95.0, -20e-3
JOURNAL, BUSHING = 1.5e-3, 1.5235e-3
DAMPING, FILM, FRICTION, FRICTION_SPEED = 7.5, 7.24, 0.025, 2.4e-3
TOLERANCE = 1e-6
JOINTS = "1", "2", "3", "4", "5", "6"


def stiffness():
    """Hertz's K_n [N/m^1.5] of a steel journal in a titanium bushing."""
    compliance = (1 - 0.31**2) / 200e9 + (1 - 0.31**2) / 110e9
    return 4 / 3 / compliance * sqrt(JOURNAL * BUSHING / (BUSHING - JOURNAL))


def side(sign):
    """Angles and rates of rod and rocker of a side at the start: the crank lies along x."""
    pivot = sign * PIVOT[0], PIVOT[1]
    base = pivot[0] - CRANK, pivot[1]
    length = hypot(*base)
    at_crank = acos((ROD**2 + length**2 - FRONT**2) / (2 * ROD * length))
    rod = atan2(base[1], base[0]) + sign * at_crank
    pin = CRANK + ROD * cos(rod), ROD * sin(rod)
    arm = pin[0] - pivot[0], pin[1] - pivot[1]
    # The rod's front end is at -FRONT of the right rocker and at FRONT of the left one.
    rocker = atan2(-sign * arm[1], -sign * arm[0])
    # The common pin has one velocity: (0, CRANK SPEED) + rod_rate (-a_y, a_x) = rocker_rate (-arm_y, arm_x).
    a = pin[0] - CRANK, pin[1]
    rod_rate = -CRANK * SPEED * arm[1] / (a[0] * arm[1] - a[1] * arm[0])
    rocker_rate = rod_rate * a[1] / arm[1]
    return rod, rocker, rod_rate, rocker_rate


def linkage(friction=FRICTION, ideal=False, radii=(BUSHING, BUSHING, BUSHING)):
    """The drive at its start, with ideal joints or with clearance in bores of these radii at control points."""
    bodies, rates = [(HEAVY, HEAVY, (0.0, 0.0), (0.0, 0.0), 0.0)], [((0.0, 0.0), SPEED)]
    joints, springs = [None] * 6, []
    if ideal:
        bodies[0] = (1.0, 1.0, *bodies[0][2:])
    for k, sign in enumerate((1, -1)):
        rod, rocker, rod_rate, rocker_rate = side(sign)
        rod_body, rocker_body = len(bodies), len(bodies) + 1
        bodies.append((ROD_MASS, ROD_MASS * ROD**2 / 12, (ROD / 2, 0.0), (CRANK, 0.0), rod))
        rates.append(((0.0, CRANK * SPEED), rod_rate))
        pivot = sign * PIVOT[0], PIVOT[1]
        bodies.append((ROCKER_MASS, ROCKER_INERTIA, (sign * ROCKER_CENTRE, 0.0), pivot, rocker))
        rates.append(((0.0, 0.0), rocker_rate))
        joints[k] = 0, (CRANK, 0.0), rod_body, (0.0, 0.0)
        joints[2 + k] = rod_body, (ROD, 0.0), rocker_body, (-sign * FRONT, 0.0)
        joints[4 + k] = None, pivot, rocker_body, (0.0, 0.0)
        springs.append((rocker_body, (sign * REAR, 0.0), PIVOT[1], LOAD, FREE_LENGTH))
    law = Contact(JOURNAL, Bore(radii), stiffness(), DAMPING, FILM, friction, FRICTION_SPEED)
    return Linkage(bodies, rates, joints, SPEED, springs, contacts=None if ideal else [law] * 6)


def cycle(friction, ideal, radii=(BUSHING, BUSHING, BUSHING)):
    """The settled cycle: `time` and, by joint, the force on the bushing in its frame and the angle, as replies have them, without friction and
    film; and the driving torque [N m].
    """
    drive = linkage(friction, ideal, radii)
    rows = drive.simulate(PERIOD, 1, 2000, None if ideal else TOLERANCE)
    reply = {"time": [time for time, _, _ in rows], "joints": {}, "torque": []}
    for name in JOINTS:
        reply["joints"][name] = {"force_x": [], "force_y": [], "angle": []}
    for _, state, reactions in rows:
        torque = 0.0
        for k, name in enumerate(JOINTS):
            angle, force, moment = drive.joint(k, state, reactions)
            for key, value in zip(("force_x", "force_y", "angle"), (*force, angle)):
                reply["joints"][name][key].append(value)
            torque += moment
        reply["torque"].append(torque)
    return reply
