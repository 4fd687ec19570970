//! Archard's law over one cycle: wear rate of every control point of a bore under a frozen contact history.
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
//! Both keep Archard's volume for every arc. Valid for mild sliding wear with a constant K_H; only the bushing
//! wears, and wear never decreases.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988. Arc rule of the local law: the seed paper, Cui et al., China
//! Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020.

use super::conformal::ConformalContacts;
use super::equilibrium::NoEquilibrium;
use super::history::ContactHistory;
use super::local_arcs::LocalArcs;
use crate::bore::Profile;
use crate::contact::{Contact, Pressure};
use std::f64::consts::TAU;

/// Wear rate of one joint under a frozen contact history.
#[derive(Debug, Clone)]
pub struct WearRate {
    /// Wear coefficient K_H [1/Pa].
    coefficient: f64,
    /// Width L [m].
    width: f64,
    profile: Profile,
    contacts: FrozenContacts,
}

/// Contact samples of a history, found again on each profile, by the distribution of their pressure.
#[derive(Debug, Clone)]
enum FrozenContacts {
    UniformOverArc(LocalArcs),
    Foundation(ConformalContacts),
}

impl WearRate {
    /// Rate of a joint with wear coefficient `coefficient` [1/Pa], width `width` [m] and this contact law.
    pub(crate) fn new(coefficient: f64, width: f64, contact: &Contact, profile: &Profile) -> Self {
        let (surface, points) = (*contact.surface(), profile.points());
        WearRate {
            coefficient,
            width,
            profile: profile.clone(),
            contacts: match contact.pressure() {
                Pressure::UniformOverArc => {
                    FrozenContacts::UniformOverArc(LocalArcs::new(surface.journal_radius, points))
                }
                Pressure::Foundation => FrozenContacts::Foundation(ConformalContacts::new(surface, points)),
            },
        }
    }

    /// Replaces the frozen history by that of the cycle just simulated.
    pub(crate) fn freeze(&mut self, history: &ContactHistory) {
        match &mut self.contacts {
            FrozenContacts::UniformOverArc(arcs) => arcs.freeze(history.samples()),
            FrozenContacts::Foundation(contacts) => contacts.freeze(&self.profile, history.samples()),
        }
    }

    /// Evaluations of the foundation so far; zero under a law without one.
    #[cfg(test)]
    pub(crate) fn evaluations(&self) -> u64 {
        match &self.contacts {
            FrozenContacts::UniformOverArc(_) => 0,
            FrozenContacts::Foundation(contacts) => contacts.evaluations(),
        }
    }

    /// Wear rate dh/dN at every control point of a bore worn to `depth` `(points,)` [m]: `rate` `(points,)`
    /// [m/cycle].
    ///
    /// # Errors
    /// [`NoEquilibrium`] if a frozen force has no equilibrium on that bore.
    pub(crate) fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), NoEquilibrium> {
        self.profile.set_depth(depth);
        let spacing = TAU / rate.len() as f64;
        let per = match &mut self.contacts {
            FrozenContacts::UniformOverArc(arcs) => {
                arcs.shares(&self.profile, rate);
                spacing * self.width
            }
            FrozenContacts::Foundation(contacts) => {
                contacts.shares(&self.profile, rate)?;
                spacing * self.profile.initial_radius() * self.width
            }
        };
        rate.iter_mut().for_each(|r| *r *= self.coefficient / per);
        Ok(())
    }
}
