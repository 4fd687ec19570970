//! Impacts in joints with clearance over a cycle: their number, and their energy.
//!
//! An impact is the beginning of a contact after free flight: the penetration delta [m] is positive at the end of a time step and was
//! not at the end of the step before. Its energy [J] is the kinetic energy of the approach,
//!
//!   E = m_eff v_n^2 / 2,
//!
//! with the speed of approach v_n [m/s] along the contact's normal at the end of free flight, and the mass m_eff [kg] with which the
//! mechanism resists an impulse along that normal (`Island::effective_mass`). It is what a plastic impact without friction dissipates;
//! with a coefficient of restitution e, (1 - e^2) E is lost. Contacts that last through the cycle have no impacts.
//!
//! In a guide with clearance every corner of the slider that begins to touch is an impact, with its own speed of approach and effective mass
//! (`guide_corner.rs`); both corners of a face within one time step are one impact, with the means of both.
//!
//! # Source
//! Lankarani, Nikravesh (1990), A contact force model with hysteresis damping for impact analysis of multibody systems, Journal of
//! Mechanical Design 112, 369-376: energy of the approach and loss (1 - e^2). Transition from free flight to contact: Flores, Ambrosio,
//! Claro, Lankarani (2008), Kinematics and Dynamics of Multibody Systems with Imperfect Joints, chapter 3.

use super::{MotionOutput, RecordedCycle, RecordingRequest, Sampling};
use common::scene::ImpactMeasure;

/// The output `impacts` [1].
pub struct Impacts<'a> {
    /// Joints of the scene.
    pub joints: &'a [usize],
}

impl MotionOutput for Impacts<'_> {
    fn request(&self, request: &mut RecordingRequest) {
        request.impacts = true;
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        let counts = self.joints.iter().filter_map(|&joint| cycle.impacts(joint));
        counts.map(|count| f64::from(count.number)).sum()
    }

    fn sampling(&self) -> Sampling {
        Sampling::Events
    }
}

/// The output `impact-energy` [J].
pub struct ImpactEnergy<'a> {
    /// Joints of the scene.
    pub joints: &'a [usize],
    /// All impacts of the cycle, or the hardest one.
    pub measure: ImpactMeasure,
}

impl MotionOutput for ImpactEnergy<'_> {
    fn request(&self, request: &mut RecordingRequest) {
        request.impacts = true;
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        let counts = self.joints.iter().filter_map(|&joint| cycle.impacts(joint));
        match self.measure {
            ImpactMeasure::Total => counts.map(|count| count.energy).sum(),
            ImpactMeasure::Largest => counts.map(|count| count.hardest).fold(0.0, f64::max),
        }
    }

    fn sampling(&self) -> Sampling {
        Sampling::Events
    }
}
