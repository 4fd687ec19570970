//! Ideal joints as constraints phi(q, t) = 0 between two bodies.
//!
//! Coordinates of the pair: (x, y, angle) [m, m, rad] of the first body's reference point, then of the
//! second's. With the arms a, b from the reference points to the joint's two points in global axes [m], S the
//! quarter turn, n the unit normal of a prismatic joint's line (fixed in the second body) and d = x_1 + a -
//! x_2 - b [m]:
//!
//! - revolute: d = 0;
//! - prismatic: n.d = 0 and theta_1 - theta_2 = angle;
//! - fixed: d = 0 and theta_1 - theta_2 = angle;
//! - slot: n.d = 0; distances and meshes: see `coupling`.
//!
//! The acceleration form is phi'' = G a + h(q, v) with G = dphi/dq and the accelerations a. Integration needs
//! the exact derivatives of G a + h at constant a, and of G' lambda at constant multipliers lambda.
//!
//! # Source
//! Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems; Nikravesh (1988),
//! Computer-Aided Analysis of Mechanical Systems.

use super::coupling::{Geometry, second_derivative};
use super::frame::{End, Frame};
use super::piecewise_cubic::Jet;
use super::prescribed::Prescribed;
use super::sliding::{FrictionConstants, Sliding};
use crate::lanes::{Real, lanewise, same_in_lanes};
use crate::plane::{dot, left};
use common::scene::{GuideClearance, IdealFriction, JointKind, Mesh};
use std::f64::consts::TAU;

/// Most scalar constraints of one joint.
pub const MOST_ROWS: usize = 3;

/// Values of the rows of one joint.
pub type RowValues<R = f64> = [R; MOST_ROWS];
/// Derivatives of the rows to the six coordinates of the pair.
pub type RowDerivatives<R = f64> = [[R; 6]; MOST_ROWS];

/// An ideal joint between two frames, or one per lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constraint<R = f64> {
    /// Index into the scene's joints.
    pub scene_joint: usize,
    /// Points of the joint on the two bodies.
    pub ends: [End<R>; 2],
    kind: Kind,
    /// Normal of a prismatic joint's or slot's line in the second body's frame, direction of the force of a mesh in the global one `(2,)` [1].
    normal: [R; 2],
    /// theta_1 - theta_2 of a prismatic or fixed joint [rad]; 1 / L of a distance [1/m]; the value that a mesh keeps [m].
    angle: R,
    /// Lever arms of a mesh `(2,)` [m].
    arms: [R; 2],
    /// What the joint is given, with its derivatives, at the state last set.
    pub(super) input: Jet<R>,
    /// Friction of a revolute or prismatic joint, if it has any.
    pub friction: Option<FrictionConstants<R>>,
}

lanewise!(Constraint { scene_joint, ends, kind, normal, angle, arms, input, friction });

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    Revolute,
    Prismatic,
    Fixed,
    Slot,
    Distance,
    Mesh,
}

same_in_lanes!(Kind);

/// First row of each constraint, and the total number of rows.
pub(crate) fn first_rows<R: Real>(constraints: &[Constraint<R>]) -> (Vec<usize>, usize) {
    let mut rows = 0;
    let mut first = Vec::with_capacity(constraints.len());
    for c in constraints {
        first.push(rows);
        rows += c.rows();
    }
    (first, rows)
}

impl<R: Real> Geometry<R> {
    #[inline(always)]
    fn new(ends: &[End<R>; 2], first: &Frame<R>, second: &Frame<R>) -> Self {
        let (a, b) = (first.turn(ends[0].arm), second.turn(ends[1].arm));
        let (sa, sb) = (left(a), left(b));
        let (mut d, mut rate) = (a, a);
        for k in 0..2 {
            d[k] = first.x[k] + a[k] - second.x[k] - b[k];
            rate[k] = first.v[k] + first.omega * sa[k] - second.v[k] - second.omega * sb[k];
        }
        Geometry { a, b, d, rate }
    }
}

