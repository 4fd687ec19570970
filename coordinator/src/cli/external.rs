//! Scenes that name their own simulator: the options that they allow, one evaluation, and their description.

use super::signals::interruption;
use super::{AccuracyArguments, CommandError, Done, FarmArguments, count};
use common::external::SimulatorId;
use common::outputs::Evaluation;
use common::scene::{
    ExternalSimulator, Fails, FileExchange, LimitState, OutputKind, Program, Scene, SceneSource,
    SimulatorKind, UmBridgeModel,
};
use coordinator::farm::evaluate::external::on_slots;
use coordinator::farm::evaluate::{EvaluateError, Evaluator, Finished, Request};
use coordinator::presentation::report::format::shortest;
use std::fmt::Write;
use std::sync::Arc;
use worker::evaluation_slots::EvaluationSlots;
use worker::own_simulators::{OfferError, OwnSimulators};
use worker::service::Simulator;
use worker::simulator::simulator;

/// Starts the simulator on `slots` slots; Ctrl-C and SIGTERM end its batches.
///
/// # Errors
/// [`CommandError::Failed`], [`CommandError::BadInput`].
pub fn open_simulator(source: &SceneSource, slots: usize) -> Done<Box<dyn Evaluator>> {
    let interrupted = interruption()?;
    let Some(opened) = EvaluationSlots::open(source).transpose().map_err(CommandError::bad_input)? else {
        unreachable!("only scenes that name a simulator come here")
    };
    on_slots((0..slots).map(|number| opened.slot(number)).collect(), interrupted)
        .map_err(CommandError::bad_input)
}

/// Refuses options on accuracy: they are for mechanisms.
///
/// # Errors
/// [`CommandError::BadInput`].
pub fn check_accuracy(source: &SceneSource, accuracy: &AccuracyArguments) -> Done {
    let given = [("--accuracy", accuracy.accuracy.is_some()), ("--max-error", accuracy.max_error.is_some())];
    let Some((option, _)) = given.iter().find(|(_, given)| *given) else { return Ok(()) };
    let subject = format_args!("{option} is not for {}", source.origin());
    let has_cycles = source.nominal().simulator.as_ref().is_some_and(|simulator| simulator.cycles.is_some());
    let of_wear = if has_cycles { "; that of the wear is `accuracy` in [study] of the scene" } else { "" };
    Err(CommandError::refused(subject, format_args!("the simulator determines its own accuracy{of_wear}")))
}

/// True if the options ask for remote workers; otherwise this process runs the simulator without messages.
pub fn has_remote_workers(farm: &FarmArguments) -> bool {
    let FarmArguments { workers, listen, config, insecure, scale, .. } = farm;
    listen.is_some() || config.is_some() || *insecure || scale.is_some() || *workers == Some(0)
}

/// The simulator of local workers next to remote ones; without local slots it is not used, and not opened.
///
/// # Errors
/// [`CommandError::BadInput`].
pub fn own_simulator(source: &SceneSource, slots: usize) -> Done<Arc<dyn Simulator>> {
    if slots == 0 {
        return Ok(simulator());
    }
    match OwnSimulators::open(std::slice::from_ref(source)) {
        Ok(own) => Ok(Arc::new(own)),
        Err(OfferError::Simulator { error, .. }) => Err(CommandError::bad_input(error)),
        Err(other) => unreachable!("one scene that names its simulator: {other}"),
    }
}

/// Runs one evaluation of a sample, which takes a time [s].
///
/// # Errors
/// [`CommandError`] if the simulator cannot be used, or the evaluation fails.
pub fn simulate(source: &SceneSource, sample: Vec<f64>) -> Done<(Evaluation, f64)> {
    let request = Request { id: 0, sample, with_first_cycle: true, accuracy: None, level: 0, not_by: vec![] };
    let (mut found, end) = open_simulator(source, 1)?.outcomes(&[request], &mut |_| ());
    end.map_err(CommandError::Evaluate)?;
    let lost = || CommandError::Evaluate(EvaluateError::NoOutcome(0));
    let Finished { outcome, wall, .. } = found.pop().flatten().ok_or_else(lost)?;
    Ok((outcome.map_err(|failure| CommandError::failed_simulation(source.origin(), &failure))?, wall))
}

