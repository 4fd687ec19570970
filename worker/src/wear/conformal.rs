//! Wear under `foundation`: the pressure that carries a frozen force on the present bore, and its share per
//! control point.
//!
//! Share of control point i: q_i = (F S / |F_el|) integral of kappa g phi_i over the arc [N rad], with the
//! work F S [N m] of a sample, the equilibrium force F_el [N] of the foundation, its modulus kappa [N/(m
//! rad)], the gap function g [m] and the hat function phi_i of the point [1]. `archard.rs` multiplies by K_H
//! / (spacing R2 L), which makes it K_H p_i S. A journal that wears has its shares of the same pressure at its own control points,
//! with R1 in the place of R2; the equilibrium is that of both worn surfaces, with the journal turned as it was in the sample.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988, with the pressure of a Winkler foundation
//! (`contact/foundation.rs`).

use super::condense::{Condenser, Touched};
use super::equilibrium::{ElasticSurfaces, Equilibrium, NoEquilibrium, equilibrium};
use super::interval::ContactSample;
use crate::bore::Profile;
use crate::contact::{Foundation, Journal, Surface, equivalent_penetration};
use crate::lanes::{Vectorised, fused};
use crate::plane::length;
use std::f64::consts::TAU;

/// Intervals of the bore at which the foundation is evaluated for wear: 1.25 deg at 36 control points. The
/// pressure is scaled to the force it carries, so its quadrature need not be that of the force: the volume
/// test (`foundation_wears_the_volume_its_pressure_asks_for`) finds it within 1e-4, and within 1.4e-5 with
/// twice that number.
const INTERVALS: usize = 288;

/// Contacts of a frozen history on an elastic foundation.
#[derive(Debug, Clone)]
pub struct ConformalContacts {
    law: Foundation,
    /// The journal, if it wears.
    journal: Option<Journal>,
    condenser: Condenser,
    /// Control point before every angle of the tabulated bore, and the hat function of the one after it there [1].
    hats: Vec<(usize, f64)>,
    /// Means of groups of samples.
    samples: Vec<ContactSample>,
    /// Evaluations of the foundation so far.
    evaluations: u64,
}

impl ConformalContacts {
    /// Without samples, for a bore with `points` control points and a journal with as many, if that `wears`.
    pub(crate) fn new(surface: Surface, points: usize, wears: bool) -> Self {
        let law = Foundation::with_intervals(surface, points, INTERVALS);
        let sub = law.arc().intervals() / points;
        ConformalContacts {
            hats: (0..points * sub).map(|k| (k / sub, (k % sub) as f64 / sub as f64)).collect(),
            journal: wears.then(|| law.new_journal(points)),
            law,
            condenser: Condenser::new(surface.clearance, points),
            samples: Vec::new(),
            evaluations: 0,
        }
    }

    /// Replaces the history by the samples of a cycle simulated on `profile`.
    pub(crate) fn freeze(&mut self, profile: &Profile, samples: &[ContactSample]) {
        let (stiffness, wears) = (self.law.surface.stiffness, self.journal.is_some());
        let touched = |s: &ContactSample| Touched {
            penetration: equivalent_penetration(length(s.force), stiffness),
            direction: s.force,
            turn: wears.then_some(s.turn),
        };
        self.condenser.condense(samples, touched, &mut self.samples);
        self.law.profile_changed(profile);
        let (law, journal) = (&self.law, self.journal.as_ref());
        for sample in &mut self.samples {
            sample.penetration = match journal.and_then(|journal| law.with_journal(journal)) {
                None => law.gap_along(sample.e),
                Some(law) => (law, sample.turn).gap_along(sample.e),
            };
        }
    }