impl Constraint {
    /// The constraint that closes a joint of this kind; a joint with clearance closes as a revolute one, a guide with
    /// clearance as a prismatic one.
    pub(crate) fn new(scene_joint: usize, ends: [End; 2], kind: &JointKind) -> Self {
        let normal_of = |axis: f64| {
            let (sin, cos) = libm::sincos(axis);
            [-sin, cos]
        };
        let (mut arms, mut input) = ([0.0; 2], [0.0; 4]);
        let (kind, normal, angle) = match kind {
            JointKind::Revolute | JointKind::Clearance(_) => (Kind::Revolute, [0.0; 2], 0.0),
            JointKind::Prismatic { axis, angle } | JointKind::Guide(GuideClearance { axis, angle, .. }) => {
                (Kind::Prismatic, normal_of(*axis), *angle)
            }
            JointKind::Fixed { angle } => (Kind::Fixed, [0.0; 2], *angle),
            JointKind::Slot { axis } => (Kind::Slot, normal_of(*axis), 0.0),
            JointKind::LinearDrive(drive) => {
                input = Prescribed::stroke(drive).jet(0.0);
                (Kind::Distance, [0.0; 2], 1.0 / input[0])
            }
            JointKind::Mesh(Mesh { direction, arms: of_force, value, .. }) => {
                arms = *of_force;
                (Kind::Mesh, *direction, *value)
            }
            JointKind::Cam { direction, .. } => (Kind::Mesh, *direction, 0.0),
        };
        Constraint { scene_joint, ends, kind, normal, angle, arms, input, friction: None }
    }

    /// Holds a distance that is given over time at its present value.
    pub(crate) fn stop(&mut self) {
        if self.kind == Kind::Distance {
            self.input[1..].fill(0.0);
        }
    }

    /// The constraint with this friction.
    pub(crate) fn with_friction(self, friction: Option<IdealFriction>) -> Self {
        let constants = |IdealFriction { coefficient, speed, size }| [coefficient, speed, size];
        Constraint { friction: friction.map(constants), ..self }
    }

    /// Size of the force the joint transmits, for multipliers `lambda` of its rows and the `friction` along a prismatic joint [N]. A
    /// prismatic joint's moment is not part of it, nor the moment of friction on a pin. That of a cam, of teeth and of a belt is negative where
    /// their contact cannot transmit it.
    pub(crate) fn force(&self, lambda: &[f64], friction: f64) -> f64 {
        match self.kind {
            Kind::Prismatic => libm::hypot(lambda[0], friction),
            Kind::Distance => (lambda[0] * self.input[0] * self.angle).abs(),
            Kind::Mesh => -lambda[0],
            Kind::Slot => lambda[0].abs(),
            Kind::Revolute | Kind::Fixed => libm::hypot(lambda[0], lambda[1]),
        }
    }
}

impl<R: Real> Constraint<R> {
    /// Number of scalar constraints (rows) of the joint.
    #[inline(always)]
    pub(crate) fn rows(&self) -> usize {
        match self.kind {
            Kind::Revolute | Kind::Prismatic => 2,
            Kind::Fixed => 3,
            Kind::Slot | Kind::Distance | Kind::Mesh => 1,
        }
    }

    /// Derivatives of phi and of G a + h to time of a joint that is given a function of time.
    #[inline(always)]
    pub(crate) fn over_time(&self) -> Option<[R; 2]> {
        let [s, rate, second, third] = self.input;
        let of_acceleration = rate * second * 3.0 + s * third;
        (self.kind == Kind::Distance).then(|| [-(s * rate * self.angle), -(of_acceleration * self.angle)])
    }

    /// Inverse of half the length of a guide with friction [1/m].
    pub(super) fn per_half(&self) -> Option<R> {
        let [_, _, length] = self.friction?;
        (self.kind == Kind::Prismatic).then(|| length.like(2.0) / length)
    }

    /// How the two bodies slide on each other, if the joint has friction.
    #[inline(always)]
    pub(super) fn sliding(&self, first: &Frame<R>, second: &Frame<R>) -> Option<Sliding<R>> {
        let friction = self.friction?;
        Some(match self.kind {
            Kind::Prismatic => Sliding::in_guide(friction, self.normal, self.ends[0].arm, first, second),
            _ => Sliding::on_pin(friction, first, second),
        })
    }

    /// Whether row `k` is an angle [rad]; else it is a length [m].
    #[inline(always)]
    pub(crate) fn is_angle(&self, k: usize) -> bool {
        match self.kind {
            Kind::Prismatic => k == 1,
            Kind::Fixed => k == 2,
            _ => false,
        }
    }

