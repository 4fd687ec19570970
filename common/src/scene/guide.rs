//! Reads guides with clearance: slider, guide, contact damping, friction.

use super::clearance::{MaterialRow, contact_damping, material};
use super::context::Range;
use super::faults::in_first_unit;
use super::joint::GuideClearance;
use super::quantity::*;
use super::section::Section;

/// Keys of the wear of a joint, which a guide does not have.
const WEAR_KEYS: [&str; 6] =
    ["wear", "wears", "wear_coefficient", "journal_wear_coefficient", "control_points", "wall"];

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
    for key in WEAR_KEYS {
        // Known only where it is given, so that no message offers it.
        if row.peek(key).is_some() && row.get(key).is_some() {
            row.inconsistent(key, "the wear of a guide is not modelled: leave this key out");
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
    })
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
