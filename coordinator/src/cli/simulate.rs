//! `coordinator simulate`: runs one evaluation in this process and prints it, as JSON for scripts and in lines for a person.

use super::accuracy::AccuracyArguments;
use super::error::CommandError;
use super::external;
use super::output::{check_destination, deliver, print, to_json};
use super::scenes::check_linkage;
use super::shared::{DEFAULT_SCENE, Verbosity};
use super::simulated::Simulated;
use clap::Args;
use common::outputs::{
    BodyMotion, BodyTrace, CycleHistory, Diagnostics, EnergyBalance, Evaluation, JointSummary, NarrowGroove,
    UnsettledMotion, WornLife,
};
use common::scene::{Fault, Faults, OutputUnit, Scene, SceneSource};
use coordinator::results::control_points::{ControlPointsRow, control_points_rows};
use coordinator::results::result_files::write_text;
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Instant;
use worker::simulate::{self, SimulateOptions};

/// Arguments of `coordinator simulate`.
#[derive(Debug, Clone, Args)]
pub struct SimulateArguments {
    /// Scene file, or name of a built-in scene
    #[arg(long, default_value = DEFAULT_SCENE, value_name = "NAME-or-FILE")]
    pub scene: String,
    /// Set a random variable, or any quantity by its key, e.g. rod_length=40.05mm
    #[arg(long, value_name = "variable=value")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Write the JSON to this file instead of standard output
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Write a page with figures: outputs over life against the limits, motion, worn bores, first and last cycle
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    pub report: Option<PathBuf>,
}

/// The evaluation as printed; the names are a contract with scripts and notebooks.
#[derive(Debug, Serialize)]
struct PrintedEvaluation<'r> {
    scene: &'r str,
    accuracy: &'r str,
    /// Values changed by `--set`, in SI units.
    settings: BTreeMap<&'r str, f64>,
    cycles: &'r [u32],
    /// Each output under its name and unit.
    #[serde(flatten)]
    outputs: BTreeMap<String, Vec<f64>>,
    /// Estimated numerical error of each, under the same names.
    numerical_error: BTreeMap<String, Vec<f64>>,
    start: BTreeMap<String, f64>,
    first_cycle: Option<PrintedCycle<'r>>,
    joints: Vec<PrintedJoint<'r>>,
    worn: Option<PrintedWorn<'r>>,
    diagnostics: PrintedDiagnostics<'r>,
    wall_s: f64,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case")]
struct PrintedCycle<'r> {
    time_s: &'r [f64],
    rocker_angle_deg: BTreeMap<&'r str, Vec<f64>>,
    rocker_speed_rpm: BTreeMap<&'r str, Vec<f64>>,
    /// Motion of the reference point of every moving body.
    bodies: BTreeMap<&'r str, PrintedMotion>,
    #[serde(rename = "joint_force_N")]
    joint_force: BTreeMap<&'r str, &'r [f64]>,
}

/// Wear profiles through life, and the last cycle on the worn bores.
#[derive(Debug, Serialize)]
struct PrintedWorn<'r> {
    cycles: &'r [u32],
    /// By joint, one profile per life.
    wear_depth_m: BTreeMap<&'r str, Vec<&'r [f64]>>,
    last_cycle: Option<PrintedCycle<'r>>,
}

#[derive(Debug, Serialize)]
struct PrintedMotion {
    x_m: Vec<f64>,
    y_m: Vec<f64>,
    angle_deg: Vec<f64>,
    speed_rpm: Vec<f64>,
}

/// Energy balance of one cycle.
#[derive(Debug, Serialize)]
struct PrintedEnergy {
    #[serde(rename = "input_J")]
    input: f64,
    #[serde(rename = "stored_J")]
    stored: f64,
    #[serde(rename = "dissipated_J")]
    dissipated: f64,
    #[serde(rename = "unphysical_J")]
    unphysical: f64,
    #[serde(rename = "residual_J")]
    residual: f64,
}

#[derive(Debug, Serialize)]
struct PrintedJoint<'r> {
    name: &'r str,
    #[serde(rename = "peak_force_N")]
    peak_force: f64,
    wear_depth_m: &'r [f64],
    #[serde(skip_serializing_if = "<[f64]>::is_empty")]
    journal_wear_depth_m: &'r [f64],
}

/// A groove narrower than the journal.
#[derive(Debug, Serialize)]
struct PrintedGroove<'r> {
    joint: &'r str,
    since_cycles: u32,
    angle_deg: f64,
    width_deg: f64,
    open_m: f64,
}