    /// Value phi `(rows,)` [m, rad] and derivative G `(rows, 6)` to the coordinates of the pair.
    #[inline(always)]
    pub(crate) fn position(&self, first: &Frame<R>, second: &Frame<R>) -> (RowValues<R>, RowDerivatives<R>) {
        let g = Geometry::new(&self.ends, first, second);
        let zero = first.angle.zero();
        let one = zero.like(1.0);
        let mut phi = [zero; MOST_ROWS];
        let mut rows = [[zero; 6]; MOST_ROWS];
        match self.kind {
            Kind::Revolute | Kind::Fixed => {
                let (sa, sb) = (left(g.a), left(g.b));
                for k in 0..2 {
                    phi[k] = g.d[k];
                    rows[k][k] = one;
                    rows[k][2] = sa[k];
                    rows[k][3 + k] = -one;
                    rows[k][5] = -sb[k];
                }
                if self.kind == Kind::Fixed {
                    (phi[2], rows[2]) = relative_angle(first, second, self.angle);
                }
            }
            Kind::Prismatic | Kind::Slot => {
                let n = second.turn(self.normal);
                phi[0] = dot(n, g.d);
                let turn = dot(left(n), g.d) - dot(n, left(g.b));
                rows[0] = [n[0], n[1], dot(n, left(g.a)), -n[0], -n[1], turn];
                if self.kind == Kind::Prismatic {
                    (phi[1], rows[1]) = relative_angle(first, second, self.angle);
                }
            }
            Kind::Distance => (phi[0], rows[0]) = g.distance(self.angle, &self.input),
            Kind::Mesh => {
                let angles = [first.angle, second.angle];
                (phi[0], rows[0]) = g.mesh(self.normal, self.arms, &self.input, angles);
                phi[0] -= self.angle;
            }
        }
        (phi, rows)
    }

    /// Centripetal part h `(rows,)` of phi'' = G a + h [m/s^2, rad/s^2].
    #[inline(always)]
    pub(crate) fn centripetal(&self, first: &Frame<R>, second: &Frame<R>) -> RowValues<R> {
        let g = Geometry::new(&self.ends, first, second);
        let zero = first.angle.zero();
        let (wa, wb) = (first.omega * first.omega, second.omega * second.omega);
        let d2 = [wb * g.b[0] - wa * g.a[0], wb * g.b[1] - wa * g.a[1]];
        match self.kind {
            Kind::Revolute | Kind::Fixed => [d2[0], d2[1], zero],
            Kind::Distance => [g.distance_centripetal(self.angle, &self.input, d2), zero, zero],
            Kind::Mesh => [dot(self.normal, d2) - self.input[2] * wb, zero, zero],
            Kind::Prismatic | Kind::Slot => {
                let n = second.turn(self.normal);
                let h = dot(n, d2) - wb * dot(n, g.d) + second.omega * dot(left(n), g.rate) * 2.0;
                [h, zero, zero]
            }
        }
    }

