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

use super::condense::{Condenser, Touched};
use super::equilibrium::{Equilibrium, NoEquilibrium, equilibrium};
use super::interval::ContactSample;
use crate::bore::Profile;
use crate::contact::{Foundation, Surface, equivalent_penetration};
use crate::plane::length;

/// Intervals of the bore at which the foundation is evaluated for wear: 1.25 deg at 36 control points. The
/// pressure is scaled to the force it carries, so its quadrature need not be that of the force: the volume
/// test (`foundation_wears_the_volume_its_pressure_asks_for`) finds it within 1e-4, and within 1.4e-5 with
/// twice that number.
const INTERVALS: usize = 288;

/// Contacts of a frozen history on an elastic foundation.
#[derive(Debug, Clone)]
pub struct ConformalContacts {
    law: Foundation,
    condenser: Condenser,
    /// Control point before every angle of the tabulated bore, and the hat function of the one after it there [1].
    hats: Vec<(usize, f64)>,
    /// Means of groups of samples.
    samples: Vec<ContactSample>,
    /// Evaluations of the foundation so far.
    evaluations: u64,
}

impl ConformalContacts {
    /// Without samples, for a bore with `points` control points.
    pub(crate) fn new(surface: Surface, points: usize) -> Self {
        let law = Foundation::with_intervals(surface, points, INTERVALS);
        let sub = law.arc().intervals() / points;
        ConformalContacts {
            hats: (0..points * sub).map(|k| (k / sub, (k % sub) as f64 / sub as f64)).collect(),
            law,
            condenser: Condenser::new(surface.clearance, points),
            samples: Vec::new(),
            evaluations: 0,
        }
    }

    /// Replaces the history by the samples of a cycle simulated on `profile`.
    pub(crate) fn freeze(&mut self, profile: &Profile, samples: &[ContactSample]) {
        let stiffness = self.law.surface.stiffness;
        let touched = |s: &ContactSample| Touched {
            penetration: equivalent_penetration(length(s.force), stiffness),
            direction: s.force,
        };
        self.condenser.condense(samples, touched, &mut self.samples);
        self.law.profile_changed(profile);
        self.samples.iter_mut().for_each(|s| s.penetration = self.law.arc().gap_along(s.e));
    }

    /// Evaluations of the foundation so far.
    #[cfg(test)]
    pub(crate) fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Shares q_i of all samples on the present profile `(points,)` [N rad].
    ///
    /// # Errors
    /// [`NoEquilibrium`] if a frozen force has no equilibrium on that bore.
    pub(crate) fn shares(&mut self, profile: &Profile, shares: &mut [f64]) -> Result<(), NoEquilibrium> {
        shares.fill(0.0);
        self.law.profile_changed(profile);
        for sample in &mut self.samples {
            self.evaluations += u64::from(add_share(&self.law, &self.hats, sample, shares)?);
        }
        Ok(())
    }
}

/// Adds the share of one sample: the pressure that carries its force on the present profile, distributed over
/// the control points by their hat functions `hats`, times the work per unit of force. Moves the sample's
/// eccentricity and penetration to the equilibrium found, as the start for the next stage. Returns the number
/// of evaluations of the contact.
///
/// # Errors
/// [`NoEquilibrium`] if no equilibrium was found.
fn add_share(
    law: &Foundation,
    hats: &[(usize, f64)],
    sample: &mut ContactSample,
    shares: &mut [f64],
) -> Result<u32, NoEquilibrium> {
    let wanted = libm::hypot(sample.force[0], sample.force[1]);
    if wanted <= 0.0 {
        return Ok(0);
    }
    // The search starts at the last penetration, measured from the present bore.
    let reach = libm::hypot(sample.e[0], sample.e[1]);
    let follow =
        if reach > 0.0 { 1.0 + (sample.penetration - law.arc().gap_along(sample.e)) / reach } else { 1.0 };
    let Equilibrium { e, load, evaluations } =
        equilibrium(law, sample.force, [follow * sample.e[0], follow * sample.e[1]])?;
    sample.e = e;
    sample.penetration = law.arc().gap_along(e);
    let scale = sample.work * load.modulus / libm::hypot(load.force[0], load.force[1]);
    let n = shares.len();
    law.arc().weigh(e, |k, part| {
        let (i, s) = hats[k];
        shares[i] += scale * part * (1.0 - s);
        shares[if i + 1 == n { 0 } else { i + 1 }] += scale * part * s;
    });
    Ok(evaluations)
}