/// Writes the description of the simulator for `coordinator explain`, in place of that of a mechanism.
pub fn explain(out: &mut String, scene: &Scene, simulator: &ExternalSimulator) -> std::fmt::Result {
    writeln!(out, "Simulator")?;
    match &simulator.kind {
        SimulatorKind::Program(program) => {
            writeln!(out, "  program: {}\n  {}", program.command.join(" "), exchange(program))?
        }
        SimulatorKind::UmBridge(UmBridgeModel { model, url, .. }) => {
            let of = format!("model \"{model}\" of the UM-Bridge server {url}");
            writeln!(out, "  {of}, one request at a time per worker slot")?
        }
    }
    match &simulator.cycles {
        None => {
            writeln!(out, "  an evaluation may take {} s", simulator.timeout)?;
            if !simulator.levels.is_empty() {
                writeln!(out, "  levels, from the coarsest to the finest: {}", simulator.levels.join(", "))?;
            }
        }
        Some(program) => {
            let of = program.tier.explanation();
            writeln!(out, "  {of}; a cycle may take {} s", simulator.timeout)?;
            let joints: Vec<&str> = scene.joints.iter().map(|joint| joint.name.as_str()).collect();
            let accuracy = &scene.accuracy.name;
            writeln!(out, "  wear of {} by this program, accuracy {accuracy}", joints.join(", "))?;
        }
    }
    writeln!(out, "  identity for workers: {}\n", SimulatorId::new(simulator, scene))?;
    writeln!(out, "Outputs at every checkpoint, and the limit states")?;
    for (i, output) in scene.outputs.iter().enumerate() {
        let unit = scene.unit_of(output);
        let single = matches!(output.kind, OutputKind::External { single: true, .. });
        let values = if single { ": one value for the whole life" } else { "" };
        writeln!(out, "  {}{values}", unit.axis(&output.name))?;
        for limit in scene.limit_states.iter().filter(|limit| limit.output == i) {
            let shown = |value: f64| unit.after(&shortest(unit.to_shown(value), 7));
            writeln!(out, "     limit state {}: {}", limit.name, failed(limit, shown))?;
        }
    }
    writeln!(out)
}

/// How a program gets samples and returns results, in words.
fn exchange(program: &Program) -> String {
    let folder = &program.folder;
    match &program.exchange {
        None => format!("runs in {folder}, one process per worker slot, over lines of JSON"),
        Some(FileExchange { results, templates, files }) => {
            let from: Vec<&str> = templates.iter().chain(files).map(String::as_str).collect();
            let from = if from.is_empty() { String::new() } else { format!(" with {}", from.join(", ")) };
            format!("runs once per evaluation, in a folder{from} of {folder}, and writes {results}")
        }
    }
}

/// Counts of the scene's entries for `coordinator check`.
pub fn counts(scene: &Scene) -> String {
    [
        count(scene.outputs.len(), "output"),
        count(scene.variables.len(), "random variable"),
        count(scene.limit_states.len(), "limit state"),
        count(scene.life.checkpoints().len(), "checkpoint"),
    ]
    .join(", ")
}

/// The values with which a limit state has failed, e.g. `failed from 8 um on`; `shown` writes a threshold.
pub(super) fn failed(limit: &LimitState, shown: impl Fn(f64) -> String) -> String {
    let threshold = shown(limit.threshold);
    match limit.fails {
        Fails::Above => format!("failed from {threshold} on"),
        Fails::Below => format!("failed from {threshold} down"),
        Fails::Outside { lower } => format!("failed from {} down and from {threshold} on", shown(lower)),
    }
}