    /// Derivatives of G a + h to the coordinates and to their rates, at constant accelerations `a` of the
    /// pair.
    #[inline(always)]
    pub(crate) fn acceleration_derivatives(
        &self,
        first: &Frame<R>,
        second: &Frame<R>,
        acceleration: &[R; 6],
    ) -> (RowDerivatives<R>, RowDerivatives<R>) {
        let g = Geometry::new(&self.ends, first, second);
        let zero = first.angle.zero();
        let (sa, sb) = (left(g.a), left(g.b));
        let (wi, wj) = (first.omega, second.omega);
        let (ai, aj) = (acceleration[2], acceleration[5]);
        let mut to_q = [[zero; 6]; MOST_ROWS];
        let mut to_v = [[zero; 6]; MOST_ROWS];
        // Derivatives of d'' to the two angles and the two angular velocities.
        let (mut first_turn, mut second_turn) = ([zero; 2], [zero; 2]);
        for k in 0..2 {
            first_turn[k] = -ai * g.a[k] - wi * wi * sa[k];
            second_turn[k] = aj * g.b[k] + wj * wj * sb[k];
        }
        match self.kind {
            Kind::Revolute | Kind::Fixed => {
                for k in 0..2 {
                    to_q[k][2] = first_turn[k];
                    to_q[k][5] = second_turn[k];
                    to_v[k][2] = wi * g.a[k] * -2.0;
                    to_v[k][5] = wj * g.b[k] * 2.0;
                }
            }
            Kind::Distance => {
                let d2 = second_derivative(&g, [first, second], acceleration);
                (to_q[0], to_v[0]) =
                    g.distance_derivatives(self.angle, d2, [first_turn, second_turn], [wi, wj]);
            }
            Kind::Mesh => {
                let (u, [_, _, second, third]) = (self.normal, self.input);
                to_q[0][2] = dot(u, first_turn);
                to_q[0][5] = dot(u, second_turn) - second * aj - third * wj * wj;
                to_v[0][2] = wi * dot(u, g.a) * -2.0;
                to_v[0][5] = wj * (dot(u, g.b) - second) * 2.0;
            }
            Kind::Prismatic | Kind::Slot => {
                let n = second.turn(self.normal);
                let sn = left(n);
                let d2 = second_derivative(&g, [first, second], acceleration);
                for k in 0..2 {
                    let along = aj * sn[k] - wj * wj * n[k];
                    (to_q[0][k], to_q[0][3 + k]) = (along, -along);
                    let along = wj * sn[k] * 2.0;
                    (to_v[0][k], to_v[0][3 + k]) = (along, -along);
                }
                to_q[0][2] = aj * dot(sn, sa) - wj * wj * dot(n, sa) - wj * wi * dot(sn, g.a) * 2.0
                    + dot(n, first_turn);
                to_q[0][5] = aj * (-dot(n, g.d) - dot(sn, sb)) - wj * wj * (dot(sn, g.d) - dot(n, sb))
                    + wj * (wj * dot(sn, g.b) - dot(n, g.rate)) * 2.0
                    + dot(sn, d2)
                    + dot(n, second_turn);
                to_v[0][2] = (wj * dot(sn, sa) - wi * dot(n, g.a)) * 2.0;
                to_v[0][5] = (dot(sn, g.rate) - wj * dot(n, g.d)) * 2.0;
            }
        }
        (to_q, to_v)
    }

    /// Derivative of G' lambda to the coordinates, at constant `lambda` `(6, 6)`.
    #[inline(always)]
    pub(crate) fn reaction_derivative(
        &self,
        first: &Frame<R>,
        second: &Frame<R>,
        lambda: &[R],
    ) -> [[R; 6]; 6] {
        let g = Geometry::new(&self.ends, first, second);
        let mut to_q = [[first.angle.zero(); 6]; 6];
        match self.kind {
            Kind::Revolute | Kind::Fixed => {
                let l = [lambda[0], lambda[1]];
                to_q[2][2] = -dot(g.a, l);
                to_q[5][5] = dot(g.b, l);
            }
            Kind::Distance => to_q = g.distance_reaction(lambda[0] * self.angle),
            Kind::Mesh => {
                to_q[2][2] = -(lambda[0] * dot(self.normal, g.a));
                to_q[5][5] = lambda[0] * (dot(self.normal, g.b) - self.input[2]);
            }
            Kind::Prismatic | Kind::Slot => {
                let (n, l) = (second.turn(self.normal), lambda[0]);
                let sn = left(n);
                for k in 0..2 {
                    (to_q[k][5], to_q[5][k]) = (l * sn[k], l * sn[k]);
                    (to_q[3 + k][5], to_q[5][3 + k]) = (-(l * sn[k]), -(l * sn[k]));
                }
                to_q[2][2] = -(l * dot(n, g.a));
                (to_q[2][5], to_q[5][2]) = (l * dot(n, g.a), l * dot(n, g.a));
                to_q[5][5] = -(l * (dot(n, g.d) + dot(n, g.b)));
            }
        }
        to_q
    }
}

/// Value and derivative of the row theta_1 - theta_2 = angle, modulo whole turns.
#[inline(always)]
fn relative_angle<R: Real>(first: &Frame<R>, second: &Frame<R>, angle: R) -> (R, [R; 6]) {
    let zero = angle.zero();
    let one = zero.like(1.0);
    let off = first.angle - second.angle - angle;
    let turns = (off / zero.like(TAU)).round();
    (off - turns * TAU, [zero, zero, one, zero, zero, -one])
}
