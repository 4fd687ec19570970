//! Reads guides with clearance: slider, guide, contact damping, friction, wear.

use super::clearance::{
    FRICTION, MaterialRow, contact_damping, control_points, material, second_coefficient,
};
use super::context::Range;
use super::faults::in_first_unit;
use super::joint::{GuideClearance, GuideWear, WearingSurfaces};
use super::quantity::*;
use super::record::record;
use super::section::Section;

/// Keys of the wear of a hinge that a guide does not have, and why.
const KEYS_OF_HINGES: [(&str, &str); 3] = [
    ("wear", "a guide wears where it has wears = \"guide\", \"slider\" or \"both\": leave this key out"),
    ("journal_wear_coefficient", "the second surface of a guide is its slider: see slider_wear_coefficient"),
    ("wall", "a guide is not worn through, as nothing behind its faces is modelled: leave this key out"),
];

/// Reads the fields of a guide with clearance.
pub(super) fn guide(row: &mut Section, materials: &[MaterialRow]) -> Option<GuideClearance> {
    let read = record!(GuideClearance {
        axis: row.quantity_or("axis", ANGLE, Range::Any, 0.0),
        angle: row.quantity_or("angle", ANGLE, Range::Any, 0.0),
        length: row.quantity("length", LENGTH, Range::Positive),
        height: row.quantity("height", LENGTH, Range::Positive),
        width: row.quantity("width", LENGTH, Range::Positive),
        clearance: clearance(row, height),
        reach: reach(row, length),
        slider_material: material(row, "slider_material", materials),
        guide_material: material(row, "guide_material", materials),
        contact_damping: contact_damping(row),
        friction: row.quantity("friction", NUMBER, FRICTION),
        friction_speed: row.quantity("friction_speed", SPEED, Range::Positive),
        wear: wear(row),
    });
    for (key, reason) in KEYS_OF_HINGES {
        // Known only where it is given, so that no message offers it.
        if row.peek(key).is_some() && row.get(key).is_some() {
            row.inconsistent(key, reason);
        }
    }
    read
}

/// Reads the wear of guide and slider; outer none if it is faulty, inner none without the key wears.
fn wear(row: &mut Section) -> Option<Option<GuideWear>> {
    let words = WearingSurfaces::ALL.map(|surfaces| (surfaces.guide_name(), surfaces));
    let given = ["wear_coefficient", "slider_wear_coefficient", "control_points"].map(|key| row.get(key));
    if row.get("wears").is_none() {
        let keys = ["wear_coefficient", "slider_wear_coefficient", "control_points"];
        let mut faulty = false;
        for (key, _) in keys.into_iter().zip(given).filter(|(_, given)| given.is_some()) {
            row.inconsistent(
                key,
                "needs wears = \"guide\", \"slider\" or \"both\": without it a guide does not wear",
            );
            faulty = true;
        }
        return if faulty { None } else { Some(None) };
    }
    let wear = record!(GuideWear {
        wears: row.choice("wears", "guide, slider or both", &words),
        coefficient: row.quantity("wear_coefficient", INVERSE_PRESSURE, Range::NonNegative),
        slider_coefficient: second_coefficient(row, "slider_wear_coefficient", wears),
        control_points: control_points(row),
    });
    wear.map(Some)
}

/// The clearance on each side, which is below the slider's height.
fn clearance(row: &mut Section, height: Option<f64>) -> Option<f64> {
    let clearance = row.quantity("clearance", LENGTH, Range::Positive)?;
    let (written, height) = (row.get("clearance")?, height?);
    if clearance < height {
        return Some(clearance);
    }
    let value = row.shown("clearance", written, clearance, LENGTH);
    row.out_of_range("clearance", value, format!("smaller than height = {}", in_first_unit(height, LENGTH)));
    None
}

/// The ends of the guide, between which there is room for the slider.
fn reach(row: &mut Section, length: Option<f64>) -> Option<[f64; 2]> {
    let start = row.quantity("guide_start", LENGTH, Range::Any);
    let end = row.quantity("guide_end", LENGTH, Range::Any);
    let (start, end, length) = (start?, end?, length?);
    if end - start > length {
        return Some([start, end]);
    }
    let least = in_first_unit(length, LENGTH);
    row.inconsistent("guide_end", format!("leaves no room for the slider, whose length is {least}"));
    None
}