/// A motion that has not settled.
#[derive(Debug, Serialize)]
struct PrintedUnsettled<'r> {
    output: &'r str,
    change_per_cycle: f64,
    further_cycles: u32,
    turning_body: Option<&'r str>,
    turn_deg: Option<f64>,
}

#[derive(Debug, Serialize)]
struct PrintedDiagnostics<'r> {
    steps: u64,
    rejected_steps: u64,
    newton_iterations: u64,
    force_evaluations: u64,
    simulated_cycles: u64,
    wear_stages: u64,
    rejected_wear_steps: u64,
    free_flight_fraction: BTreeMap<&'r str, f64>,
    constraint_drift_m: f64,
    held_wear_points: u64,
    narrow_grooves: Vec<PrintedGroove<'r>>,
    control_points: Vec<ControlPointsRow>,
    #[serde(skip_serializing_if = "Option::is_none")]
    unsettled: Option<PrintedUnsettled<'r>>,
    quasi_static: bool,
    energy: Option<PrintedEnergy>,
    worn_energy: Option<PrintedEnergy>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn simulate(arguments: &SimulateArguments, verbosity: Verbosity) -> Result<(), CommandError> {
    check_destination(arguments.out.as_deref())?;
    check_destination(arguments.report.as_deref())?;
    let source = SceneSource::load(&arguments.scene)?;
    let settings = source.parse_settings(&arguments.set)?;
    if let Some(simulator) = &source.nominal().simulator {
        external::check_accuracy(source.origin(), &arguments.accuracy)?;
        if arguments.report.is_some() {
            return Err(CommandError::no_mechanism(source.origin()));
        }
        let text = external::simulate(&source, simulator, &settings)?;
        return deliver(&text, arguments.out.as_deref());
    }
    let scene = source.resolve_with(&settings).map_err(one_of_each_cause)?;
    check_linkage(source.origin(), &source, &scene)?;
    let accuracy = arguments.accuracy.for_one(&scene, verbosity.quiet)?.setting;
    let start = Instant::now();
    let evaluation = simulate::simulate(&scene, &accuracy.accuracy, SimulateOptions::WITH_FIRST_CYCLE)
        .map_err(|failure| CommandError::of_simulation(source.origin(), &scene, failure))?;
    let wall = start.elapsed().as_secs_f64();
    let simulated = Simulated { scene: &scene, accuracy: &accuracy.name, evaluation: &evaluation, wall };
    if let Some(file) = &arguments.report {
        write_text(file, &simulated.report(&arguments.set, source.text())?)?;
    }
    // A person reads lines, a script the object.
    let to_person = !verbosity.json && arguments.out.is_none() && std::io::stdout().is_terminal();
    if !to_person {
        let text = to_json(&printed(&scene, &accuracy.name, &settings, &evaluation, wall))?;
        deliver(&text, arguments.out.as_deref())?;
    }
    let files: Vec<&Path> =
        [&arguments.out, &arguments.report].into_iter().flatten().map(PathBuf::as_path).collect();
    let has_lines = to_person || arguments.out.is_some();
    if has_lines && !verbosity.quiet && !verbosity.json { print(&simulated.text(&files)) } else { Ok(()) }
}

/// The faults without those that one value has at several keys.
fn one_of_each_cause(Faults(all): Faults) -> Faults {
    let mut found: Vec<Fault> = Vec::new();
    for fault in all {
        if !found.iter().any(|known| known.kind == fault.kind) {
            found.push(fault);
        }
    }
    Faults(found)
}

fn printed<'r>(
    scene: &'r Scene,
    accuracy: &'r str,
    settings: &'r [(String, f64)],
    evaluation: &'r Evaluation,
    wall_s: f64,
) -> PrintedEvaluation<'r> {
    let by_name = |rows: &[Vec<f64>]| -> BTreeMap<String, Vec<f64>> {
        let named = scene.outputs.iter().zip(rows).map(|(output, row)| {
            let unit = output.kind.unit();
            let values = row.iter().map(|&value| unit.to_file(value)).collect();
            (unit.key(&output.name), values)
        });
        named.collect()
    };
    PrintedEvaluation {
        scene: &scene.name,
        accuracy,
        settings: settings.iter().map(|(name, value)| (name.as_str(), *value)).collect(),
        cycles: &evaluation.cycles,
        outputs: by_name(&evaluation.histories),
        numerical_error: by_name(&evaluation.errors),
        start: evaluation.start_by_key(&scene.outputs),
        first_cycle: evaluation.first_cycle.as_ref().map(printed_cycle),
        worn: evaluation.worn.as_ref().map(|worn| printed_worn(worn, &evaluation.joints)),
        joints: evaluation
            .joints
            .iter()
            .map(|joint| PrintedJoint {
                name: &joint.name,
                peak_force: joint.peak_force,
                wear_depth_m: &joint.wear_depth,
                journal_wear_depth_m: &joint.journal_wear_depth,
            })
            .collect(),
        diagnostics: printed_diagnostics(scene, &evaluation.diagnostics),
        wall_s,
    }
}

