//! Finds numbers in a message that are not finite. Workers check before sending, the codec after decoding.

use super::codec::WireError;
use crate::failure::SimulationFailure;
use crate::outputs::{CycleHistory, Evaluation, JointSummary};

/// The first number of an evaluation that is not finite: its name, e.g. `histories[0][3]`, and its checkpoint, if it belongs to one
/// [cycles]; `None` if all are finite.
pub fn find_non_finite(evaluation: &Evaluation) -> Option<(String, Option<u32>)> {
    let Evaluation { cycles, histories, errors, start, joints, first_cycle, worn, diagnostics } = evaluation;
    for (name, rows) in [("histories", histories), ("errors", errors)] {
        for (output, row) in rows.iter().enumerate() {
            if let Some(at) = position(row) {
                return Some((format!("{name}[{output}][{at}]"), cycles.get(at).copied()));
            }
        }
    }
    let elsewhere = |quantity: String| Some((quantity, None));
    if let Some(output) = start.iter().position(|value| value.is_some_and(|value| !value.is_finite())) {
        return elsewhere(format!("start[{output}]"));
    }
    for joint in joints {
        let JointSummary { name, peak_force, wear_depth, journal_wear_depth } = joint;
        let peak = (!peak_force.is_finite()).then(|| format!("peak force of joint {name}"));
        let bore = position(wear_depth).map(|at| format!("wear depth {at} of joint {name}"));
        let journal = position(journal_wear_depth);
        let journal = journal.map(|at| format!("wear depth {at} of the journal of joint {name}"));
        if let Some(quantity) = peak.or(bore).or(journal) {
            return elsewhere(quantity);
        }
    }
    let last_cycle = worn.as_ref().and_then(|worn| worn.last_cycle.as_ref());
    for (which, cycle) in [("first", first_cycle.as_ref()), ("last", last_cycle)] {
        if let Some(quantity) = cycle.and_then(|cycle| in_cycle(cycle, which)) {
            return elsewhere(quantity);
        }
    }
    for (cycles, depths) in worn.iter().flat_map(|worn| worn.cycles.iter().zip(&worn.wear_depth)) {
        if let Some(joint) = depths.iter().position(|depth| position(depth).is_some()) {
            let quantity = format!("wear depth of joint {}", joints.get(joint).map_or("", |j| &j.name));
            return Some((quantity, Some(*cycles)));
        }
    }
    if !diagnostics.constraint_drift.is_finite() {
        return elsewhere("constraint drift".to_owned());
    }
    for (name, energy) in [("first", diagnostics.energy), ("last", diagnostics.worn_energy)] {
        if energy.is_some_and(|e| !(e.turnover.is_finite() && e.residual().is_finite())) {
            return elsewhere(format!("energy of the {name} cycle"));
        }
    }
    let flight = diagnostics.free_flight_fraction.iter().find(|(_, share)| !share.is_finite());
    flight.and_then(|(joint, _)| elsewhere(format!("free flight fraction of joint {joint}")))
}

/// Name of the first number of a cycle that is not finite; `which` names the cycle.
fn in_cycle(cycle: &CycleHistory, which: &str) -> Option<String> {
    if let Some(at) = position(&cycle.time) {
        return Some(format!("time {at} of the {which} cycle"));
    }
    for body in &cycle.bodies {
        if let Some(at) = position(&body.angle).or_else(|| position(&body.speed)) {
            return Some(format!("motion {at} of {} in the {which} cycle", body.label));
        }
    }
    for motion in &cycle.motion {
        let place = motion.position.iter().position(|x| !(x[0].is_finite() && x[1].is_finite()));
        let place = place.or_else(|| position(&motion.angle)).or_else(|| position(&motion.speed));
        if let Some(at) = place {
            return Some(format!("motion {at} of {} in the {which} cycle", motion.body));
        }
    }
    for path in &cycle.journals {
        let components = [&path.force, &path.eccentricity].into_iter().map(|of| position(of.as_flattened()));
        if let Some(at) = components.flatten().next() {
            return Some(format!("journal {at} of joint {} in the {which} cycle", path.joint));
        }
    }
    let of_joints = |what: &str, values: &[(String, Vec<f64>)]| {
        let named = |(joint, values): &(String, Vec<f64>)| {
            position(values).map(|at| format!("{what} {at} of joint {joint} in the {which} cycle"))
        };
        values.iter().find_map(named)
    };
    let torques = cycle.driving_torque.iter().find_map(|(body, torque)| {
        position(torque).map(|at| format!("torque {at} of {body} in the {which} cycle"))
    });
    let forces = of_joints("force", &cycle.joint_force);
    forces.or_else(|| of_joints("position", &cycle.slider_position)).or(torques)
}

/// True if every number of a failure is finite. In JSON the others are null, as is the name of a joint where there is none.
pub fn failure_is_finite(failure: &SimulationFailure) -> bool {
    let failure = serde_json::to_value(failure).expect("a failure is numbers and texts by name");
    let fields = failure.as_object().into_iter().flatten().filter_map(|(_, fields)| fields.as_object());
    fields.flatten().all(|(name, value)| name == "joint" || !value.is_null())
}

/// Checks that all `values` are finite.
///
/// # Errors
/// [`WireError::NotFinite`] with the name and index of the first value that is not finite.
pub(super) fn all_finite(name: &str, values: &[f64]) -> Result<(), WireError> {
    match position(values) {
        Some(at) => Err(WireError::NotFinite(format!("{name}[{at}]"))),
        None => Ok(()),
    }
}

fn position(values: &[f64]) -> Option<usize> {
    values.iter().position(|v| !v.is_finite())
}
