//! Archard's law over one cycle: how fast each control point of a bore wears, given the cycle's contact history
//! and the profile as it is now.
//!
//! The history fixes forces and sliding; the contact is found again on the present profile, because the spot
//! that wears unloads itself. That feedback is what makes the wear step stiff.

use super::conformal::{Unbalanced, foundation_share};
use super::local_arcs::LocalArcs;
use super::{ContactHistory, ContactSample};
use crate::bore::Profile;
use crate::contact::{Contact, Foundation};
use std::f64::consts::TAU;

/// Intervals of the bore at which the foundation is found again: 1.25 deg at 36 control points. The pressure is
/// scaled to the force it carries, so its quadrature need not be that of the force: the volume test
/// (`foundation_wears_the_volume_its_pressure_asks_for`) finds it within 1e-4, and within 1.4e-5 with twice as many.
const CONFORMAL_INTERVALS: usize = 288;

/// Wear rate of one joint under a frozen contact history.
#[derive(Debug, Clone)]
pub struct WearRate {
    /// Wear coefficient K_H [1/Pa].
    coefficient: f64,
    /// Width L [m].
    width: f64,
    profile: Profile,
    law: Law,
    /// Evaluations of the foundation so far.
    evaluations: u64,
}

/// How the contact is found again, and in which directions.
#[derive(Debug, Clone)]
enum Law {
    Local(LocalArcs),
    Foundation { law: Foundation, samples: Vec<ContactSample> },
}

impl WearRate {
    /// Rate of a joint with wear coefficient `coefficient` [1/Pa], width `width` [m] and this contact law.
    pub fn new(coefficient: f64, width: f64, contact: &Contact, profile: &Profile) -> Self {
        let points = profile.points();
        WearRate {
            coefficient,
            width,
            profile: profile.clone(),
            evaluations: 0,
            law: match contact {
                Contact::LocalHertz(law) => Law::Local(LocalArcs::new(law.surface.journal_radius, points)),
                Contact::Foundation(law) => Law::Foundation {
                    law: Foundation::with_intervals(*law.surface(), points, CONFORMAL_INTERVALS),
                    samples: Vec::new(),
                },
            },
        }
    }

    /// Takes over the history of the cycle just simulated.
    pub fn freeze(&mut self, history: &ContactHistory) {
        match &mut self.law {
            Law::Local(arcs) => arcs.freeze(history.samples()),
            Law::Foundation { law, samples } => {
                samples.clear();
                samples.extend_from_slice(history.samples());
                law.profile_changed(&self.profile);
                samples.iter_mut().for_each(|s| s.penetration = law.arc().gap_along(s.e));
            }
        }
    }

    /// Evaluations of the foundation that finding the contact again has taken so far; none under the local law.
    pub fn evaluations(&self) -> u64 {
        self.evaluations
    }

    /// Wear per cycle at every control point, for a bore worn to `depth`: `(points,)` [m].
    ///
    /// # Errors
    /// [`Unbalanced`] if the frozen force finds no rest on that bore.
    pub fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), Unbalanced> {
        self.profile.set_depth(depth);
        let per = match &mut self.law {
            Law::Local(arcs) => {
                arcs.shares(&self.profile, rate);
                self.width
            }
            Law::Foundation { law, samples } => {
                rate.fill(0.0);
                law.profile_changed(&self.profile);
                for sample in samples {
                    self.evaluations += u64::from(foundation_share(law, sample, rate)?);
                }
                TAU / rate.len() as f64 * self.profile.initial_radius() * self.width
            }
        };
        rate.iter_mut().for_each(|r| *r *= self.coefficient / per);
        Ok(())
    }
}
