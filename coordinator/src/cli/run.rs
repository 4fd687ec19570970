//! `coordinator run` and `coordinator resume`: a study from its scene to its report.
//!
//! scene -> checks -> listen -> folder -> local workers -> study -> result files -> report

use super::designs::{Machines, after_study};
use super::external;
use super::farm::local_slots;
use super::monitor::Monitor;
use super::results::{at_confidence, write_results};
use super::scenes::warn_of;
use super::shared::cores;
use super::signals::interruption;
use super::stored_study::{END_DOCUMENT, design_keys};
use super::study_options::{ResumeArguments, RunArguments};
use super::variants::{self, store_variants, variants_of};
use super::{
    CommandError, CommandEvaluator, Done, FarmArguments, StoredStudy, Verbosity, check_linkage, load_with,
    print, summary_of, to_json,
};
use common::scene::{Scene, read_text, samples_of};
use coordinator::analyses::designs::{DESIGNS_DOCUMENT, DesignSpace};
use coordinator::presentation::motion_cautions::motion_cautions;
use coordinator::presentation::report::{self, CheckpointDistribution, SUMMARY_DOCUMENT};
use coordinator::presentation::terminal::{Terminal, final_text, print_message};
use coordinator::results::store::{CampaignFile, CampaignMeta};
use coordinator::results::summary::StudySummary;
use coordinator::results::summary_rows::control_points_rows;
use coordinator::statistics::reliability::{Histogram, OutputDistribution, PROBABILITIES};
use coordinator::study::{Method, Settings};
use std::path::{Path, PathBuf};

/// Starts a study and runs it to its end.
///
/// # Errors
/// [`CommandError`].
pub fn run(scene: &str, arguments: &RunArguments, verbosity: Verbosity) -> Done {
    let source = load_with(scene, &arguments.values.set)?;
    let mut source = arguments.texts.in_scene(source)?;
    let space = match arguments.design.as_slice() {
        [] => None,
        ranges => Some(DesignSpace::new(source.clone(), ranges)?),
    };
    if let Some(space) = &space {
        if !arguments.method.method.unwrap_or_default().learns() {
            let given = format!("--design {}", arguments.design.join(", "));
            let fault = "design variables need --method ak, whose surrogates answer for every design";
            return Err(CommandError::refused(given, fault));
        }
        check_designs(space)?;
        source = space.augmented()?;
    }
    let scene = source.nominal();
    if scene.variables.is_empty() || scene.limit_states.is_empty() {
        let fault =
            "a study needs at least one random variable and one limit state; `simulate` needs neither";
        return Err(CommandError::refused(source.origin(), fault));
    }
    if scene.simulator.is_some() {
        external::check_accuracy(&source, &arguments.accuracy)?;
    } else {
        warn_of(&check_linkage(source.origin(), &source, scene)?);
    }
    if let Some(confidence) = arguments.confidence.filter(|_| source.measured.is_empty() || space.is_some()) {
        let fault = "needs a variable with measured samples (samples = [...]), and no --design; `learn` takes what was observed of units";
        return Err(CommandError::refused(format!("--confidence {}", 100.0 * confidence), fault));
    }
    arguments.check_levels(scene)?;
    let mut settings = arguments.settings(scene);
    let idle = arguments.method.without_effect().join(", ");
    if !idle.is_empty() {
        let why = if settings.method.learns() { "prescribes or lacks them" } else { "simulates --samples" };
        tracing::warn!("no effect with --method {}, which {why}: {idle}", settings.method.name());
    }
    if let Some(path) = &arguments.method.initial_from {
        let file = path.display().to_string();
        if settings.method != Method::ActiveLearning {
            return Err(CommandError::refused(
                format!("--initial-from {file}"),
                "needs --method ak, which learns from it",
            ));
        }
        settings.initial_samples = samples_of(&scene.variables, &file, &read_text(path)?)?;
        // The nominal point comes before them.
        settings.initial = settings.initial_samples.len() + 1;
    }
    settings.check(scene)?;
    let variants = match &arguments.variants {
        None => vec![],
        Some(file) => variants_of(file, &source, settings.method, space.is_some())?,
    };
    let threads = Some(local_slots(&arguments.farm)).filter(|slots| *slots > 0).unwrap_or_else(cores);
    let interrupted = interruption()?;
    let accuracy = arguments.working_accuracy();
    if accuracy.max_error.is_some() {
        settings.accuracy =
            accuracy.for_study(&source, settings.seed, threads, verbosity.quiet, interrupted)?;
    }
    let dir = arguments.out.clone().unwrap_or_else(|| free_folder(&scene.name));
    let meta = CampaignMeta {
        scene: scene.name.clone(),
        scene_source: source.text().to_owned(),
        settings: serde_json::to_value(&settings)?,
        command: command_line(),
        version: program(),
    };
    // Listen first: an address that cannot be used must not leave a folder behind.
    let evaluator = CommandEvaluator::open(&source, &settings, false, &arguments.farm)?;
    let monitor = Monitor::open(&arguments.monitor, &evaluator, &dir, scene, &settings)?;
    let mut campaign = CampaignFile::create(&dir, &meta, scene)?;
    if let Some(space) = &space {
        campaign.put_document(DESIGNS_DOCUMENT, &space.stored())?;
    }
    verbosity.say(format_args!("results go to {}", dir.display()));
    let mut study = StoredStudy { campaign, source, settings };
    if !variants.is_empty() {
        store_variants(&mut study, &variants)?;
    }
    finish(study, evaluator, monitor, &arguments.farm, arguments.confidence, verbosity)
}

