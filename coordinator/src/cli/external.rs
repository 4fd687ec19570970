//! Commands on a scene that names a simulator of its own: what fits them, one evaluation, and what they explain.

use super::accuracy::AccuracyArguments;
use super::arguments::{FarmArguments, SimulateArguments, Slots};
use super::error::CommandError;
use super::output::{deliver, to_json};
use super::scenes::count;
use super::signals::interruption;
use common::scene::{ExternalSimulator, Fails, OutputKind, Scene, SceneSource, SimulatorKind};
use coordinator::farm::evaluate::external::open;
use coordinator::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use coordinator::results::output_unit::OutputUnit;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;

/// What is printed of one evaluation; names as for a mechanism.
#[derive(Debug, Serialize)]
struct Printed<'r> {
    scene: &'r str,
    /// What `--set` changed.
    settings: BTreeMap<&'r str, f64>,
    cycles: &'r [u32],
    /// Each output under its name and unit.
    #[serde(flatten)]
    outputs: BTreeMap<String, &'r [f64]>,
    /// Numerical error of each, under the same names, if the simulator states any.
    numerical_error: BTreeMap<String, &'r [f64]>,
    wall_s: f64,
}

/// Makes the simulator ready on `slots` slots; Ctrl-C and SIGTERM end its batches.
pub fn ready(
    simulator: &ExternalSimulator,
    scene: &Scene,
    slots: usize,
) -> Result<Box<dyn Evaluator>, CommandError> {
    let interrupted = interruption().map_err(CommandError::Signals)?;
    Ok(open(simulator, scene, slots, interrupted)?)
}

/// Options on accuracy are about mechanisms.
pub fn check_accuracy(origin: &str, accuracy: &AccuracyArguments) -> Result<(), CommandError> {
    let given = [("--accuracy", accuracy.accuracy.is_some()), ("--max-error", accuracy.max_error.is_some())];
    refuse(origin, &given, "its simulator decides how accurate it is")
}

/// Programs run on this machine alone, and servers are asked from it: nobody else can join.
pub fn check_farm(origin: &str, farm: &FarmArguments) -> Result<(), CommandError> {
    let given = [
        ("--listen", farm.listen.is_some()),
        ("--config", farm.config.is_some()),
        ("--insecure", farm.insecure),
        ("--workers 0", farm.workers == Some(Slots::Count(0))),
    ];
    refuse(origin, &given, "its simulator is run or asked by this process alone")
}

fn refuse(origin: &str, given: &[(&'static str, bool)], reason: &'static str) -> Result<(), CommandError> {
    match given.iter().find(|(_, given)| *given) {
        Some((option, _)) => {
            Err(CommandError::NotForSimulators { origin: origin.to_owned(), option, reason })
        }
        None => Ok(()),
    }
}

/// `coordinator simulate` of such a scene.
pub fn simulate(
    source: &SceneSource,
    simulator: &ExternalSimulator,
    settings: &[(String, f64)],
    arguments: &SimulateArguments,
) -> Result<(), CommandError> {
    let scene = source.nominal();
    check_accuracy(source.origin(), &arguments.accuracy)?;
    let sample = source.sample_with(settings)?;
    let request = Request { id: 0, sample, with_first_cycle: false, accuracy: None };
    let mut found = None;
    ready(simulator, scene, 1)?
        .evaluate(&[request], &mut |finished| {
            found = Some(finished);
            Ok(())
        })
        .map_err(CommandError::Evaluate)?;
    let lost = || CommandError::Evaluate(EvaluateError::Transport("the evaluation has no outcome".into()));
    let Finished { outcome, wall, .. } = found.ok_or_else(lost)?;
    let evaluation = outcome
        .map_err(|failure| CommandError::Simulation { origin: source.origin().to_owned(), failure })?;
    let printed = Printed {
        scene: &scene.name,
        settings: settings.iter().map(|(name, value)| (name.as_str(), *value)).collect(),
        cycles: &evaluation.cycles,
        outputs: by_name(scene, &evaluation.histories),
        numerical_error: by_name(scene, &evaluation.errors),
        wall_s: wall,
    };
    deliver(&to_json(&printed)?, arguments.out.as_deref())
}

fn by_name<'r>(scene: &Scene, rows: &'r [Vec<f64>]) -> BTreeMap<String, &'r [f64]> {
    let keys = scene.outputs.iter().map(|output| OutputUnit::of(&output.kind).key(&output.name));
    keys.zip(rows.iter().map(Vec::as_slice)).collect()
}

/// What is evaluated, for people: the part of `coordinator explain` that describes a mechanism otherwise.
pub fn explain(out: &mut String, scene: &Scene, simulator: &ExternalSimulator) -> std::fmt::Result {
    writeln!(out, "Simulator")?;
    match &simulator.kind {
        SimulatorKind::Program(program) => writeln!(
            out,
            "  program: {}\n  runs in {}, one process per worker slot, over lines of JSON",
            program.command.join(" "),
            program.folder
        )?,
        SimulatorKind::UmBridge(model) => writeln!(
            out,
            "  model \"{}\" of the UM-Bridge server {}, one request at a time per worker slot",
            model.model, model.url
        )?,
    }
    writeln!(out, "  an evaluation may take {} s\n", simulator.timeout)?;
    writeln!(out, "Outputs at every checkpoint, and what counts as failure")?;
    for (i, output) in scene.outputs.iter().enumerate() {
        let unit = OutputUnit::of(&output.kind);
        let single = matches!(output.kind, OutputKind::External { single: true, .. });
        let values = if single { ": one value for the whole life" } else { "" };
        writeln!(out, "  {}{values}", unit.axis(&output.name))?;
        for limit in scene.limit_states.iter().filter(|limit| limit.output == i) {
            let side = match limit.fails {
                Fails::Above => "on",
                Fails::Below => "down",
            };
            let threshold = unit.after(&limit.threshold.to_string());
            writeln!(out, "     limit state {}: failed from {threshold} {side}", limit.name)?;
        }
    }
    writeln!(out)
}

/// What such a scene has, for `coordinator check`.
pub fn counts(scene: &Scene) -> String {
    [
        count(scene.outputs.len(), "output"),
        count(scene.variables.len(), "random variable"),
        count(scene.limit_states.len(), "limit state"),
        count(scene.life.checkpoints().len(), "checkpoint"),
    ]
    .join(", ")
}
