//! Wear under `foundation`: the pressure that carries a frozen force on the present bore, and its share per
//! control point.
//!
//! Share of control point i: q_i = F S integral of g phi_i / |integral of g u| over the arc [N m], with the
//! work F S [N m] of a sample, the gap function g [m], the unit vector u and the hat function phi_i of the point [1]: the
//! pressure is in proportion to g and carries F. `archard.rs` multiplies by K_H
//! / (spacing R2 L), which makes it K_H p_i S. A journal that wears has its shares of the same pressure at its own control points,
//! with R1 in the place of R2; the equilibrium is that of both worn surfaces, with the journal turned as it was in the sample.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988, with the pressure of a Winkler foundation
//! (`contact/foundation.rs`).

use super::condense::Condenser;
use super::equilibrium::{ElasticSurfaces, Equilibrium, NoEquilibrium, equilibrium};
use super::interval::ContactSample;
use super::nodal_loads::{ArcShares, IntervalLoads, NodalLoads};
use crate::bore::Profile;
use crate::contact::{Foundation, Journal, SegmentParts, Surface, equivalent_penetration};
use crate::lanes::{Vectorised, fused};
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
    /// The journal, if it wears.
    journal: Option<Journal>,
    condenser: Condenser,
    /// Sums for the shares on the tabulated bore, if the journal is round.
    sums: NodalLoads,
    /// Shares of the sample at hand on a bore with a round journal, and with a worn one what the angles of the table get.
    shares: ArcShares,
    parts: Vec<SegmentParts>,
    /// Sums of these over the samples.
    fine: Box<IntervalLoads>,
    /// Means of groups of samples.
    samples: Vec<ContactSample>,
    /// Evaluations of the foundation so far.
    pub(super) evaluations: u64,
}

impl ConformalContacts {
    /// Without samples, for a bore with `points` control points and a journal with as many, if that `wears`.
    pub(crate) fn new(surface: Surface, points: usize, wears: bool) -> Self {
        let law = Foundation::with_intervals(surface, points, INTERVALS);
        ConformalContacts {
            sums: NodalLoads::new(&law.arc, points),
            shares: ArcShares::default(),
            parts: Vec::new(),
            fine: Box::default(),
            journal: wears.then(|| law.new_journal(points)),
            law,
            condenser: Condenser::new(surface.clearance, points),
            samples: Vec::new(),
            evaluations: 0,
        }
    }

    /// Replaces the history by the samples of a cycle simulated on `profile`.
    pub(crate) fn freeze(&mut self, profile: &Profile, samples: &[ContactSample]) {
        self.law.profile_changed(profile);
        let (law, journal) = (&self.law, self.journal.as_ref());
        let touched = |s: &ContactSample| {
            let worn = journal.and_then(|journal| law.with_journal(journal));
            let penetration = equivalent_penetration(length(s.force), law.surface.stiffness);
            (penetration, worn.map(|law| law.half_arc(s.e, s.turn)))
        };
        self.condenser.condense(samples, touched, journal.is_some(), &mut self.samples);
        for sample in &mut self.samples {
            sample.penetration = match journal.and_then(|journal| law.with_journal(journal)) {
                None => law.gap_along(sample.e),
                Some(law) => (law, sample.turn).gap_along(sample.e),
            };
        }
    }

    /// Shares q_i of all samples on the present profile `(points,)` [N m], and then those of a journal that wears, whose depths are
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
        fused((self, profile, of_journal, shares))
    }
}

/// Adds the shares of all samples, as [`ConformalContacts::shares`] returns them.
impl Vectorised for (&mut ConformalContacts, &Profile, &[f64], &mut [f64]) {
    type Output = Result<(), NoEquilibrium>;

    #[inline(always)]
    fn run(self) -> Self::Output {
        let (contacts, profile, of_journal, shares) = self;
        contacts.law.profile_changed(profile);
        if contacts.journal.is_none() {
            contacts.add_shares(shares)
        } else {
            contacts.add_both(of_journal, shares)
        }
    }
}

impl ConformalContacts {
    /// Adds the shares of all samples on the tabulated bore with a round journal.
    #[inline(always)]
    fn add_shares(&mut self, to: &mut [f64]) -> Result<(), NoEquilibrium> {
        let ConformalContacts { law, sums, shares, samples, evaluations, .. } = self;
        sums.tabulate(&law.arc);
        for sample in samples {
            let Some((e, spent)) = find_equilibrium(law, sample)? else { continue };
            *evaluations += u64::from(spent);
            sums.shares(&law.arc, e, shares);
            let scale = work_per_pressure(sample, shares.pressed)?;
            for &(i, [here, next]) in &shares.each {
                to[i] += scale * here;
                to[if i + 1 == to.len() { 0 } else { i + 1 }] += scale * next;
            }
        }
        Ok(())
    }

    /// Adds the shares of all samples on the tabulated bore with a journal worn to the depths `of_journal` [m]: those of the bore and
    /// then those of the journal.
    #[inline(always)]
    fn add_both(&mut self, of_journal: &[f64], to: &mut [f64]) -> Result<(), NoEquilibrium> {
        let ConformalContacts { law, journal, samples, parts, fine, evaluations, .. } = self;
        let Some(journal) = journal else { return Ok(()) };
        journal.set_depth(of_journal);
        fine.clear(law.arc.intervals());
        for sample in samples {
            let Some(law) = law.with_journal(journal) else { continue };
            let law = (law, sample.turn);
            let Some((e, spent)) = find_equilibrium(&law, sample)? else { continue };
            *evaluations += u64::from(spent);
            let arc = law.0.arc;
            let pressed = arc.weigh(e, sample.turn, parts);
            fine.add(parts, arc.place(sample.turn), work_per_pressure(sample, pressed)?);
        }
        fine.share_out(to);
        Ok(())
    }
}

/// The sample's work over what its arc presses with, the integral of g u `pressed` [m rad]: [N].
///
/// # Errors
/// [`NoEquilibrium`] if nothing presses.
#[inline(always)]
fn work_per_pressure(sample: &ContactSample, pressed: [f64; 2]) -> Result<f64, NoEquilibrium> {
    let size = length(pressed);
    if size > 0.0 { Ok(sample.work / size) } else { Err(NoEquilibrium(f64::INFINITY)) }
}

/// The equilibrium of a sample's force; `None` without a force. Moves the sample's eccentricity and penetration to it, as the start for
/// the next stage.
///
/// # Errors
/// [`NoEquilibrium`] if no equilibrium was found.
#[inline(always)]
fn find_equilibrium(
    law: &impl ElasticSurfaces,
    sample: &mut ContactSample,
) -> Result<Option<Equilibrium>, NoEquilibrium> {
    if libm::hypot(sample.force[0], sample.force[1]) <= 0.0 {
        return Ok(None);
    }
    // The search starts at the last penetration, measured from the present surfaces.
    let reach = libm::hypot(sample.e[0], sample.e[1]);
    let follow = if reach > 0.0 { 1.0 + (sample.penetration - law.gap_along(sample.e)) / reach } else { 1.0 };
    let found = equilibrium(law, sample.force, [follow * sample.e[0], follow * sample.e[1]])?;
    sample.e = found.0;
    sample.penetration = law.gap_along(found.0);
    Ok(Some(found))
}
