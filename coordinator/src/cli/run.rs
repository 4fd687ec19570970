//! `coordinator run` and `coordinator resume`: a study from its scene to its report.
//!
//! scene -> checks -> folder -> listen -> local workers -> study -> result files -> report

use super::arguments::{DEFAULT_SCENE, ResumeArguments, RunArguments, Talk};
use super::distributions::for_report;
use super::error::CommandError;
use super::external;
use super::farm::{Crew, Ready, cores, local_slots};
use super::monitor::Monitor;
use super::options::StudyOptions;
use super::output::{print, to_json};
use super::results::write_results;
use super::scenes::check_linkage;
use super::signals::interruption;
use common::scene::{Scene, SceneSource};
use coordinator::farm::dispatch::Campaign;
use coordinator::presentation::report::{DISTRIBUTIONS_DOCUMENT, SUMMARY_DOCUMENT};
use coordinator::presentation::terminal::{Terminal, final_text};
use coordinator::results::store::{CampaignFile, CampaignMeta, FILE_NAME};
use coordinator::results::summary::StudySummary;
use std::path::{Path, PathBuf};

/// Starts a study.
pub fn run(arguments: &RunArguments, talk: Talk) -> Result<(), CommandError> {
    let source = SceneSource::load(arguments.scene.as_deref().unwrap_or(DEFAULT_SCENE))?;
    let scene = source.nominal();
    if scene.variables.is_empty() || scene.limit_states.is_empty() {
        return Err(CommandError::NothingToStudy { origin: source.origin().to_owned() });
    }
    if scene.simulator.is_some() {
        external::check_accuracy(source.origin(), &arguments.accuracy)?;
    } else {
        check_linkage(source.origin(), scene)?;
    }
    let mut options = StudyOptions::new(arguments, scene)?;
    // The points at which accuracies are tried are those of the study's seed.
    let seeded = Scene { study: options.settings().study, ..scene.clone() };
    let threads = Some(local_slots(&arguments.farm)).filter(|slots| *slots > 0).unwrap_or_else(cores);
    let interrupted = interruption().map_err(CommandError::Signals)?;
    options.accuracy = arguments.accuracy.for_study(&source, &seeded, threads, talk.quiet, interrupted)?;
    let dir = arguments.out.clone().unwrap_or_else(|| free_folder(&scene.name));
    let meta = CampaignMeta {
        scene: scene.name.clone(),
        scene_source: source.text().to_owned(),
        settings: serde_json::to_value(&options)?,
        command: std::env::args().collect::<Vec<_>>().join(" "),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    // An address that cannot be listened on must not leave a folder behind that holds a study.
    let ready = Ready::to_study(&source, || announced(&source, &options, false), &arguments.farm)?;
    let monitor =
        Monitor::open(&arguments.monitor, arguments.farm.insecure, &ready, (&dir, &source, &options))?;
    let campaign = CampaignFile::create(&dir, &meta, scene)?;
    if !talk.quiet {
        eprintln!("results go to {}", dir.display());
    }
    study(campaign, &source, &options, ready.hire(&arguments.farm)?, monitor, talk)
}

/// Goes on with a study.
pub fn resume(arguments: &ResumeArguments, talk: Talk) -> Result<(), CommandError> {
    let campaign = CampaignFile::open(&arguments.dir)?;
    if let Some(summary) = campaign.document::<StudySummary>(SUMMARY_DOCUMENT)? {
        if !talk.quiet {
            eprintln!("this study is finished; writing its results again");
        }
        write_results(&campaign)?;
        return tell(&summary, campaign.dir(), talk);
    }
    let origin = arguments.dir.join(FILE_NAME).display().to_string();
    let source = SceneSource::parse(&campaign.meta().scene_source, &origin)?;
    let mut options: StudyOptions = serde_json::from_value(campaign.meta().settings.clone())
        .map_err(|error| CommandError::ForeignSettings { file: origin, reason: error.to_string() })?;
    options.accuracy = options.accuracy.exact();
    if !talk.quiet {
        eprintln!("{} evaluations are done already", campaign.count()?);
    }
    let ready = Ready::to_study(&source, || announced(&source, &options, true), &arguments.farm)?;
    let about = (arguments.dir.as_path(), &source, &options);
    let monitor = Monitor::open(&arguments.monitor, arguments.farm.insecure, &ready, about)?;
    study(campaign, &source, &options, ready.hire(&arguments.farm)?, monitor, talk)
}

fn study(
    mut campaign: CampaignFile,
    source: &SceneSource,
    options: &StudyOptions,
    mut crew: Crew,
    monitor: Monitor,
    talk: Talk,
) -> Result<(), CommandError> {
    let settings = options.settings();
    let scene = Scene { study: settings.study, ..source.nominal().clone() };
    let dir = campaign.dir().to_path_buf();
    if !talk.quiet {
        crew.say_where();
        monitor.say_where();
    }
    let mut terminal = Terminal::new(talk.quiet);
    let mut watch = monitor.watch(&scene.name, &mut terminal);
    let result = coordinator::study::run(&scene, &settings, crew.evaluator(), &mut campaign, &mut watch);
    terminal.finish();
    let mut result = result.map_err(|error| CommandError::of_study(error, &dir))?;
    let timing = &mut result.summary.timing_s;
    timing.idle *= f64::from(crew.concurrency());
    crew.close();
    campaign.put_document(DISTRIBUTIONS_DOCUMENT, &for_report(&result.distributions))?;
    // The summary comes last: with it, the study counts as finished.
    campaign.put_document(SUMMARY_DOCUMENT, &result.summary)?;
    write_results(&campaign)?;
    monitor.end();
    tell(&result.summary, &dir, talk)
}

/// What workers are told. A study has the same number whenever it is resumed.
fn announced(source: &SceneSource, options: &StudyOptions, resumed: bool) -> Result<Campaign, CommandError> {
    let settings = serde_json::to_string(options)?;
    let digest = common::scene::source::digest(&format!("{settings}\n{}", source.text()));
    Ok(Campaign {
        // The low half of a 128-bit hash is a 64-bit hash.
        id: digest as u64,
        scene: source.text().to_owned(),
        accuracy: options.accuracy.setting.accuracy,
        accuracy_name: options.accuracy.setting.name.clone(),
        resumed,
    })
}

/// `hingewise-SCENE`, or that with the next number that is free.
fn free_folder(scene: &str) -> PathBuf {
    let tame = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '-' };
    let name = format!("hingewise-{}", scene.chars().map(tame).collect::<String>());
    let free = |name: &str| !Path::new(name).exists();
    let numbered = (2_u32..).map(|n| format!("{name}-{n}"));
    let found = std::iter::once(name.clone()).chain(numbered).find(|name| free(name));
    PathBuf::from(found.unwrap_or(name))
}

/// The answer, for people or programs.
fn tell(summary: &StudySummary, dir: &Path, talk: Talk) -> Result<(), CommandError> {
    if talk.json { print(&to_json(summary)?) } else { print(&final_text(summary, dir)) }
}