    /// Evaluations of the foundation so far.
    #[cfg(test)]
    pub(crate) fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Shares q_i of all samples on the present profile `(points,)` [N rad], and then those of a journal that wears, whose depths are
    /// `of_journal` [m].
    ///
    /// # Errors
    /// [`NoEquilibrium`] if a frozen force has no equilibrium on that bore.
    pub(crate) fn shares(
        &mut self,
        profile: &Profile,
        of_journal: &[f64],
        shares: &mut [f64],
    ) -> Result<(), NoEquilibrium> {
        shares.fill(0.0);
        fused(SharedPressures { contacts: self, profile, of_journal, shares })
    }
}

/// Adds the shares of all samples.
struct SharedPressures<'a> {
    contacts: &'a mut ConformalContacts,
    profile: &'a Profile,
    of_journal: &'a [f64],
    shares: &'a mut [f64],
}

impl Vectorised for SharedPressures<'_> {
    type Output = Result<(), NoEquilibrium>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let SharedPressures { contacts, profile, of_journal, shares } = self;
        contacts.law.profile_changed(profile);
        let ConformalContacts { law, journal, hats, samples, evaluations, .. } = contacts;
        let Some(journal) = journal else {
            for sample in samples {
                *evaluations += u64::from(add_share(law, hats, sample, shares)?);
            }
            return Ok(());
        };
        journal.set_depth(of_journal);
        let (shares, of_journal) = shares.split_at_mut(profile.points());
        for sample in samples {
            let Some(law) = law.with_journal(journal) else { continue };
            let law = (law, sample.turn);
            let Some((found, scale)) = find_equilibrium(&law, sample)? else { continue };
            *evaluations += u64::from(found.evaluations);
            let (points, intervals) = (shares.len() as f64, hats.len() as f64);
            let turn = sample.turn * points / TAU;
            law.0.turned_arc().weigh(found.e, sample.turn, |k, part| {
                add_hats(shares, hats[k], scale * part);
                let place = (k as f64 * (points / intervals) - turn).rem_euclid(points);
                let i = (place as usize).min(shares.len() - 1);
                add_hats(of_journal, (i, place - i as f64), scale * part);
            });
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
#[inline(always)]
fn add_share(
    law: &Foundation,
    hats: &[(usize, f64)],
    sample: &mut ContactSample,
    shares: &mut [f64],
) -> Result<u32, NoEquilibrium> {
    let Some((Equilibrium { e, evaluations, .. }, scale)) = find_equilibrium(law, sample)? else {
        return Ok(0);
    };
    law.arc().weigh(e, |k, part| add_hats(shares, hats[k], scale * part));
    Ok(evaluations)
}

/// Adds `amount` to the point before a place and the one after it: the place is at a fraction of the interval behind its point.
#[inline(always)]
fn add_hats(shares: &mut [f64], (i, s): (usize, f64), amount: f64) {
    let n = shares.len();
    shares[i] += amount * (1.0 - s);
    shares[if i + 1 == n { 0 } else { i + 1 }] += amount * s;
}

/// The equilibrium of a sample's force, and the sample's work times the foundation's modulus per force [N/rad]; `None` without a force. Moves the
/// sample's eccentricity and penetration to it.
///
/// # Errors
/// [`NoEquilibrium`] if no equilibrium was found.
#[inline(always)]
fn find_equilibrium(
    law: &impl ElasticSurfaces,
    sample: &mut ContactSample,
) -> Result<Option<(Equilibrium, f64)>, NoEquilibrium> {
    let wanted = libm::hypot(sample.force[0], sample.force[1]);
    if wanted <= 0.0 {
        return Ok(None);
    }
    // The search starts at the last penetration, measured from the present surfaces.
    let reach = libm::hypot(sample.e[0], sample.e[1]);
    let follow = if reach > 0.0 { 1.0 + (sample.penetration - law.gap_along(sample.e)) / reach } else { 1.0 };
    let found = equilibrium(law, sample.force, [follow * sample.e[0], follow * sample.e[1]])?;
    sample.e = found.e;
    sample.penetration = law.gap_along(found.e);
    let load = found.load;
    let scale = sample.work * load.modulus / libm::hypot(load.force[0], load.force[1]);
    Ok(Some((found, scale)))
}
