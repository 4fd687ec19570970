//! Archard's law over one cycle: wear rate of every control point of a bore under a frozen contact history.
//!
//! Archard: wear depth h = K_H p s, with the wear coefficient K_H [1/Pa] (dimensionless coefficient over
//! hardness), the contact pressure p [Pa] and the sliding distance s [m]. A contact sample is a short part of
//! the cycle with normal force F [N], sliding distance S = integral of |v_t| dt [m] and work F S [N m]; L is
//! the width of the bore [m]. Per cycle N, the depth h_i [m] of control point i grows by
//!
//! - `local-hertz`: dh_i/dN = K_H sum F S a_i / (L |AB|), where AB is the contact arc of the sample on the
//!   present profile, |AB| its length [m] and a_i the degree to which point i lies inside it (1 inside, 0
//!   outside);
//! - `foundation`: dh = K_H p |v_t| dt, that is dh_i/dN = K_H sum p_i S, where p_i [Pa] is the pressure that
//!   carries F on the present profile, averaged with the hat function of point i.
//!
//! The history fixes forces and sliding distances; the contact is found again on the present profile, because
//! a spot that wears unloads itself. That feedback makes the wear step stiff.
//!
//! Valid for mild sliding wear with a constant K_H; only the bushing wears, and wear never decreases. The
//! local rule does not keep the worn volume of an arc narrower than the spacing of the control points; the
//! foundation rule does.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988. Arc rule of the local law: the seed paper, Cui et al., China
//! Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020.

use super::conformal::{Unbalanced, foundation_share};
use super::local_arcs::LocalArcs;
use super::{ContactHistory, ContactSample};
use crate::bore::Profile;
use crate::contact::{Contact, Foundation};
use std::f64::consts::TAU;

/// Intervals of the bore at which the foundation is found again: 1.25 deg at 36 control points. The pressure
/// is scaled to the force it carries, so its quadrature need not be that of the force: the volume test
/// (`foundation_wears_the_volume_its_pressure_asks_for`) finds it within 1e-4, and within 1.4e-5 with twice
/// as many.
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

    /// Evaluations of the foundation that finding the contact again has taken so far; none under the local
    /// law.
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
