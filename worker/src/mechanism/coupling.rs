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
//!
//! # Sliding
//! Sliding of the two bodies of an ideal joint on each other, and the normal force that its friction follows.
//!
//! With the coordinates (x, y, angle) [m, m, rad] of the first body's reference point, then of the second's, as in `constraint.rs`, and
//! their rates w `(6,)`, the sliding speed is v_t = b . w [m/s] and the friction force F_T [N] has the generalised force -b F_T
//! `(6,)`, so that it loses the power F_T v_t. F_T = mu tanh(v_t / v_0) N with the normal force N >= 0 of the joint:
//!
//! - revolute, pin of radius r: b = (0, 0, r, 0, 0, -r), N = |(lambda_1, lambda_2)|;
//! - prismatic, along the unit vector u of the line (normal n = left(u)): with the arms a from the first body's reference point to its
//!   point and c from the second's to the same point, b = (u, a x u, -u, -c x u). The force lambda_1 along n and the moment
//!   lambda_2 about the first body's point are borne by two forces at the ends of a guide of length L centred there,
//!   lambda_1 / 2 +- lambda_2 / L, hence N = |lambda_1 / 2 + lambda_2 / L| + |lambda_1 / 2 - lambda_2 / L| = max(|lambda_1|, 2 |lambda_2| / L).
//!
//! The force on the pin is that of the constraint alone; the friction of a guide acts along its line, without a moment from the
//! height of the slider. N has a corner where it vanishes, and that of a guide where the ends share the load anew.
//!
//! Source:
//! Friction of ideal joints by their reactions: Haug, Wu, Yang (1986), Mechanism and Machine Theory 21, 401-425.

use super::frame::{Frame, Prescribed};
use super::piecewise_cubic::{Jet, PiecewiseCubic};
use crate::contact::coulomb;
use crate::lanes::{Real, lanewise};
use crate::plane::{cross, dot, left};
use common::scene::{IdealFriction, JointKind};

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

/// Constants of the friction of an ideal joint, or of one per lane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionConstants<R = f64> {
    /// Coefficient mu [1].
    coefficient: R,
    /// Regularisation speed v_0 [m/s].
    speed: R,
    /// Radius of the pin, or length of the guide [m].
    pub(super) size: R,
}

lanewise!(FrictionConstants { coefficient, speed, size });

impl From<IdealFriction> for FrictionConstants {
    fn from(IdealFriction { coefficient, speed, size }: IdealFriction) -> Self {
        FrictionConstants { coefficient, speed, size }
    }
}

/// How the bodies of one joint slide on each other.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sliding<R> {
    /// Direction b `(6,)` [1, m].
    pub direction: [R; 6],
    /// Derivative of b to the coordinates `(6, 6)`; `None` if b is constant.
    pub turning: Option<[[R; 6]; 6]>,
    /// Rates w `(6,)` [m/s, rad/s].
    pub rates: [R; 6],
    /// Sliding speed v_t [m/s].
    pub speed: R,
    /// F_T / N = mu tanh(v_t / v_0) [1] and its derivative to v_t [s/m].
    pub ratio: R,
    pub slope: R,
}

/// Normal force N as a function of the two multipliers of a joint.
#[derive(Debug, Clone, Copy)]
pub struct NormalForce<R> {
    /// Inverse of half the length L of a guide [1/m]; `None` for a pin.
    pub(super) per_half: Option<R>,
}

impl<R: Real> NormalForce<R> {
    /// That of a guide of length `length` [m].
    #[inline(always)]
    pub(super) fn in_guide(length: R) -> Self {
        NormalForce { per_half: Some(length.like(2.0) / length) }
    }

    /// N at the multipliers `lambda` `(2,)` [N] and its derivative to them `(2,)`; zero where N has its corner at zero.
    #[inline(always)]
    pub(super) fn at(&self, lambda: [R; 2]) -> (R, [R; 2]) {
        let zero = lambda[0].zero();
        let one = zero.like(1.0);
        match self.per_half {
            None => {
                let size = (lambda[0] * lambda[0]).plus_product(lambda[1], lambda[1]).sqrt();
                let inverse = one / R::select(zero.below(size), size, one);
                (size, [lambda[0] * inverse, lambda[1] * inverse])
            }
            Some(per_half) => {
                let (force, pair) = (lambda[0].abs(), lambda[1].abs() * per_half);
                let tilted = force.below(pair);
                let sign = |x: R| R::select(zero.below(x), one, R::select(x.below(zero), -one, zero));
                let slopes = [
                    R::select(tilted, zero, sign(lambda[0])),
                    R::select(tilted, sign(lambda[1]) * per_half, zero),
                ];
                (R::select(tilted, pair, force), slopes)
            }
        }
    }
}

impl<R: Real> Sliding<R> {
    /// Sliding on a pin.
    #[inline(always)]
    pub(super) fn on_pin(constants: FrictionConstants<R>, first: &Frame<R>, second: &Frame<R>) -> Self {
        let (radius, zero) = (constants.size, constants.size.zero());
        Self::new(constants, [zero, zero, radius, zero, zero, -radius], None, [first, second])
    }

    /// Sliding along the line with normal `normal` in the second body's frame, with the point of the slider at `arm` of the first body.
    #[inline(always)]
    pub(super) fn in_guide(
        constants: FrictionConstants<R>,
        normal: [R; 2],
        arm: [R; 2],
        first: &Frame<R>,
        second: &Frame<R>,
    ) -> Self {
        let n = second.turn(normal);
        let u = [n[1], -n[0]];
        let a = first.turn(arm);
        let c = [first.x[0] + a[0] - second.x[0], first.x[1] + a[1] - second.x[1]];
        let direction = [u[0], u[1], cross(a, u), -u[0], -u[1], -cross(c, u)];
        let (zero, along) = (n[0].zero(), dot(a, u));
        // u turns into n with the second body, a into left(a) with the first, and c is the distance between the reference points plus a.
        let mut turning = [[zero; 6]; 6];
        for k in 0..2 {
            (turning[k][5], turning[3 + k][5]) = (n[k], -n[k]);
        }
        (turning[2][2], turning[2][5]) = (-along, along);
        turning[5] = [-u[1], u[0], along, u[1], -u[0], -dot(c, u)];
        Self::new(constants, direction, Some(turning), [first, second])
    }

    #[inline(always)]
    fn new(
        constants: FrictionConstants<R>,
        direction: [R; 6],
        turning: Option<[[R; 6]; 6]>,
        frames: [&Frame<R>; 2],
    ) -> Self {
        let [i, j] = frames;
        let rates = [i.v[0], i.v[1], i.omega, j.v[0], j.v[1], j.omega];
        let mut speed = rates[0].zero();
        for k in 0..6 {
            speed = speed.plus_product(direction[k], rates[k]);
        }
        let (ratio, slope) = coulomb(constants.coefficient, speed.like(1.0) / constants.speed, speed);
        Sliding { direction, turning, rates, speed, ratio, slope }
    }
}
