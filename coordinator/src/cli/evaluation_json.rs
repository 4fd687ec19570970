//! One evaluation as JSON. The names are a contract with scripts and notebooks; those of quantities end in their unit.

use common::outputs::{
    BodyMotion, BodyTrace, COUNTERS, CycleHistory, Diagnostics, EnergyBalance, Evaluation, JointSummary,
    JournalPath, NarrowGroove, UnsettledMotion, WornLife,
};
use common::scene::{OutputUnit, Scene};
use coordinator::results::summary_rows::control_points_rows;
use serde_json::{Map, Value, json};

/// What every evaluation has: the outputs under their names and units, their numerical errors, their values at the start of life, and the
/// time that it took [s]; `settings` are the values that `--set` changed [SI].
pub fn of_outputs(
    scene: &Scene,
    settings: &[(String, f64)],
    evaluation: &Evaluation,
    wall: f64,
) -> Map<String, Value> {
    let by_name = |rows: &[Vec<f64>]| -> Map<String, Value> {
        let named = scene.outputs.iter().zip(rows).map(|(output, row)| {
            let unit = output.kind.unit();
            (unit.key(&output.name), row.iter().map(|value| unit.to_file(*value)).collect())
        });
        named.collect()
    };
    let mut all = by_name(&evaluation.histories);
    let about: [(&str, Value); 6] = [
        ("scene", json!(scene.name)),
        ("settings", settings.iter().map(|(name, value)| (name.as_str(), *value)).collect()),
        ("cycles", json!(evaluation.cycles)),
        ("numerical_error", by_name(&evaluation.errors).into()),
        ("start", json!(evaluation.start_by_key(&scene.outputs))),
        ("wall_s", json!(wall)),
    ];
    all.extend(about.map(|(key, value)| (key.to_owned(), value)));
    all
}

/// What the evaluation of a mechanism has besides.
pub fn of_mechanism(scene: &Scene, accuracy: &str, evaluation: &Evaluation) -> [(String, Value); 5] {
    let joints = &evaluation.joints;
    let about: [(&str, Value); 5] = [
        ("accuracy", json!(accuracy)),
        ("first_cycle", evaluation.first_cycle.as_ref().map(cycle).into()),
        ("worn", evaluation.worn.as_ref().map(|worn| through_life(worn, joints)).into()),
        ("joints", joints.iter().map(joint).collect()),
        ("diagnostics", diagnostics(scene, &evaluation.diagnostics)),
    ];
    about.map(|(key, value)| (key.to_owned(), value))
}

fn cycle(cycle: &CycleHistory) -> Value {
    let traces = |of: fn(&BodyTrace) -> Value| -> Value {
        cycle.bodies.iter().map(|body| (body.label.as_str(), of(body))).collect()
    };
    json!({
        "time_s": cycle.time,
        "rocker_angle_deg": traces(|body| in_degrees(&body.angle)),
        "rocker_speed_rpm": traces(|body| in_rpm(&body.speed)),
        "bodies": cycle.motion.iter().map(|body| (body.body.as_str(), motion(body))).collect::<Value>(),
        "joint_force_N": by_joint(&cycle.joint_force),
        "driving_torque_N_m": by_joint(&cycle.driving_torque),
        "slider_position_m": by_joint(&cycle.slider_position),
        "journals": cycle.journals.iter().map(|path| (path.joint.as_str(), journal(path))).collect::<Value>(),
    })
}

/// Force and eccentricity of a journal, in the frame of the bushing.
fn journal(JournalPath { force, eccentricity, .. }: &JournalPath) -> Value {
    json!({ "force_x_N": column(force, 0), "force_y_N": column(force, 1),
            "eccentricity_x_m": column(eccentricity, 0), "eccentricity_y_m": column(eccentricity, 1) })
}

/// Motion of the reference point of a body.
fn motion(motion: &BodyMotion) -> Value {
    json!({ "x_m": column(&motion.position, 0), "y_m": column(&motion.position, 1), "angle_deg": in_degrees(&motion.angle),
            "speed_rpm": in_rpm(&motion.speed) })
}

/// Wear profiles through life, by joint one per life, and the last cycle on the worn bores.
fn through_life(worn: &WornLife, joints: &[JointSummary]) -> Value {
    let depths = |(k, joint): (usize, &JointSummary)| -> (String, Value) {
        (joint.name.clone(), worn.wear_depth.iter().map(|at| at[k].as_slice()).collect())
    };
    json!({ "cycles": worn.cycles, "wear_depth_m": joints.iter().enumerate().map(depths).collect::<Value>(),
            "last_cycle": worn.last_cycle.as_ref().map(cycle) })
}

fn joint(joint: &JointSummary) -> Value {
    let mut about =
        json!({ "name": joint.name, "peak_force_N": joint.peak_force, "wear_depth_m": joint.wear_depth });
    if !joint.journal_wear_depth.is_empty() {
        about["journal_wear_depth_m"] = json!(joint.journal_wear_depth);
    }
    about
}

fn diagnostics(scene: &Scene, diagnostics: &Diagnostics) -> Value {
    let mut about = json!({
        "free_flight_fraction": by_joint(&diagnostics.free_flight_fraction),
        "constraint_drift_m": diagnostics.constraint_drift,
        "held_wear_points": diagnostics.held_wear_points,
        "narrow_grooves": diagnostics.narrow_grooves.iter().map(groove).collect::<Value>(),
        "control_points": control_points_rows(scene, diagnostics),
        "quasi_static": diagnostics.quasi_static,
        "energy": diagnostics.energy.map(energy),
        "worn_energy": diagnostics.worn_energy.map(energy),
    });
    for (key, _, count) in COUNTERS {
        about[key] = count(diagnostics).into();
    }
    if let Some(UnsettledMotion { output, change, further_cycles, turning }) = &diagnostics.unsettled {
        let (body, angle) = turning.as_ref().map(|(body, angle)| (body, angle.to_degrees())).unzip();
        about["unsettled"] = json!({ "output": output, "change_per_cycle": change, "further_cycles": further_cycles,
                                     "turning_body": body, "turn_deg": angle });
    }
    about
}

/// A groove narrower than the journal.
fn groove(groove: &NarrowGroove) -> Value {
    let [angle, width] = [groove.angle, groove.width].map(f64::to_degrees);
    json!({ "joint": groove.joint, "since_cycles": groove.since, "angle_deg": angle, "width_deg": width,
            "open_m": groove.open })
}

/// Energy balance of one cycle.
fn energy(energy: EnergyBalance) -> Value {
    json!({ "input_J": energy.input, "stored_J": energy.stored, "dissipated_J": energy.dissipated,
            "unphysical_J": energy.unphysical, "residual_J": energy.residual() })
}

fn column(of: &[[f64; 2]], axis: usize) -> Value {
    of.iter().map(|at| at[axis]).collect()
}

fn by_joint<T: Clone + Into<Value>>(values: &[(String, T)]) -> Value {
    values.iter().map(|(name, value)| (name.as_str(), value.clone())).collect()
}

fn in_rpm(values: &[f64]) -> Value {
    values.iter().map(|value| OutputUnit::AngularVelocity.to_file(*value)).collect()
}

fn in_degrees(values: &[f64]) -> Value {
    values.iter().map(|value| value.to_degrees()).collect()
}
