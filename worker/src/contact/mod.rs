//! Forces in one joint with clearance, as pure functions of the motion of that joint.
//!
//! All vectors are in the bushing's frame: e = r_journal - r_bushing, w = velocity of the journal's centre
//! minus that of the bushing's centre (both turned into the bushing's frame, not differentiated in it),
//! omega_i of the journal's body, omega_j of the bushing's. The force returned acts on the journal at its
//! centre; the opposite force acts on the bushing at its centre; friction adds the torques.
//!
//! Each law has a file, which defines its elastic force F_el [N], its penetration delta [m] and the rate of
//! that, delta_dot [m/s]; [`Contact`] lists the laws. All laws share
//! - the normal force F_N = F_el max(0, 1 + D delta_dot), damping factor D [s/m]; zero in free flight (delta
//!   <= 0);
//! - the friction force F_T = mu F_N tanh(v_t / v_0), friction coefficient mu [1], sliding speed v_t [m/s] of
//!   the journal's surface over the bushing's, regularisation speed v_0 [m/s];
//! - the film force -c_f w through the centres, film damping c_f [N s/m], in contact and in free flight.
//!
//! Which source computes the force (`law_lanes.rs`), for one island by itself (lanes of one number) and for several in SIMD lanes alike:
//!
//! | law, journal | force | integrals over the arc |
//! |---|---|---|
//! | `local-hertz` | `local_hertz.rs` | none: the profile in the direction of the eccentricity |
//! | `foundation`, round | `foundation.rs` | `arc_cells.rs`; lane by lane where a cell holds too many intervals, in free flight and for energies: `arc.rs` |
//! | `foundation`, worn | `foundation.rs` | `rotated_cells.rs`, `rotated_segment.rs`; likewise `rotated_arc.rs` |
//!
//! Wear finds the contacts again on the worn surfaces: `wear/local_arcs.rs` for `local-hertz`, `wear/conformal.rs` for `foundation`, with the
//! integrals of `arc.rs` and `rotated_arc.rs`.
//!
//! Valid for penetrations up to a tenth of the journal radius (`Surface::deepest`). Below about v_0
//! friction is viscous: the model has no state of sticking.
//!
//! # Source
//! Normal force: Hunt, Crossley (1975), J. Appl. Mech. 42, 440-445. Friction: Coulomb's law regularised as by
//! Andersson, Soderberg, Bjorklund (2007), Tribology International 40, 580-587.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

mod arc;
mod arc_cells;
mod arc_visitor;
mod cells;
mod energy;
mod foundation;
mod free_region;
mod integrals;
mod journal_table;
mod law_lanes;
mod local_hertz;
mod modulus;
mod pad;
mod rotated_arc;
mod rotated_cells;
mod rotated_segment;
mod segment;
mod surface;
#[cfg(test)]
mod tests;

pub(crate) use arc::Arc;
pub(crate) use arc_visitor::ArcVisitor;
pub use foundation::Foundation;
pub(crate) use foundation::{FoundationLoad, FoundationWithJournal};
pub(crate) use free_region::FreeRegion;
pub use journal_table::{Journal, Surfaces};
pub use law_lanes::LawLanes;
pub use local_hertz::{LocalHertz, PolarEccentricity, Walls};
pub use pad::{GuideReaction, PADS};
pub(crate) use pad::{PadForce, foundation, pad_force};
pub(crate) use rotated_arc::SegmentParts;
pub use surface::{ForceSlopes, JointForce, JointMotion, Restitution, Surface, hertz_stiffness};
pub(crate) use surface::{coulomb, equivalent_penetration, initial_damping};

use crate::bore::Profile;
use common::scene::{Clearance, ContactLaw};

/// The contact law of one joint.
#[derive(Debug, Clone, PartialEq)]
pub enum Contact {
    /// The law that a scene calls [`ContactLaw::LocalHertz`].
    LocalHertz(LocalHertz),
    /// The law that a scene calls [`ContactLaw::Foundation`].
    Foundation(Foundation),
}

impl Contact {
    /// The contact law of a checked joint, on an unworn bore.
    pub fn new(joint: &Clearance) -> Self {
        let surface = Surface::new(joint);
        match joint.contact_law {
            ContactLaw::LocalHertz => Contact::LocalHertz(LocalHertz { surface }),
            ContactLaw::Foundation => {
                Contact::Foundation(Foundation::new(surface, joint.control_points.number()))
            }
        }
    }

    /// This law in its joint, on an unworn bore with `control_points` control points.
    pub(crate) fn with_points(&self, control_points: usize) -> Self {
        match self {
            Contact::LocalHertz(law) => Contact::LocalHertz(*law),
            Contact::Foundation(law) => Contact::Foundation(Foundation::new(law.surface, control_points)),
        }
    }

    /// Constants of the joint.
    pub fn surface(&self) -> &Surface {
        match self {
            Contact::LocalHertz(law) => &law.surface,
            Contact::Foundation(law) => &law.surface,
        }
    }

    /// Adopts a changed profile of the bore; the local law reads the profile directly.
    pub fn profile_changed(&mut self, profile: &Profile) {
        if let Contact::Foundation(law) = self {
            law.profile_changed(profile);
        }
    }

    /// An unworn journal with `points` control points in a joint with this law.
    pub fn new_journal(&self, points: usize) -> Journal {
        match self {
            Contact::LocalHertz(law) => Journal::new(law.surface.journal_radius, points, None),
            Contact::Foundation(law) => law.new_journal(points),
        }
    }

    /// Replaces the damping factor [s/m], as fixed at the last impact.
    pub(crate) fn set_damping(&mut self, damping: f64) {
        match self {
            Contact::LocalHertz(law) => law.surface.damping = damping,
            Contact::Foundation(law) => law.surface.damping = damping,
        }
    }
}
