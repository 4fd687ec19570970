//! Units of a scene's outputs: the suffix of a key in JSON and CSV files, and the unit on axes and in text. Inside the
//! program every output is in SI units.

use super::quantity::*;
use serde::{Deserialize, Serialize};

/// Physical dimension of an output, with its units in files and in text.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OutputUnit {
    /// A length: `m` in files, `µm` in text.
    Length,
    /// A volume: `m3` in files, `mm³` in text.
    Volume,
    /// An angular velocity: `rpm` in files, `r/min` in text.
    AngularVelocity,
    /// An angle: `deg` in files and in text.
    Angle,
    /// A force: `N` in files and in text.
    Force,
    /// A torque: `Nm` in files, `N m` in text.
    Torque,
    /// An acceleration: `m/s^2` in files and in text.
    Acceleration,
    /// An angular acceleration: `rad/s^2` in files and in text.
    AngularAcceleration,
    /// An energy: `J` in files, `mJ` in text.
    Energy,
    /// A number without a unit.
    Number,
    /// An output of an external simulator, with the unit that the scene states (may be empty).
    External(String),
    /// One of the others, shown in a unit that the scene chooses.
    Shown {
        /// The unit without that choice.
        usual: Box<OutputUnit>,
        /// How the scene writes the chosen one, e.g. `mil`.
        symbol: String,
        /// Size of the chosen one in SI.
        si: f64,
    },
}

/// A unit that a scene chooses for what people read.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShownUnit {
    /// How the scene writes it, e.g. `mil`.
    pub symbol: String,
    /// Size of the unit in SI.
    pub si: f64,
}

/// Angular velocity of one revolution per minute [rad/s].
const RAD_PER_S_PER_RPM: f64 = std::f64::consts::PI / 30.0;

impl OutputUnit {
    /// Key of a value in result files: its name and unit, e.g. `max_wear_depth_m` or `jolt_m_per_s2`; the name alone without a unit.
    pub fn key(&self, name: &str) -> String {
        let unit = match self {
            Self::Acceleration => "m_per_s2",
            Self::AngularAcceleration => "rad_per_s2",
            Self::Shown { usual, .. } => return usual.key(name),
            other => other.suffix(),
        };
        match unit {
            "" => name.to_owned(),
            suffix => format!("{name}_{}", suffix.replace(' ', "")),
        }
    }

    /// Unit in result files, unit in text with the number of them in one of the files, and kind of the quantities.
    fn row(&self) -> (&str, &str, f64, Kind) {
        match self {
            Self::Length => ("m", "µm", 1e6, LENGTH),
            Self::Volume => ("m3", "mm³", 1e9, VOLUME),
            Self::AngularVelocity => ("rpm", "r/min", 1.0, ANGULAR_VELOCITY),
            Self::Angle => ("deg", "deg", 1.0, ANGLE),
            Self::Force => ("N", "N", 1.0, FORCE),
            Self::Torque => ("Nm", "N m", 1.0, TORQUE),
            Self::Acceleration => ("m/s^2", "m/s^2", 1.0, ACCELERATION),
            Self::AngularAcceleration => ("rad/s^2", "rad/s^2", 1.0, ANGULAR_ACCELERATION),
            Self::Energy => ("J", "mJ", 1e3, ENERGY),
            Self::Number => ("", "", 1.0, NUMBER),
            Self::External(unit) => (unit, unit, 1.0, NUMBER),
            Self::Shown { usual, symbol, .. } => (usual.suffix(), symbol, 1.0, usual.kind()),
        }
    }

    /// Unit of values in result files.
    pub fn suffix(&self) -> &str {
        self.row().0
    }

    /// An SI value in the unit of [`Self::suffix`].
    pub fn to_file(&self, si: f64) -> f64 {
        match self {
            Self::AngularVelocity => si / RAD_PER_S_PER_RPM,
            Self::Angle => si.to_degrees(),
            Self::Shown { usual, .. } => usual.to_file(si),
            _ => si,
        }
    }

    /// Kind of the quantities with this unit, as a scene or a person states them; those of an external simulator are plain numbers.
    pub fn kind(&self) -> Kind {
        self.row().3
    }

    /// Name of the unit on axes and in sentences.
    pub fn symbol(&self) -> &str {
        self.row().1
    }

    /// An SI value in the unit of [`Self::symbol`].
    pub fn to_shown(&self, si: f64) -> f64 {
        match self {
            Self::Shown { si: one, .. } => si / one,
            usual => usual.to_file(si) * usual.row().2,
        }
    }

    /// This unit, with values converted to a chosen one where people read them.
    pub(super) fn shown_in(self, unit: &ShownUnit) -> Self {
        Self::Shown { usual: Box::new(self), symbol: unit.symbol.clone(), si: unit.si }
    }

    /// A number as shown, with its unit, e.g. `30 µm`.
    pub fn after(&self, number: &str) -> String {
        format!("{number} {}", self.symbol()).trim_end().to_owned()
    }

    /// The label of an axis: a quantity with its unit, e.g. `max wear depth [µm]`.
    pub fn axis(&self, what: &str) -> String {
        if self.symbol().is_empty() { what.to_owned() } else { format!("{what} [{}]", self.symbol()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_per_second_is_sixty_a_minute() {
        let unit = OutputUnit::AngularVelocity;
        assert!((unit.to_file(2.0 * std::f64::consts::PI) - 60.0).abs() < 1e-12);
    }

    #[test]
    fn lengths_are_metres_in_files_and_micrometres_in_texts() {
        assert_eq!(OutputUnit::Length.key("depth"), "depth_m");
        assert_eq!(OutputUnit::Length.to_file(3e-5), 3e-5);
        assert!((OutputUnit::Length.to_shown(3e-5) - 30.0).abs() < 1e-12);
    }

    #[test]
    fn units_of_rates_have_keys_without_signs() {
        let keys = [OutputUnit::Acceleration, OutputUnit::AngularAcceleration, OutputUnit::Number]
            .map(|u| u.key("a"));
        assert_eq!(keys, ["a_m_per_s2", "a_rad_per_s2", "a"]);
        assert_eq!(OutputUnit::Energy.after("2"), "2 mJ");
        assert_eq!((OutputUnit::Energy.to_file(2e-3), OutputUnit::Energy.to_shown(2e-3)), (2e-3, 2.0));
    }

    #[test]
    fn volumes_are_cubic_metres_in_files_and_cubic_millimetres_in_texts() {
        assert_eq!(OutputUnit::Volume.key("worn"), "worn_m3");
        assert_eq!(OutputUnit::Volume.to_file(2e-9), 2e-9);
        assert!((OutputUnit::Volume.to_shown(2e-9) - 2.0).abs() < 1e-12);
        assert_eq!(OutputUnit::Volume.after("2"), "2 mm³");
    }

    #[test]
    fn the_unit_of_a_simulator_is_only_shown() {
        let (named, none) = (OutputUnit::External("N m".into()), OutputUnit::External(String::new()));
        assert_eq!((named.to_file(2.5), named.to_shown(2.5)), (2.5, 2.5));
        assert_eq!(
            [named.key("moment"), named.after("2.5"), named.axis("moment")],
            ["moment_Nm", "2.5 N m", "moment [N m]"]
        );
        assert_eq!([none.key("g"), none.after("2.5"), none.axis("g")], ["g", "2.5", "g"]);
    }
}