fn printed_cycle(cycle: &CycleHistory) -> PrintedCycle<'_> {
    let rockers = |of: fn(&BodyTrace) -> Vec<f64>| -> BTreeMap<&str, Vec<f64>> {
        cycle.bodies.iter().map(|body| (body.label.as_str(), of(body))).collect()
    };
    PrintedCycle {
        time_s: &cycle.time,
        rocker_angle_deg: rockers(|body| in_degrees(&body.angle)),
        rocker_speed_rpm: rockers(|body| in_rpm(&body.speed)),
        bodies: cycle.motion.iter().map(|m| (m.body.as_str(), printed_motion(m))).collect(),
        joint_force: cycle
            .joint_force
            .iter()
            .map(|(name, force)| (name.as_str(), force.as_slice()))
            .collect(),
    }
}

fn printed_worn<'r>(worn: &'r WornLife, joints: &'r [JointSummary]) -> PrintedWorn<'r> {
    let through_life = |(k, joint): (usize, &'r JointSummary)| {
        (joint.name.as_str(), worn.wear_depth.iter().map(|at| at[k].as_slice()).collect())
    };
    PrintedWorn {
        cycles: &worn.cycles,
        wear_depth_m: joints.iter().enumerate().map(through_life).collect(),
        last_cycle: worn.last_cycle.as_ref().map(printed_cycle),
    }
}

fn printed_motion(motion: &BodyMotion) -> PrintedMotion {
    PrintedMotion {
        x_m: motion.position.iter().map(|x| x[0]).collect(),
        y_m: motion.position.iter().map(|x| x[1]).collect(),
        angle_deg: in_degrees(&motion.angle),
        speed_rpm: in_rpm(&motion.speed),
    }
}

fn printed_diagnostics<'r>(scene: &Scene, diagnostics: &'r Diagnostics) -> PrintedDiagnostics<'r> {
    let free_flight = diagnostics.free_flight_fraction.iter();
    PrintedDiagnostics {
        steps: diagnostics.steps,
        rejected_steps: diagnostics.rejected_steps,
        newton_iterations: diagnostics.newton_iterations,
        force_evaluations: diagnostics.force_evaluations,
        simulated_cycles: diagnostics.simulated_cycles,
        wear_stages: diagnostics.wear_stages,
        rejected_wear_steps: diagnostics.rejected_wear_steps,
        free_flight_fraction: free_flight.map(|(name, share)| (name.as_str(), *share)).collect(),
        constraint_drift_m: diagnostics.constraint_drift,
        held_wear_points: diagnostics.held_wear_points,
        narrow_grooves: diagnostics.narrow_grooves.iter().map(printed_groove).collect(),
        control_points: control_points_rows(scene, diagnostics),
        unsettled: diagnostics.unsettled.as_ref().map(printed_unsettled),
        quasi_static: diagnostics.quasi_static,
        energy: diagnostics.energy.map(printed_energy),
        worn_energy: diagnostics.worn_energy.map(printed_energy),
    }
}

fn printed_unsettled(motion: &UnsettledMotion) -> PrintedUnsettled<'_> {
    let turning = motion.turning.as_ref();
    PrintedUnsettled {
        output: &motion.output,
        change_per_cycle: motion.change,
        further_cycles: motion.further_cycles,
        turning_body: turning.map(|(body, _)| body.as_str()),
        turn_deg: turning.map(|(_, angle)| angle.to_degrees()),
    }
}

fn printed_groove(groove: &NarrowGroove) -> PrintedGroove<'_> {
    PrintedGroove {
        joint: &groove.joint,
        since_cycles: groove.since,
        angle_deg: groove.angle.to_degrees(),
        width_deg: groove.width.to_degrees(),
        open_m: groove.open,
    }
}

fn printed_energy(energy: EnergyBalance) -> PrintedEnergy {
    PrintedEnergy {
        input: energy.input,
        stored: energy.stored,
        dissipated: energy.dissipated,
        unphysical: energy.unphysical,
        residual: energy.residual(),
    }
}

fn in_rpm(values: &[f64]) -> Vec<f64> {
    values.iter().map(|&value| OutputUnit::AngularVelocity.to_file(value)).collect()
}

fn in_degrees(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value.to_degrees()).collect()
}
