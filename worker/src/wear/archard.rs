//! Archard's law over one cycle: wear rate of every control point of a bore, and of the journal in it if that
//! wears, under a frozen contact history.
//!
//! Archard: wear depth h = K_H p s, with the wear coefficient K_H [1/Pa] (dimensionless coefficient over
//! hardness), the contact pressure p [Pa] and the sliding distance s [m]. A contact sample is a short part of
//! the cycle with normal force F [N], sliding distance S = integral of |v_t| dt [m] and work F S [N m]; L is
//! the width of the bore [m]. Per cycle N, the depth h_i [m] of control point i grows by
//!
//! - `local-hertz`: dh_i/dN = K_H sum F S w_i / (L R spacing), where w_i [1] is the mean of the hat function
//!   of point i over the contact arc of the sample on the present profile, and R [m] the mean radius there;
//! - `foundation`: dh = K_H p |v_t| dt, that is dh_i/dN = K_H sum p_i S, where p_i [Pa] is the pressure that
//!   carries F on the present profile, averaged with the hat function of point i.
//!
//! The history fixes forces and sliding distances; the contact is found again on the present profile, because
//! a spot that wears unloads itself. That feedback makes the wear step stiff.
//!
//! The journal wears by the same law, with its own coefficient and radius, at the places of its own surface that the arc
//! covers: those at the angle chi = psi - alpha in its body, with the angle alpha [rad] of that body from the bushing's in the sample.
//!
//! Both keep Archard's volume for every arc, of each surface, unless the scene asks for the published rule of `local_arcs.rs`. Valid for mild sliding wear with a constant K_H; wear never decreases.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988. Arc rule of the local law: the seed paper, Cui et al., China
//! Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020.
//!
//! # Wear rate
//! Wear of either kind of joint with clearance: bushing and journal, or guide and slider.
//!
//! Source:
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is linear in the work of a contact.

use super::amounts::{BoreSizes, SurfaceSizes};
use super::conformal::ConformalContacts;
use super::local_arcs::LocalArcs;
use super::{ContactHistory, NoEquilibrium, RailHistory, RailWearRate, WearLaw};
use crate::bore::Profile;
use crate::contact::Contact;
use common::scene::WearDistribution;
use std::f64::consts::TAU;

/// Wear rate of one joint under a frozen contact history.
#[derive(Debug, Clone)]
pub struct BoreWearRate {
    /// Wear coefficients K_H of bushing and journal [1/Pa].
    coefficients: [f64; 2],
    sizes: BoreSizes,
    profile: Profile,
    pub(super) contacts: FrozenContacts,
}

/// Contact samples of a history, found again on each profile, by the distribution of their pressure along the bore.
#[derive(Debug, Clone)]
pub(super) enum FrozenContacts {
    UniformOverArc(LocalArcs),
    Foundation(ConformalContacts),
}

impl BoreWearRate {
    /// Rate of a joint with these wear coefficients, width `width` [m] and this contact law.
    pub(crate) fn new(coefficients: [f64; 2], width: f64, contact: &Contact, profile: &Profile) -> Self {
        let (surface, points) = (*contact.surface(), profile.points());
        let wears = coefficients[1] > 0.0;
        BoreWearRate {
            coefficients,
            sizes: BoreSizes { points, radii: [profile.initial_radius, surface.journal_radius], width },
            profile: profile.clone(),
            contacts: match contact {
                Contact::LocalHertz(_) => {
                    FrozenContacts::UniformOverArc(LocalArcs::new(contact, points, wears))
                }
                Contact::Foundation(_) => {
                    FrozenContacts::Foundation(ConformalContacts::new(surface, points, wears))
                }
            },
        }
    }

    /// This rate with the wear of an arc under the local law distributed by another rule.
    pub(crate) fn distributed(mut self, distribution: WearDistribution) -> Self {
        match &mut self.contacts {
            FrozenContacts::UniformOverArc(arcs) => arcs.distribution = distribution,
            FrozenContacts::Foundation(_) => {}
        }
        self
    }
}

impl WearLaw for BoreWearRate {
    type History = ContactHistory;

    fn freeze(&mut self, history: &ContactHistory) {
        match &mut self.contacts {
            FrozenContacts::UniformOverArc(arcs) => arcs.freeze(&history.samples),
            FrozenContacts::Foundation(contacts) => contacts.freeze(&self.profile, &history.samples),
        }
    }

    fn release(&mut self) {
        if let FrozenContacts::UniformOverArc(arcs) = &mut self.contacts {
            arcs.release();
        }
    }

    fn sizes(&self) -> SurfaceSizes {
        SurfaceSizes::Bore(self.sizes)
    }

