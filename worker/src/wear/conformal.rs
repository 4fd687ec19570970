//! Wear under `foundation`: the pressure that carries a frozen force on the present bore, and its share per
//! control point.
//!
//! Share of control point i: q_i = (F S / |F_el|) integral of kappa g phi_i over the arc [N rad], with the
//! work F S [N m] of a sample, the equilibrium force F_el [N] of the foundation, its modulus kappa [N/(m
//! rad)], the gap function g [m] and the hat function phi_i of the point [1]. `archard.rs` multiplies by K_H
//! / (spacing R2 L), which makes it K_H p_i S.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988, with the pressure of a Winkler foundation
//! (`contact/foundation.rs`).

use super::ContactSample;
use super::rest::{Rest, rest};
use crate::contact::Foundation;

/// The contact of a sample could not be found again on the present profile; carries what stands in the way
/// over its bound: the force that is left over, or the penetration where that is beyond the law's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unbalanced(pub f64);

/// Adds one sample's share under the foundation law: the pressure that carries the frozen force on the
/// present profile, shared out to the control points by their hat functions, times the work per unit force.
/// Moves the sample's eccentricity and penetration to the equilibrium found, as the start for the next stage.
/// Returns how many evaluations of the contact that took.
///
/// # Errors
/// [`Unbalanced`] if no equilibrium was found.
pub fn foundation_share(
    law: &Foundation,
    sample: &mut ContactSample,
    rate: &mut [f64],
) -> Result<u32, Unbalanced> {
    let wanted = libm::hypot(sample.force[0], sample.force[1]);
    if wanted <= 0.0 {
        return Ok(0);
    }
    // The search starts as deep below the present bore as the journal last was.
    let reach = libm::hypot(sample.e[0], sample.e[1]);
    let follow =
        if reach > 0.0 { 1.0 + (sample.penetration - law.arc().gap_along(sample.e)) / reach } else { 1.0 };
    let Rest { e, pressing, evaluations } =
        rest(law, sample.force, [follow * sample.e[0], follow * sample.e[1]])?;
    sample.e = e;
    sample.penetration = law.arc().gap_along(e);
    let scale = sample.work * pressing.modulus / libm::hypot(pressing.force[0], pressing.force[1]);
    let n = rate.len();
    let sub = law.arc().intervals() / n;
    let mut hat = |k: usize, weight: f64| {
        let (i, j) = (k / sub % n, k % sub);
        let s = j as f64 / sub as f64;
        rate[i] += scale * weight * (1.0 - s);
        rate[(i + 1) % n] += scale * weight * s;
    };
    law.arc().integrate(e, |k, a, b| {
        hat(k, a);
        hat(k + 1, b);
    });
    Ok(evaluations)
}
