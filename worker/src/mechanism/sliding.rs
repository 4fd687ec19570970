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
//! # Source
//! Friction of ideal joints by their reactions: Haug, Wu, Yang (1986), Mechanism and Machine Theory 21, 401-425.

// In lanes, closures of iterators are not compiled for the instruction set of the loop around them.
#![allow(clippy::needless_range_loop)]

use super::frame::Frame;
use crate::contact::coulomb;
use crate::lanes::Real;
use crate::plane::{cross, dot};

/// Constants of the friction of an ideal joint, or of one per lane: coefficient mu [1], regularisation speed v_0 [m/s], and radius of the pin or
/// length of the guide [m].
pub type FrictionConstants<R = f64> = [R; 3];

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

/// Normal force N at the two multipliers `lambda` `(2,)` [N] of a joint and its derivative to them `(2,)`; zero where N has its corner at zero.
/// `per_half` is the inverse of half the length L of a guide [1/m]; `None` for a pin.
#[inline(always)]
pub(super) fn normal_force<R: Real>(per_half: Option<R>, lambda: [R; 2]) -> (R, [R; 2]) {
    let zero = lambda[0].zero();
    let one = zero.like(1.0);
    match per_half {
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

impl<R: Real> Sliding<R> {
    /// Sliding on a pin.
    #[inline(always)]
    pub(super) fn on_pin(constants: FrictionConstants<R>, first: &Frame<R>, second: &Frame<R>) -> Self {
        let [_, _, radius] = constants;
        let zero = radius.zero();
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
        let (ratio, slope) = coulomb(constants[0], speed.like(1.0) / constants[1], speed);
        Sliding { direction, turning, rates, speed, ratio, slope }
    }
}
