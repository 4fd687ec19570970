//! Coulomb's law of friction, regularised in the sliding speed: F_T / F_N = mu tanh(v_t / v_0), with the coefficient mu [1], the
//! normal force F_N [N], the sliding speed v_t and the regularisation speed v_0 [m/s].
//!
//! # Source
//! Andersson, Soderberg, Bjorklund (2007), Tribology International 40, 580-587.

use crate::lanes::{Real, tanh};

/// F_T / F_N at the sliding speed `v` [m/s], for the coefficient `mu` and the inverse `per_speed` of the regularisation speed [s/m], and its derivative
/// to v [s/m].
#[inline(always)]
pub(crate) fn coulomb<R: Real>(mu: R, per_speed: R, v: R) -> (R, R) {
    let th = tanh(v * per_speed);
    (mu * th, mu * th.like(1.0).minus_product(th, th) * per_speed)
}
