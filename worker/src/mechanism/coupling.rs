//! Rows of ideal joints of one condition on two bodies: a distance that is given over time, and gear pairs, racks, belts and cams.
//!
//! With d the vector from the second point to the first, its derivative d' and the arms a, b [m], S the quarter turn, s(t) the given distance,
//! L its value at time zero [m], u a fixed direction [1], rho lever arms and f the lift over the angle of the second body [m]:
//!
//! - distance: phi = (d . d - s^2) / (2 L), so that the force along d is lambda |d| / L;
//! - mesh: phi = u . d + rho_1 theta_1 + rho_2 theta_2 - value - f(theta_2).
//!
//! # Source
//! Haug (1989), Computer Aided Kinematics and Dynamics of Mechanical Systems, sections 3.2 and 3.4.

use super::frame::Frame;
use super::piecewise_cubic::{Jet, PiecewiseCubic};
use super::prescribed::Prescribed;
use crate::lanes::Real;
use crate::plane::{dot, left};
use common::scene::JointKind;

/// What a joint is given: a function of time, or of the angle of its second body.
#[derive(Debug, Clone, PartialEq)]
pub enum JointInput {
    /// Distance over time [m].
    Stroke(Prescribed),
    /// Lift over the angle of the second body [m].
    Lift(PiecewiseCubic),
}

impl JointInput {
    /// What a joint of this kind is given, if anything.
    pub(super) fn new(kind: &JointKind) -> Option<Self> {
        match kind {
            JointKind::LinearDrive(drive) => Some(JointInput::Stroke(Prescribed::stroke(drive))),
            JointKind::Cam { lift, .. } => Some(JointInput::Lift(PiecewiseCubic::spline(lift))),
            _ => None,
        }
    }

    /// Its value and derivatives at time `t` [s] and the angle of the second body [rad].
    pub(super) fn jet(&self, t: f64, angle: f64) -> Jet {
        match self {
            JointInput::Stroke(stroke) => stroke.jet(t),
            JointInput::Lift(lift) => lift.jet(angle),
        }
    }
}

/// Arms and distance of the two points of a joint, in global axes.
pub(super) struct Geometry<R> {
    /// Arms a of the first point and b of the second [m].
    pub a: [R; 2],
    pub b: [R; 2],
    /// Distance d from the second point to the first [m].
    pub d: [R; 2],
    /// Rate dd/dt of that distance [m/s].
    pub rate: [R; 2],
}

impl<R: Real> Geometry<R> {
    /// Derivatives of d to the six coordinates.
    #[inline(always)]
    fn columns(&self) -> [[R; 2]; 6] {
        let (zero, one) = (self.d[0].zero(), self.d[0].like(1.0));
        let (sa, sb) = (left(self.a), left(self.b));
        [[one, zero], [zero, one], sa, [-one, zero], [zero, -one], [-sb[0], -sb[1]]]
    }

    /// Value and derivative of the row of a distance; `inverse` is 1 / L [1/m].
    #[inline(always)]
    pub(super) fn distance(&self, inverse: R, stroke: &Jet<R>) -> (R, [R; 6]) {
        let gap = (dot(self.d, self.d) - stroke[0] * stroke[0]) * inverse * 0.5;
        (gap, self.columns().map(|column| dot(self.d, column) * inverse))
    }

    /// Centripetal part of that row, `d2` being that of d.
    #[inline(always)]
    pub(super) fn distance_centripetal(&self, inverse: R, stroke: &Jet<R>, d2: [R; 2]) -> R {
        let [s, rate, second, _] = *stroke;
        (dot(self.d, d2) + dot(self.rate, self.rate) - rate * rate - s * second) * inverse
    }

    /// Derivatives of its acceleration form to the coordinates and their rates, for the second derivative `d2` of d, its derivatives `turns` to
    /// the two angles, and the angular velocities of both bodies.
    #[inline(always)]
    pub(super) fn distance_derivatives(
        &self,
        inverse: R,
        d2: [R; 2],
        turns: [[R; 2]; 2],
        speeds: [R; 2],
    ) -> ([R; 6], [R; 6]) {
        let (columns, [wi, wj]) = (self.columns(), speeds);
        let mut to_q = columns.map(|column| dot(column, d2) * inverse);
        let mut to_v = columns.map(|column| dot(self.rate, column) * inverse * 2.0);
        let (along_a, along_b) = (dot(self.d, self.a), dot(self.d, self.b));
        to_q[2] += (dot(self.d, turns[0]) - wi * dot(self.rate, self.a) * 2.0) * inverse;
        to_q[5] += (dot(self.d, turns[1]) + wj * dot(self.rate, self.b) * 2.0) * inverse;
        to_v[2] -= wi * along_a * inverse * 2.0;
        to_v[5] += wj * along_b * inverse * 2.0;
        (to_q, to_v)
    }

    /// Derivative of G' lambda of that row to the coordinates.
    #[inline(always)]
    pub(super) fn distance_reaction(&self, force: R) -> [[R; 6]; 6] {
        let columns = self.columns();
        let mut to_q = columns.map(|row| columns.map(|column| dot(row, column) * force));
        to_q[2][2] -= force * dot(self.d, self.a);
        to_q[5][5] += force * dot(self.d, self.b);
        to_q
    }

    /// Value, without the constant, and derivative of the row of a mesh.
    #[inline(always)]
    pub(super) fn mesh(&self, u: [R; 2], arms: [R; 2], lift: &Jet<R>, angles: [R; 2]) -> (R, [R; 6]) {
        let phi = dot(u, self.d) + arms[0] * angles[0] + arms[1] * angles[1] - lift[0];
        let mut row = self.columns().map(|column| dot(u, column));
        row[2] += arms[0];
        row[5] += arms[1] - lift[1];
        (phi, row)
    }
}

/// Second derivative of the difference of two points of moving bodies, at these accelerations of the bodies `(6,)` [m/s^2].
#[inline(always)]
pub(super) fn second_derivative<R: Real>(
    g: &Geometry<R>,
    [first, second]: [&Frame<R>; 2],
    acceleration: &[R; 6],
) -> [R; 2] {
    let (sa, sb) = (left(g.a), left(g.b));
    let (wi, wj) = (first.omega * first.omega, second.omega * second.omega);
    let along = |k: usize| {
        acceleration[k] + acceleration[2] * sa[k]
            - wi * g.a[k]
            - acceleration[3 + k]
            - acceleration[5] * sb[k]
            + wj * g.b[k]
    };
    [along(0), along(1)]
}
