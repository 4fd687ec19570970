//! `[units]` of a scene: the units in which its quantities are shown in reports and on the terminal. Files are in SI units.
//!
//! The schema of scenes and the page about their language follow from [`Units::KEYS`].

use super::context::{is_number_with_unit, number_and_unit, read_quantity};
use super::expression::read_unit;
use super::output::{LimitState, Output, OutputKind};
use super::output_unit::{OutputUnit, ShownUnit};
use super::quantity::*;
use super::section::Section;
use serde::Serialize;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// Reads the unit of a kind of quantities at this key; the outer `None` if it is faulty.
fn read_shown(section: &mut Section, key: &'static str, kind: Kind) -> Option<Option<ShownUnit>> {
    section.if_any(key, |section, key| {
        let symbol = section.text(key, &format!("the unit of {}", kind.in_words()))?;
        let read = read_quantity(&format!("1 {symbol}"), kind);
        let si = read.map_err(|fault| section.fault(key, fault)).ok()?;
        Some(ShownUnit { symbol: symbol.to_owned(), si })
    })
}

/// The unit in which a limit is written, if it is a number with one.
fn of_limit(limit: &str) -> Option<ShownUnit> {
    let (_, symbol) = number_and_unit(limit).filter(|_| is_number_with_unit(limit))?;
    let unit = read_unit(symbol).ok().filter(|_| !symbol.is_empty())?;
    Some(ShownUnit { symbol: symbol.to_owned(), si: unit.multiply / unit.divide })
}

/// The units that a scene chooses.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Units {
    /// Chosen units by the usual unit that each replaces.
    by_usual: BTreeMap<&'static str, ShownUnit>,
    /// Of single outputs, by their names.
    by_output: BTreeMap<String, ShownUnit>,
}

impl Units {
    /// Its keys, each with the unit that is usual and what it is the unit of.
    pub const KEYS: &'static [(&'static str, &'static str, Kind, &'static str)] = &[
        ("length", "mm", LENGTH, "Positions and sizes."),
        ("depth", "µm", LENGTH, "Depths of wear, clearances and outputs that are lengths."),
        ("speed", "mm/s", SPEED, "Speeds."),
        ("angle", "deg", ANGLE, "Angles of the scene and outputs that are angles."),
        ("angular_velocity", "r/min", ANGULAR_VELOCITY, "Angular velocities."),
        ("acceleration", "m/s^2", ACCELERATION, "Accelerations."),
        ("angular_acceleration", "rad/s^2", ANGULAR_ACCELERATION, "Angular accelerations."),
        ("mass", "g", MASS, "Masses."),
        ("inertia", "kg m^2", INERTIA, "Moments of inertia."),
        ("force", "N", FORCE, "Forces."),
        ("torque", "N m", TORQUE, "Torques."),
        ("energy", "mJ", ENERGY, "Energies."),
        ("volume", "mm³", VOLUME, "Worn volumes."),
        ("pressure", "GPa", PRESSURE, "Elastic moduli."),
    ];

    /// Reads `[units]`; none if it is faulty.
    pub(super) fn read(file: &mut Section) -> Option<Self> {
        if file.get("units").is_none() {
            return Some(Self::default());
        }
        let mut section = file.section_if_any("units")?;
        let read: Vec<_> = Self::KEYS
            .iter()
            .map(|(key, usual, kind, _)| Some((*usual, read_shown(&mut section, key, *kind)?)))
            .collect();
        section.finish();
        let all: Option<Vec<_>> = read.into_iter().collect();
        let si =
            |usual: &str| read_unit(&usual.replace('³', "^3")).map(|unit| unit.multiply / unit.divide).ok();
        // The usual unit needs no choice.
        let chosen =
            |usual: &str, unit: &ShownUnit| si(usual).is_none_or(|si| (unit.si / si - 1.0).abs() > 1e-12);
        let stated = all?.into_iter().filter_map(|(usual, unit)| Some((usual, unit?)));
        let stated = stated.filter(|(usual, unit)| chosen(usual, unit));
        Some(Self { by_usual: stated.collect(), ..Self::default() })
    }

    /// True if every quantity is shown in its usual unit.
    pub fn are_usual(&self) -> bool {
        self.by_usual.is_empty() && self.by_output.is_empty()
    }

    /// An output without a unit in `[units]` is shown in the unit in which the first of its limits is written in `document`.
    pub(super) fn add_limits(&mut self, outputs: &[Output], states: &[LimitState], document: &Table) {
        let rows = document.get("limit_states").and_then(Value::as_array).into_iter().flatten();
        for (state, row) in states.iter().zip(rows) {
            let output = &outputs[state.output];
            let usual = output.kind.unit();
            let limit = ["threshold", "upper"].iter().find_map(|key| row.get(key)?.as_str());
            let is_fixed =
                matches!(output.kind, OutputKind::External { .. }) || self.shown(usual.symbol()).is_some();
            let Some(unit) = limit.and_then(of_limit).filter(|_| !is_fixed) else { continue };
            // The same size by another name, as `um`, is shown as usual.
            if (usual.to_shown(unit.si) - 1.0).abs() > 1e-12 {
                self.by_output.entry(output.name.clone()).or_insert(unit);
            }
        }
    }

    fn shown(&self, usual: &str) -> Option<&ShownUnit> {
        self.by_usual.get(if usual == "um" { "µm" } else { usual })
    }

    /// Symbol of the chosen unit of a kind of quantities; of lengths that of positions and sizes before that of depths.
    pub(super) fn of_kind(&self, kind: Kind) -> Option<&str> {
        let mut usual = Self::KEYS.iter().filter(|(_, _, other, _)| other.name == kind.name);
        usual.find_map(|(_, usual, ..)| Some(&*self.by_usual.get(usual)?.symbol))
    }

    /// Symbol of the unit in which quantities with this usual unit are shown.
    pub fn symbol<'u>(&'u self, usual: &'u str) -> &'u str {
        self.shown(usual).map_or(usual, |unit| &unit.symbol)
    }

    /// A quantity [SI] with this number of decimals of its usual unit, or with six digits of the chosen unit.
    pub fn text(&self, si: f64, usual: &str, decimals: usize) -> String {
        match self.shown(usual) {
            Some(unit) => {
                let rounded: Result<f64, _> = format!("{:.5e}", si / unit.si).parse();
                format!("{} {}", rounded.unwrap_or(f64::NAN), unit.symbol)
            }
            None => {
                let unit = read_unit(usual).map_or(1.0, |unit| unit.multiply / unit.divide);
                format!("{:.decimals$} {usual}", si / unit)
            }
        }
    }

    /// Unit in which an output is shown.
    pub(super) fn of_output(&self, output: &Output) -> OutputUnit {
        let usual = output.kind.unit();
        match self.by_output.get(&output.name) {
            Some(unit) => usual.shown_in(unit),
            None => self.of(usual),
        }
    }

    /// The unit in which outputs with this usual unit are shown.
    pub fn of(&self, usual: OutputUnit) -> OutputUnit {
        match self.shown(usual.symbol()) {
            Some(unit) => usual.shown_in(unit),
            None => usual,
        }
    }

    /// The head of a column, with the chosen unit in the place of the usual one in its brackets.
    pub fn head(&self, head: &str) -> String {
        let replace = |head: String, (usual, unit): (&&str, &ShownUnit)| {
            head.replace(&format!("[{usual}]"), &format!("[{}]", unit.symbol))
        };
        self.by_usual.iter().fold(head.to_owned(), replace)
    }
}
