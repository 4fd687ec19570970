"""Planar linkages with a driven crank in Exudyn: with ideal joints, or with the worn bores and the contact law `local-hertz` of Hingewise.

A body is (mass [kg], inertia about its centre of mass [kg m^2], place of the centre of mass in its frame [m], place of its origin [m],
angle [rad]) at the start; the first one is the crank, which turns about the origin, and `None` is the frame. A joint is (journal's body, its place there,
bushing's body, its place there); a vertical spring is (body, place, height of its anchor [m], stiffness [N/m], free length [m]); a torque is (body, torque [N m]).
"""

from math import atan2, cos, hypot, sin, sqrt, tanh, tau

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    CartesianSpringDamper,
    CoordinateConstraint,
    MarkerBodyRigid,
    MarkerNodeCoordinate,
    NodePointGround,
    NodeRigidBody2D,
    ObjectGround,
    ObjectJointRevolute2D,
    ObjectRigidBody2D,
    RigidBodySpringDamper,
    Torque,
)

# Mass [kg] and inertia [kg m^2] of a crank that no joint force moves.
HEAVY = 1e9


class Bore:
    """A bore by its radii at control points at equal angles [m], joined by a periodic cubic spline."""

    def __init__(self, radii):
        n, self.radii = len(radii), list(radii)
        system = sum(share * np.roll(np.eye(n), shift, axis=1) for share, shift in ((4, 0), (1, 1), (1, -1)))
        # Second derivatives times the squared spacing.
        bends = 6 * (np.roll(radii, 1) - 2 * np.array(radii) + np.roll(radii, -1))
        self.bends = np.linalg.solve(system, bends).tolist()

    def at(self, angle):
        """Radius and its derivative to the angle."""
        n = len(self.radii)
        place = angle * n / tau % n
        i, s = int(place) % n, place % 1
        j, t = (i + 1) % n, 1 - place % 1
        (r, q), (a, b) = (self.radii[i], self.radii[j]), (self.bends[i] / 6, self.bends[j] / 6)
        slope = q - r + a * (1 - 3 * t * t) + b * (3 * s * s - 1)
        return t * r + s * q + a * (t**3 - t) + b * (s**3 - s), slope * n / tau


class Contact:
    """The law of one joint in a bore [m, N/m^1.5, s/m, N s/m, 1, m/s]."""

    def __init__(self, journal_radius, bore, stiffness, damping, film, friction, friction_speed):
        self.journal_radius, self.bore, self.stiffness = journal_radius, bore, stiffness
        self.damping, self.film, self.friction, self.friction_speed = damping, film, friction, friction_speed

    def forces(self, e, w, turning, of_bushing):
        """Normal and friction force [N], the direction of the eccentricity `e` [m], the radius of the bore there [m] and the sliding speed
        [m/s], at the relative velocity `w` of the centres [m/s], the angular velocity `turning` of the journal in the bushing and that
        `of_bushing` [rad/s].
        """
        size = hypot(*e)
        radius, slope = self.bore.at(atan2(e[1], e[0]))
        delta = size + self.journal_radius - radius
        if delta <= 0 or size == 0:
            return 0.0, 0.0, (0.0, 0.0), radius, 0.0
        u = e[0] / size, e[1] / size
        along = w[1] * u[0] - w[0] * u[1]
        rate = w[0] * u[0] + w[1] * u[1] - slope * (along / size - of_bushing)
        normal = self.stiffness * delta * sqrt(delta) * max(0.0, 1 + self.damping * rate)
        slip = along + turning * self.journal_radius - of_bushing * (radius - self.journal_radius)
        return normal, self.friction * normal * tanh(slip / self.friction_speed), u, radius, slip


