"""Dimensions of the four-bar of Hingewise [m, kg, rad/s], and a reply from the motion and the reactions of its ideal joints."""

import sys
from math import acos, atan2, cos, pi, sin
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from hingewise.cycle import in_frame  # noqa: E402  the package of this repository

CRANK, COUPLER, ROCKER, GROUND = 0.02, 0.06, 0.05, 0.07
COUPLER_MASS, ROCKER_MASS = 0.020, 0.018
SPEED = 900 * 2 * pi / 60


def start_angles():
    """Angles of coupler and rocker where the crank lies along the ground [rad]."""
    base = GROUND - CRANK
    coupler = acos((COUPLER**2 + base**2 - ROCKER**2) / (2 * COUPLER * base))
    return coupler, atan2(COUPLER * sin(coupler), COUPLER * cos(coupler) - base)


def start_rates():
    """Their rates there, by which their common point has one velocity [rad/s]."""
    coupler, rocker = start_angles()
    det = COUPLER * ROCKER * sin(coupler - rocker)
    return CRANK * SPEED * ROCKER * sin(rocker) / det, CRANK * SPEED * COUPLER * sin(coupler) / det


def reply(time, angles, forces):
    """The reply for instants `time` [s], rows of the angles of crank, coupler and rocker [rad] with the relative speed of the last two
    [rad/s], and rows of the global forces of crank on coupler, coupler on rocker and frame on rocker [N].
    """
    crank, coupler, rocker, speed = zip(*angles)
    sides = {"crank": (crank, coupler), "coupler": (coupler, rocker), "rocker": ([0.0] * len(time), rocker)}
    joints = {}
    for k, (name, (journal, bushing)) in enumerate(sides.items()):
        turn = [a - b for a, b in zip(journal, bushing)]
        joints[name] = {"angle": turn, **in_frame([force[k] for force in forces], bushing)}
    return {"time": list(time), "joints": joints, "outputs": {"coupler_joint_speed": max(speed)}}