/// Continues a study to its end, with other settings if the arguments name any: then another leg of it begins.
///
/// # Errors
/// [`CommandError`].
pub fn resume(arguments: &ResumeArguments, verbosity: Verbosity) -> Done {
    let ResumeArguments { dir, distrust, variants, extension, farm, monitor } = arguments;
    // A study that this version cannot go on with is refused before its file is brought up to the present layout.
    StoredStudy::look(dir)?;
    let mut study = StoredStudy::read(CampaignFile::open(dir)?)?;
    if let Some(file) = variants {
        let has_designs = !design_keys(&study.campaign)?.is_empty();
        let variants = variants_of(file, &study.source, study.settings.method, has_designs)?;
        store_variants(&mut study, &variants)?;
    }
    let extended = extension.extended(&study.settings, study.campaign.working_count()?)?;
    extended.check(study.scene())?;
    let mut repeated = 0;
    for worker in distrust {
        let number = study.campaign.set_worker_aside(worker)?;
        print_message(format_args!("{number} evaluations by {worker} are repeated"));
        repeated += number;
    }
    let begins_leg = extended != study.settings || repeated > 0;
    let summary = study.campaign.document::<StudySummary>(SUMMARY_DOCUMENT)?;
    if let Some(summary) = summary.filter(|_| !begins_leg) {
        verbosity.say("this study is finished; writing its results again");
        write_results(&study.campaign, dir, &[])?;
        return match after_study(study, Machines::ToOpen(farm), verbosity)? {
            None => Ok(()),
            Some(study) => with_variants(study, farm, summary, None, verbosity),
        };
    }
    if !verbosity.quiet {
        say_what_is_done(&study, &extended)?;
    }
    study.settings = extended;
    let evaluator = CommandEvaluator::open(&study.source, &study.settings, true, farm)?;
    let monitor = Monitor::open(monitor, &evaluator, dir, study.scene(), &study.settings)?;
    study.campaign.forget_failed_start()?;
    // Another build computes what follows: from which evaluation on, the legs say.
    if begins_leg || study.campaign.leg_versions()?.last().is_none_or(|version| *version != program()) {
        let settings = serde_json::to_value(&study.settings)?;
        study.campaign.begin_leg(settings, &command_line(), &program())?;
    }
    finish(study, evaluator, monitor, farm, None, verbosity)
}

/// Learns the variants of the model that are missing, and prints the summary, as text or JSON, with R at a `confidence` if one is given.
fn with_variants(
    study: StoredStudy,
    farm: &FarmArguments,
    mut summary: StudySummary,
    confidence: Option<f64>,
    verbosity: Verbosity,
) -> Done {
    let StoredStudy { campaign, source, .. } = variants::after_study(study, farm, verbosity)?;
    summary.variants = summary_of(&campaign)?.variants;
    let stated = confidence.map(|confidence| at_confidence(&campaign.dir, confidence)).transpose()?;
    let page = stated.as_ref().map(|(answer, _)| answer.write(&campaign.dir)).transpose()?;
    if verbosity.json {
        let mut printed = serde_json::to_value(&summary)?;
        if let Some((_, confident)) = &stated {
            printed["confident"] = serde_json::to_value(confident)?;
        }
        return print(&to_json(&printed)?);
    }
    let nominal = campaign.evaluation(0)?.and_then(|stored| stored.outcome.ok());
    let cautions = nominal.map(|nominal| motion_cautions(source.nominal(), &nominal)).unwrap_or_default();
    let caution: String = cautions.iter().map(|caution| format!("caution: {}\n", caution.message)).collect();
    let confident =
        stated.zip(page).map(|((answer, _), page)| format!("\n{}\n{}\n", answer.text(), page.display()));
    print(&format!("{caution}{}{}", final_text(&summary, &campaign.dir), confident.unwrap_or_default()))
}

/// Version and build of this program.
fn program() -> String {
    format!("{} (build {})", env!("CARGO_PKG_VERSION"), worker::BUILD)
}

/// Says on standard error what a study goes on from.
fn say_what_is_done(study: &StoredStudy, extended: &Settings) -> Done {
    print_message(format_args!("{} evaluations are done already", study.campaign.count()?));
    let legs = study.campaign.leg_versions()?;
    let before = legs.iter().skip(1).last().unwrap_or(&study.campaign.meta.version);
    let ours = program();
    if *before != ours {
        print_message(format_args!(
            "they are by version {before} of the program, and those that follow by version {ours}: where the two compute \
             other digits, the study has both"
        ));
    }
    if extended.larger_populations != study.settings.larger_populations {
        print_message(format_args!(
            "the population grows to {} points once learning has ended on the present one, unless failures are so rare that it is \
             conditional: all results are used, where a new study of that size would choose other points",
            extended.population()
        ));
    }
    Ok(())
}