class Linkage:
    """A linkage at its start; with `contacts` those of its joints, else ideal joints."""

    def __init__(self, bodies, rates, joints, speed, springs=(), torques=(), contacts=None):
        self.container = exu.SystemContainer()
        self.mbs = mbs = self.container.AddSystem()
        self.bodies, self.places, self.contacts = bodies, joints, contacts
        self.ground = mbs.AddObject(ObjectGround())
        self.objects, self.nodes = [], []
        for (mass, inertia, centre, origin, angle), (velocity, rate) in zip(bodies, rates):
            at = turned(centre, angle)
            node = NodeRigidBody2D(
                referenceCoordinates=[origin[0] + at[0], origin[1] + at[1], angle],
                initialVelocities=[velocity[0] - rate * at[1], velocity[1] + rate * at[0], rate],
            )
            self.nodes.append(mbs.AddNode(node))
            body = ObjectRigidBody2D(mass=mass, inertia=inertia, nodeNumber=self.nodes[-1])
            self.objects.append(mbs.AddObject(body))
        if contacts is None:
            self.joints = [mbs.AddObject(ObjectJointRevolute2D(markerNumbers=self.ends(joint))) for joint in joints]
            self.drive(speed)
        else:
            for joint, contact in zip(joints, contacts):
                self.connect(joint, contact)
        for body, place, height, stiffness, length in springs:
            ends = [self.marker(None, (0.0, height)), self.marker(body, place)]
            spring = CartesianSpringDamper(markerNumbers=ends, stiffness=[0, stiffness, 0], offset=[0, length, 0])
            mbs.AddObject(spring)
        for body, torque in torques:
            mbs.AddLoad(Torque(markerNumber=self.marker(body, (0, 0)), loadVector=[0, 0, torque]))

    def marker(self, body, place):
        centre = (0.0, 0.0) if body is None else self.bodies[body][2]
        at = [place[0] - centre[0], place[1] - centre[1], 0]
        number = self.ground if body is None else self.objects[body]
        return self.mbs.AddMarker(MarkerBodyRigid(bodyNumber=number, localPosition=at))

    def ends(self, joint):
        """Markers of bushing and journal."""
        journal, at_journal, bushing, at_bushing = joint
        return [self.marker(bushing, at_bushing), self.marker(journal, at_journal)]

    def drive(self, speed):
        """Holds the crank at the origin with this speed [rad/s]."""
        mbs = self.mbs
        pivot = [self.marker(None, (0, 0)), self.marker(0, (0, 0))]
        mbs.AddObject(ObjectJointRevolute2D(markerNumbers=pivot))
        fixed = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()), coordinate=0))
        turning = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=self.nodes[0], coordinate=2))
        constraint = CoordinateConstraint(markerNumbers=[fixed, turning], velocityLevel=True, offset=speed)
        self.driven = mbs.AddObject(constraint)

    def connect(self, joint, contact):
        """A joint with clearance: the force of its law by a user function, in the bushing's frame."""
        node, film = None if joint[2] is None else self.nodes[joint[2]], contact.film
        rate = exu.OutputVariableType.Coordinates_t

        def force(mbs, t, item, e, rotation, w, turning, *unused):
            of_bushing = 0.0 if node is None else mbs.GetNodeOutput(node, rate)[2]
            normal, friction, (x, y), radius, _ = contact.forces(e, w, turning[2], of_bushing)
            f = normal * x - friction * y + film * w[0], normal * y + friction * x + film * w[1]
            return [f[0], f[1], 0, 0, 0, radius * friction]

        self.mbs.AddObject(
            RigidBodySpringDamper(
                markerNumbers=self.ends(joint),
                stiffness=[[0] * 6] * 6,
                damping=[[0] * 6] * 6,
                springForceTorqueUserFunction=force,
            )
        )

    def state(self):
        """Place of the origin, angle, and their rates of every body."""
        found = []
        for node, (_, _, centre, _, angle) in zip(self.nodes, self.bodies):
            x, y, turn = self.mbs.GetNodeOutput(node, exu.OutputVariableType.Coordinates)
            vx, vy, rate = self.mbs.GetNodeOutput(node, exu.OutputVariableType.Coordinates_t)
            x0, y0, _ = self.mbs.GetNode(node)["referenceCoordinates"]
            at = turned(centre, angle + turn)
            found.append((x0 + x - at[0], y0 + y - at[1], angle + turn, vx + rate * at[1], vy - rate * at[0], rate))
        return found

    def simulate(self, period, settling, steps, tolerance=None):
        """Rows of the cycle after `settling` cycles: time, state of the bodies and, of ideal joints, the forces of the journals on the bushings
        and the driving torque.
        """
        rows, start = [], settling * period
        self.mbs.Assemble()

        def collect(mbs, t):
            if t >= start - 0.5 * period / steps:
                rows.append((t - start, self.state(), self.multipliers()))
            return True

        self.mbs.SetPostStepUserFunction(collect)
        settings = exu.SimulationSettings()
        time = settings.timeIntegration
        time.endTime = start + period
        time.verboseMode = 0
        settings.solution.file.write = False
        time.numberOfSteps = (settling + 1) * steps
        if self.contacts is None:
            time.generalizedAlpha.spectralRadius = 0.9
            done = self.mbs.SolveDynamic(settings)
        else:
            time.automaticStepSize = True
            time.relativeTolerance, time.absoluteTolerance = tolerance, 1e-3 * tolerance
            done = self.mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.DOPRI5)
        if not done:
            raise RuntimeError("the integration failed")
        return rows

    def joint(self, k, state, reactions):
        """Of joint `k` the angle of the journal's body minus that of the bushing's [rad], the normal force of the journal on the bushing in the
        bushing's frame [N], and the torque about the origin that holds the journal if it is on the crank [N m].
        """
        journal, at_journal, bushing, at_bushing = self.places[k]
        (i, p), (j, q) = self.point(state, journal, at_journal), self.point(state, bushing, at_bushing)
        angle = i[2] - j[2]
        if self.contacts is None:
            normal = turned(reactions[0][k], -j[2])
            whole, spin = reactions[0][k], 0.0
        else:
            contact = self.contacts[k]
            w, (force, friction, (x, y), _, _) = self.contact(k, state)[1:]
            normal = force * x, force * y
            in_frame = normal[0] - friction * y + contact.film * w[0], normal[1] + friction * x + contact.film * w[1]
            whole, spin = turned(in_frame, j[2]), contact.journal_radius * friction
        return angle, normal, p[0] * whole[1] - p[1] * whole[0] + spin if journal == 0 else 0.0

    def contact(self, k, state):
        """Eccentricity of joint `k` [m], relative velocity of its centres [m/s], and the forces of its contact."""
        journal, at_journal, bushing, at_bushing = self.places[k]
        (i, p), (j, q) = self.point(state, journal, at_journal), self.point(state, bushing, at_bushing)
        e, w = (turned((p[n] - q[n], p[n + 1] - q[n + 1]), -j[2]) for n in (0, 2))
        return e, w, self.contacts[k].forces(e, w, i[5] - j[5], j[5])

    def point(self, state, body, place):
        """State of a body, and place and velocity of its point."""
        if body is None:
            return (0.0,) * 6, (*place, 0.0, 0.0)
        x, y, angle, vx, vy, rate = state[body]
        at = turned(place, angle)
        return state[body], (x + at[0], y + at[1], vx - rate * at[1], vy + rate * at[0])

    def multipliers(self):
        """Forces of the ideal joints of the journals on the bushings in global axes [N], and the driving torque [N m]."""
        if self.contacts is not None:
            return None
        system, found = self.mbs.systemData, []
        values = system.GetAECoordinates()
        for number in self.joints:
            found.append(tuple(values[row] for row in system.GetObjectLTGAE(number)[:2]))
        return found, values[system.GetObjectLTGAE(self.driven)[0]]


def turned(v, angle):
    c, s = cos(angle), sin(angle)
    return v[0] * c - v[1] * s, v[0] * s + v[1] * c
