//! Reads joints that outputs refer to: those that wear for outputs of the wear, those with clearance for impacts.

use super::joint::{JointKind, WearingSurfaces};
use super::joints::{JointRow, chosen_joints, listed};
use super::section::Section;
use super::wear_output::WearQuantity;

/// Reads the joints of an output of this quantity: by default all that wear.
pub(super) fn worn_joints(
    row: &mut Section,
    quantity: WearQuantity,
    joints: &[JointRow],
) -> Option<Vec<usize>> {
    let has = |i: &usize| wearing(&joints[*i]).is_none_or(|of| quantity.is_of(of.surfaces));
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&i| joints[i].unworn.is_none()).filter(has).collect(),
        Some(_) => chosen_joints(row, joints)?,
    };
    let faults = row.cx.fault_count();
    for (i, joint) in chosen.iter().map(|&i| (i, &joints[i])) {
        let reason = match joint.unworn {
            Some(reason) => format!("{reason} and does not wear"),
            None if !has(&i) => {
                let wears = wearing(joint).map_or("", |of| of.word);
                format!("has wears = \"{wears}\"")
            }
            None => continue,
        };
        let others = (0..joints.len()).filter(|other| joints[*other].unworn.is_none() && has(other));
        let there_are = listed(others.map(|other| joints[other].name.as_str()));
        row.inconsistent("joints", format!("joint \"{}\" {reason}{there_are}", joint.name));
    }
    // An override may set a wear coefficient to 0, to see the mechanism in its new state.
    let no_wear = |&i: &usize| match wearing(&joints[i]) {
        Some(of) => of.coefficients == [0.0; 2] && row.cx.as_written(),
        None => false,
    };
    if chosen.is_empty() && joints.iter().any(|joint| joint.unworn.is_none()) {
        let surface = quantity.surface();
        row.inconsistent("joints", format!("there is no joint of which {surface} wears: see its key wears"));
    } else if chosen.is_empty() {
        row.inconsistent(
            "joints",
            "there is no joint that wears, i.e. a hinge with clearance and without wear = false, or a guide with the key wears",
        );
    } else if row.cx.fault_count() == faults && chosen.iter().all(no_wear) {
        row.inconsistent("joints", "every wear_coefficient of these joints is 0: they do not wear");
    }
    (row.cx.fault_count() == faults).then_some(chosen)
}

/// What wears of a joint.
struct Wearing {
    surfaces: WearingSurfaces,
    /// Word for these surfaces in the scene.
    word: &'static str,
    /// Wear coefficients of both surfaces `(2,)` [1/Pa].
    coefficients: [f64; 2],
}

/// What wears of a joint that may wear and is not faulty.
fn wearing(joint: &JointRow) -> Option<Wearing> {
    match joint.joint.as_ref().map(|joint| &joint.kind) {
        Some(JointKind::Clearance(clearance)) => Some(Wearing {
            surfaces: clearance.wears,
            word: clearance.wears.name(),
            coefficients: clearance.wear_coefficients(),
        }),
        Some(JointKind::Guide(guide)) => guide.wear.as_ref().map(|wear| Wearing {
            surfaces: wear.wears,
            word: wear.wears.guide_name(),
            coefficients: wear.coefficients(),
        }),
        _ => None,
    }
}

/// Reads joints and guides with clearance, by default all of them.
pub(super) fn struck_joints(row: &mut Section, joints: &[JointRow]) -> Option<Vec<usize>> {
    let has_clearance = |joint: &JointRow| {
        // The kind of a faulty joint may be unknown; that fault has been recorded.
        let joint = joint.joint.as_ref();
        joint.is_none_or(|joint| joint.kind.has_clearance())
    };
    let with_clearance =
        || joints.iter().filter(|joint| has_clearance(joint)).map(|joint| joint.name.as_str());
    let chosen: Vec<usize> = match row.get("joints") {
        None => (0..joints.len()).filter(|&k| has_clearance(&joints[k])).collect(),
        Some(_) => chosen_joints(row, joints)?,
    };
    if chosen.is_empty() {
        row.inconsistent("joints", "there is no joint with clearance");
        return None;
    }
    if let Some(ideal) = chosen.iter().map(|&k| &joints[k]).find(|joint| !has_clearance(joint)) {
        let there_are = listed(with_clearance());
        row.inconsistent("joints", format!("joint \"{}\" has no clearance{there_are}", ideal.name));
        return None;
    }
    Some(chosen)
}