    /// Wear rate dh/dN at every control point of a bore worn to `depth` `(points,)` [m], followed by those of the journal if that
    /// wears: `rate` of the same length [m/cycle].
    ///
    /// # Errors
    /// [`NoEquilibrium`] if a frozen force has no equilibrium on that bore.
    fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), NoEquilibrium> {
        let BoreSizes { points, radii, width } = self.sizes;
        let (bore, of_journal) = depth.split_at(points);
        self.profile.set_depth(bore);
        let spacing = TAU / points as f64;
        let per = match &mut self.contacts {
            FrozenContacts::UniformOverArc(arcs) => {
                arcs.shares(&self.profile, of_journal, rate);
                [spacing * width; 2]
            }
            FrozenContacts::Foundation(contacts) => {
                contacts.shares(&self.profile, of_journal, rate)?;
                radii.map(|radius| spacing * radius * width)
            }
        };
        for (rate, (coefficient, per)) in rate.chunks_mut(points).zip(self.coefficients.iter().zip(per)) {
            rate.iter_mut().for_each(|r| *r *= coefficient / per);
        }
        Ok(())
    }
}

/// Contact history of a joint that wears.
#[derive(Debug, Clone, PartialEq)]
pub enum WearHistory {
    /// Of a journal in its bushing.
    Bore(ContactHistory),
    /// Of a slider in its guide.
    Rail(RailHistory),
}

/// Evaluates an expression with what is inside such an enum.
macro_rules! with_either {
    ($of:ident, $either:expr, $bound:ident => $value:expr) => {
        match $either {
            $of::Bore($bound) => $value,
            $of::Rail($bound) => $value,
        }
    };
}

impl WearHistory {
    /// The history of a journal in its bushing.
    pub(crate) fn bore(&self) -> Option<&ContactHistory> {
        match self {
            WearHistory::Bore(history) => Some(history),
            WearHistory::Rail(_) => None,
        }
    }

    /// The history of a journal in its bushing.
    pub(crate) fn bore_mut(&mut self) -> Option<&mut ContactHistory> {
        match self {
            WearHistory::Bore(history) => Some(history),
            WearHistory::Rail(_) => None,
        }
    }

    /// The history of a slider in its guide.
    pub(crate) fn rail_mut(&mut self) -> Option<&mut RailHistory> {
        match self {
            WearHistory::Bore(_) => None,
            WearHistory::Rail(history) => Some(history),
        }
    }

    /// Removes all samples, for a new cycle.
    pub(crate) fn clear(&mut self) {
        with_either!(WearHistory, self, history => history.clear());
    }

    /// Ends the current interval; to be called at the end of the cycle.
    pub(crate) fn close_interval(&mut self) {
        with_either!(WearHistory, self, history => history.close_interval());
    }

    /// Appends the samples of a further cycle of the same joint.
    pub(crate) fn append(&mut self, further: &WearHistory) {
        match (self, further) {
            (WearHistory::Bore(own), WearHistory::Bore(further)) => {
                own.samples.extend_from_slice(&further.samples)
            }
            (WearHistory::Rail(own), WearHistory::Rail(further)) => {
                own.samples.extend_from_slice(&further.samples)
            }
            _ => debug_assert!(false, "histories of two joints"),
        }
    }

    /// Turns the history of several cycles into that of their mean: the same contacts, each with its share of the work.
    pub(crate) fn divide_work(&mut self, cycles: usize) {
        match self {
            WearHistory::Bore(history) => {
                history.samples.iter_mut().for_each(|sample| sample.work /= cycles as f64);
            }
            WearHistory::Rail(_) => self.scale_work(1.0 / cycles as f64),
        }
    }

    /// Multiplies the work of every contact by `factor` [1].
    pub(crate) fn scale_work(&mut self, factor: f64) {
        with_either!(WearHistory, self, history => history.samples.iter_mut().for_each(|sample| sample.work *= factor));
    }

    /// Work of all contacts [N m].
    pub(crate) fn work(&self) -> f64 {
        with_either!(WearHistory, self, history => history.samples.iter().map(|sample| sample.work).sum())
    }
}

/// Wear rate of a joint under a frozen contact history.
#[derive(Debug, Clone)]
pub enum WearRate {
    /// Of bushing and journal.
    Bore(Box<BoreWearRate>),
    /// Of guide and slider.
    Rail(Box<RailWearRate>),
}

impl WearLaw for WearRate {
    type History = WearHistory;

    fn freeze(&mut self, history: &WearHistory) {
        match (self, history) {
            (WearRate::Bore(rate), WearHistory::Bore(history)) => rate.freeze(history),
            (WearRate::Rail(rate), WearHistory::Rail(history)) => rate.freeze(history),
            _ => debug_assert!(false, "history of another joint"),
        }
    }

    fn release(&mut self) {
        with_either!(WearRate, self, rate => rate.release());
    }

    fn sizes(&self) -> SurfaceSizes {
        with_either!(WearRate, self, rate => rate.sizes())
    }

    fn rate(&mut self, depth: &[f64], rates: &mut [f64]) -> Result<(), NoEquilibrium> {
        with_either!(WearRate, self, rate => rate.rate(depth, rates))
    }
}
