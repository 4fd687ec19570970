//! In which unit a person meets the outputs of a scene: the suffix of a key in JSON and CSV files, and the unit
//! written on an axis. Inside the program every output stays in SI.

use common::scene::OutputKind;
use serde::{Deserialize, Serialize};

/// Physical dimension of an output, with the two units it is shown in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutputUnit {
    /// A length: `m` in files, micrometres on paper.
    Length,
    /// An angular velocity, rad/s inside: `rpm` in files, r/min on paper.
    AngularVelocity,
    /// An angle, rad inside: `deg` in files and on paper.
    Angle,
    /// A force: `N`.
    Force,
    /// A torque: `N m` on paper, `Nm` in files.
    Torque,
}

/// rad/s per r/min.
const RAD_PER_S_PER_RPM: f64 = std::f64::consts::PI / 30.0;

impl OutputUnit {
    /// The unit of this kind of output.
    pub fn of(kind: &OutputKind) -> Self {
        match kind {
            OutputKind::LargestWear { .. } | OutputKind::PositionError { .. } => Self::Length,
            OutputKind::AngularVelocityDifference { .. } => Self::AngularVelocity,
            OutputKind::AngleDifference { .. } => Self::Angle,
            OutputKind::PeakJointForce { .. } => Self::Force,
            OutputKind::DrivingTorque { .. } => Self::Torque,
        }
    }

    /// Suffix of keys in result files, e.g. `max_wear_depth_m`.
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::AngularVelocity => "rpm",
            Self::Angle => "deg",
            Self::Force => "N",
            Self::Torque => "Nm",
        }
    }

    /// An SI value in the unit of [`Self::suffix`].
    pub fn to_file(self, si: f64) -> f64 {
        match self {
            Self::Length | Self::Force | Self::Torque => si,
            Self::AngularVelocity => si / RAD_PER_S_PER_RPM,
            Self::Angle => si.to_degrees(),
        }
    }

    /// Name of the unit on axes and in sentences.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Length => "µm",
            Self::AngularVelocity => "r/min",
            Self::Angle => "deg",
            Self::Force => "N",
            Self::Torque => "N m",
        }
    }

    /// An SI value in the unit of [`Self::symbol`].
    pub fn to_shown(self, si: f64) -> f64 {
        match self {
            Self::Length => si * 1e6,
            other => other.to_file(si),
        }
    }

    /// A value in the unit of [`Self::suffix`], as found in a result file, in the unit of [`Self::symbol`].
    pub fn file_to_shown(self, value: f64) -> f64 {
        match self {
            Self::Length => value * 1e6,
            _ => value,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_per_second_is_sixty_a_minute() {
        let unit = OutputUnit::AngularVelocity;
        assert!((unit.to_file(2.0 * std::f64::consts::PI) - 60.0).abs() < 1e-12);
        assert_eq!(unit.file_to_shown(60.0), 60.0);
    }

    #[test]
    fn lengths_are_metres_in_files_and_micrometres_on_paper() {
        assert_eq!(OutputUnit::Length.to_file(3e-5), 3e-5);
        assert!((OutputUnit::Length.to_shown(3e-5) - 30.0).abs() < 1e-12);
    }
}
