//! Reads outputs of the wear: the joints they refer to must wear.

use super::joint::{Clearance, JointKind};
use super::joints::{JointRow, chosen_joints, listed};
use super::output::OutputKind;
use super::section::Section;
use super::wear_output::WearQuantity;

/// Reads the joints of an output of this quantity: by default all that wear.
pub(super) fn wear(row: &mut Section, quantity: WearQuantity, joints: &[JointRow]) -> Option<OutputKind> {
    let has = |i: &usize| clearance(&joints[*i]).is_none_or(|clearance| quantity.is_of(clearance.wears));
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&i| joints[i].unworn.is_none()).filter(has).collect(),
        Some(_) => chosen_joints(row, joints)?,
    };
    let faults = row.cx.fault_count();
    for (i, joint) in chosen.iter().map(|&i| (i, &joints[i])) {
        let reason = match joint.unworn {
            Some(reason) => format!("{reason} and does not wear"),
            None if !has(&i) => {
                let wears = clearance(joint).map_or("", |clearance| clearance.wears.name());
                format!("has wears = \"{wears}\"")
            }
            None => continue,
        };
        let wearing = (0..joints.len()).filter(|other| joints[*other].unworn.is_none() && has(other));
        let there_are = listed(wearing.map(|other| joints[other].name.as_str()));
        row.inconsistent("joints", format!("joint \"{}\" {reason}{there_are}", joint.name));
    }
    // An override may set a wear coefficient to 0, to see the mechanism in its new state.
    let no_wear = |&i: &usize| match clearance(&joints[i]) {
        Some(clearance) => clearance.wear_coefficients() == [0.0; 2] && row.cx.as_written(),
        None => false,
    };
    if chosen.is_empty() && joints.iter().any(|joint| joint.unworn.is_none()) {
        let surface = quantity.surface();
        row.inconsistent("joints", format!("there is no joint of which {surface} wears: see its key wears"));
    } else if chosen.is_empty() {
        row.inconsistent(
            "joints",
            "there is no joint that wears, i.e. with clearance and without wear = false",
        );
    } else if row.cx.fault_count() == faults && chosen.iter().all(no_wear) {
        row.inconsistent("joints", "every wear_coefficient of these joints is 0: they do not wear");
    }
    let kind = match quantity {
        WearQuantity::LargestDepth => OutputKind::LargestWear { joints: chosen },
        quantity => OutputKind::Wear { quantity, joints: chosen },
    };
    (row.cx.fault_count() == faults).then_some(kind)
}

/// The clearance of a joint that has one and is not faulty.
fn clearance(joint: &JointRow) -> Option<&Clearance> {
    match joint.joint.as_ref().map(|joint| &joint.kind) {
        Some(JointKind::Clearance(clearance)) => Some(clearance),
        _ => None,
    }
}
