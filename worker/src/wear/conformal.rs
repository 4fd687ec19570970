//! Wear under the foundation law: where the frozen force rests on the bore as it is now, and how its pressure is
//! shared out.

use super::ContactSample;
use crate::contact::{Foundation, equivalent_penetration};

/// Relative residual below which the contact of a sample counts as found again.
pub const BALANCED: f64 = 1e-6;

/// The contact of a sample could not be found again on the present profile; carries the relative residual.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unbalanced(pub f64);

/// Adds one sample's share under the foundation law: the pressure that carries the frozen force on the present
/// profile, shared out to the control points by their hat functions, times the work per unit force.
/// Moves the sample's eccentricity and penetration to the equilibrium found, as the start for the next stage.
///
/// # Errors
/// [`Unbalanced`] if no equilibrium was found.
pub fn foundation_share(
    law: &Foundation,
    sample: &mut ContactSample,
    rate: &mut [f64],
) -> Result<(), Unbalanced> {
    let wanted = libm::hypot(sample.force[0], sample.force[1]);
    if wanted <= 0.0 || sample.e == [0.0; 2] {
        return Ok(());
    }
    let (e, modulus) = equilibrium(law, sample).map_err(Unbalanced)?;
    sample.e = e;
    sample.penetration = law.arc().gap_along(e);
    let scale = sample.work * modulus / wanted;
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
    Ok(())
}

/// Contact below this share of the force sought counts as too weak to linearise.
const WEAK: f64 = 0.2;
const MOST_ITERATIONS: usize = 60;

/// Eccentricity at which the foundation carries the sample's normal force in the direction it had, and its modulus
/// there: two equations dU/de = F n, by Newton's method with step halving. From no contact, or next to none, the journal first
/// moves outward along the load, by the penetration of that force on an unworn bore at a time.
///
/// # Errors
/// The relative residual, if it stays above [`BALANCED`].
fn equilibrium(law: &Foundation, sample: &ContactSample) -> Result<([f64; 2], f64), f64> {
    let size = |r: [f64; 2]| (r[0] * r[0] + r[1] * r[1]).sqrt();
    let target = sample.force;
    let wanted = size(target);
    let outward = equivalent_penetration(wanted, law.surface().stiffness) / wanted;
    let at = |e: [f64; 2]| {
        let pressing = law.press(e, |_, _, _| {});
        let miss = [pressing.force[0] - target[0], pressing.force[1] - target[1]];
        (e, pressing, miss)
    };
    // Start as deep below the present bore as the journal last was.
    let length = size(sample.e);
    let follow = 1.0 + (sample.penetration - law.arc().gap_along(sample.e)) / length;
    let mut now = at([follow * sample.e[0], follow * sample.e[1]]);
    for _ in 0..MOST_ITERATIONS {
        let (e, pressing, miss) = now;
        if size(miss) <= BALANCED * wanted {
            return Ok((e, pressing.modulus));
        }
        let [[a, b], [_, d]] = pressing.stiffness;
        let det = a * d - b * b;
        if size(pressing.force) < WEAK * wanted || det <= 0.0 {
            now = at([e[0] + outward * target[0], e[1] + outward * target[1]]);
            continue;
        }
        let step = [-(d * miss[0] - b * miss[1]) / det, -(a * miss[1] - b * miss[0]) / det];
        let mut damping = 1.0;
        let closer = |damping: f64| {
            let trial = at([e[0] + damping * step[0], e[1] + damping * step[1]]);
            (size(trial.2) < size(miss)).then_some(trial)
        };
        now = loop {
            if let Some(trial) = closer(damping) {
                break trial;
            }
            damping *= 0.5;
            if damping < 1e-6 {
                return Err(size(miss) / wanted);
            }
        };
    }
    Err(size(now.2) / wanted)
}
