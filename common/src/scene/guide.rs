//! Reads guides with clearance: slider, guide, contact damping, friction, wear.

use super::clearance::{MaterialRow, contact_damping, control_points, material};
use super::context::Range;
use super::faults::in_first_unit;
use super::joint::{GuideClearance, GuideWear, WearingSurfaces};
use super::quantity::*;
use super::section::Section;

/// Keys of the wear of a hinge that a guide does not have, and why.
const KEYS_OF_HINGES: [(&str, &str); 3] = [
    ("wear", "a guide wears where it has wears = \"guide\", \"slider\" or \"both\": leave this key out"),
    ("journal_wear_coefficient", "the second surface of a guide is its slider: see slider_wear_coefficient"),
    ("wall", "a guide is not worn through, as nothing behind its faces is modelled: leave this key out"),
];

/// Reads the fields of a guide with clearance.
pub(super) fn guide(row: &mut Section, materials: &[MaterialRow]) -> Option<GuideClearance> {
    let axis = row.quantity_or("axis", ANGLE, Range::Any, 0.0);
    let angle = row.quantity_or("angle", ANGLE, Range::Any, 0.0);
    let length = row.quantity("length", LENGTH, Range::Positive);
    let height = row.quantity("height", LENGTH, Range::Positive);
    let width = row.quantity("width", LENGTH, Range::Positive);
    let clearance = clearance(row, height);
    let reach = reach(row, length);
    let slider_material = material(row, "slider_material", materials);
    let guide_material = material(row, "guide_material", materials);
    let contact_damping = contact_damping(row);
    let friction = row.quantity("friction", NUMBER, Range::Within(0.0, 2.0));
    let friction_speed = row.quantity("friction_speed", SPEED, Range::Positive);
    let wear = wear(row);
    for (key, reason) in KEYS_OF_HINGES {
        // Known only where it is given, so that no message offers it.
        if row.peek(key).is_some() && row.get(key).is_some() {
            row.inconsistent(key, reason);
        }
    }
    Some(GuideClearance {
        axis: axis?,
        angle: angle?,
        length: length?,
        height: height?,
        width: width?,
        clearance: clearance?,
        reach: reach?,
        slider_material: slider_material?,
        guide_material: guide_material?,
        contact_damping: contact_damping?,
        friction: friction?,
        friction_speed: friction_speed?,
        wear: wear?,
    })
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
    let surfaces = row.choice("wears", "guide, slider or both", &words);
    let coefficient = row.quantity("wear_coefficient", INVERSE_PRESSURE, Range::NonNegative);
    let slider_coefficient = slider_coefficient(row, surfaces);
    let control_points = control_points(row);
    Some(Some(GuideWear {
        wears: surfaces?,
        coefficient: coefficient?,
        slider_coefficient: slider_coefficient?,
        control_points: control_points?,
    }))
}

/// Reads the wear coefficient of the slider, which is that of the joint unless both surfaces wear.
fn slider_coefficient(row: &mut Section, surfaces: Option<WearingSurfaces>) -> Option<Option<f64>> {
    const KEY: &str = "slider_wear_coefficient";
    if row.get(KEY).is_none() {
        return Some(None);
    }
    let found = row.quantity(KEY, INVERSE_PRESSURE, Range::NonNegative);
    if surfaces.is_some_and(|surfaces| surfaces != WearingSurfaces::Both) {
        row.inconsistent(KEY, "needs wears = \"both\"; a single surface that wears has wear_coefficient");
        return None;
    }
    found.map(Some)
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
