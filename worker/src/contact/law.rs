//! What one contact law defines; everything else is shared by all laws.

use super::joint_force::JointMotion;
use super::journal::Surfaces;
use super::surface::Surface;
use crate::bore::Profile;

/// A contact law of one joint. Each law implements it in its own file.
pub(super) trait Law {
    /// The law on an unworn bore with `control_points` control points.
    fn new(surface: Surface, control_points: usize) -> Self;

    /// Constants of the joint.
    fn surface(&self) -> &Surface;

    /// Constants of the joint, to be changed.
    fn surface_mut(&mut self) -> &mut Surface;

    /// Adopts a changed profile; no effect for laws that read the profile directly.
    fn profile_changed(&mut self, _profile: &Profile) {}

    /// Distribution of the contact pressure, which decides where the bore wears.
    fn pressure(&self) -> Pressure;

    /// Energy, force and rate of the elastic part of the contact; all zero in free flight.
    fn elastic(&self, surfaces: Surfaces, motion: &JointMotion) -> Elastic;
}

/// Distribution of the contact pressure along the bore, for wear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pressure {
    /// Uniform along the contact arc AB between journal circle and bore.
    UniformOverArc,
    /// That of an elastic foundation.
    Foundation,
}

/// The elastic part of a contact; all zero in free flight.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Elastic {
    /// Stored energy [J].
    pub stored: f64,
    /// Force F_el [N].
    pub force: f64,
    /// delta_dot: the rate of the stored energy is force times this [m/s].
    pub rate: f64,
}