/// The command line of this process.
fn command_line() -> String {
    // A name of a file need not be UTF-8.
    std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}

/// Runs a study to its end and writes its results.
fn finish(
    mut study: StoredStudy,
    mut evaluator: CommandEvaluator,
    mut monitor: Monitor,
    farm: &FarmArguments,
    confidence: Option<f64>,
    verbosity: Verbosity,
) -> Done {
    evaluator.start_workers()?;
    let StoredStudy { campaign, source, settings } = &mut study;
    let scene = source.nominal();
    let dir = campaign.dir.clone();
    if !verbosity.quiet {
        evaluator.print_endpoints();
        monitor.print_addresses();
    }
    let mut terminal = Terminal::new(verbosity.quiet);
    let mut watch = monitor.watch(&scene.name, &mut terminal);
    let result = coordinator::study::run(scene, settings, evaluator.evaluator(), campaign, &mut watch);
    terminal.finish();
    let result = result.map_err(|error| CommandError::of_study(error, &dir));
    if let Err(error @ CommandError::Study { .. }) = &result {
        // For the commands that read the study; a failure to store the reason must not hide it here.
        let _ = campaign.put_document(END_DOCUMENT, &error.to_string());
    }
    let mut result = result?;
    result.summary.scale = evaluator.scale_row();
    result.summary.designs = design_keys(campaign)?;
    result.summary.identify(scene, &campaign.meta.scene_source, &campaign.created_at);
    if let Some(Ok(nominal)) = campaign.evaluation(0)?.map(|stored| stored.outcome) {
        result.summary.control_points = control_points_rows(scene, &nominal.diagnostics);
    }
    campaign.put_document(report::EXPLICIT_DOCUMENT, &result.explicit)?;
    report::deliver(campaign, scene, &result.summary, &for_report(scene, &result.distributions))?;
    monitor.end(verbosity.quiet);
    let unanswered = after_study(study, Machines::Open(&mut evaluator), verbosity)?;
    evaluator.close();
    if let Some(study) = unanswered {
        with_variants(study, farm, result.summary, confidence, verbosity)?;
    }
    monitor.serve()
}

/// Checks that the linkage can be assembled and turns at every end of the ranges of the design variables.
fn check_designs(space: &DesignSpace) -> Done {
    for values in space.corners() {
        let design = space.source_at(&values)?;
        if design.nominal().simulator.is_none() {
            check_linkage(&space.in_words(&values), &design, design.nominal())?;
        }
    }
    Ok(())
}

/// `hingewise-SCENE`, or that with the next free number.
fn free_folder(scene: &str) -> PathBuf {
    let tame = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '-' };
    let name = format!("hingewise-{}", scene.chars().map(tame).collect::<String>());
    let free = |name: &str| !Path::new(name).exists();
    let numbered = (2_u32..).map(|n| format!("{name}-{n}"));
    PathBuf::from(std::iter::once(name.clone()).chain(numbered).find(|name| free(name)).unwrap_or(name))
}

/// One entry per output and checkpoint.
fn for_report(scene: &Scene, distributions: &[Vec<OutputDistribution>]) -> Vec<CheckpointDistribution> {
    let all = scene.outputs.iter().zip(distributions).flat_map(|(output, all)| {
        scene.life.checkpoints().into_iter().zip(all).map(|(cycles, at)| {
            let (edges, counts) = bins(&at.histogram);
            let quantiles = PROBABILITIES.into_iter().zip(at.quantiles.iter().copied()).collect();
            let (output, mean, std) = (output.name.clone(), at.mean, at.std);
            CheckpointDistribution { output, cycles, mean, std, edges, counts, quantiles }
        })
    });
    all.collect()
}

/// Edges `(bins + 1,)`, increasing, and counts `(bins,)`; one narrow bin if every value is the same.
fn bins(histogram: &Histogram) -> (Vec<f64>, Vec<u64>) {
    let Histogram { from, to, counts } = histogram;
    let width = (to - from) / counts.len() as f64;
    let edges: Vec<f64> = (0..=counts.len()).map(|i| from + width * i as f64).collect();
    if edges.is_sorted_by(|a, b| a < b) {
        return (edges, counts.clone());
    }
    // Wide enough for different edges at any magnitude.
    let half = (1e-9 * from.abs()).max(f64::MIN_POSITIVE);
    (vec![from - half, to + half], vec![counts.iter().sum()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_increase_whatever_the_histogram() {
        let (edges, counts) = bins(&Histogram { from: 1.0, to: 3.0, counts: vec![5, 0, 2, 1] });
        assert_eq!((edges, counts), (vec![1.0, 1.5, 2.0, 2.5, 3.0], vec![5, 0, 2, 1]));
        for value in [0.0, 2e-5, -7.0] {
            let (edges, counts) = bins(&Histogram { from: value, to: value, counts: vec![9, 0, 0] });
            assert_eq!(counts, [9]);
            assert!(edges[0] < value && value < edges[1], "{edges:?}");
        }
    }
}
