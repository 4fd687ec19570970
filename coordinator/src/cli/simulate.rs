//! `coordinator simulate`: runs one evaluation in this process and prints it, as JSON for scripts and in lines for a person.

use super::evaluation_json::{of_mechanism, of_outputs};
use super::external;
use super::output::{check_destination, deliver, file_of};
use super::scene_options::SceneName;
use super::{AccuracyArguments, CommandError, Done, Verbosity, check_linkage, count, print, to_json};
use clap::Args;
use common::outputs::{Evaluation, NarrowGroove};
use common::scene::{Fault, Faults, Output, OutputUnit, Scene, SceneSource};
use coordinator::analyses::scene_settings::scene_with;
use coordinator::presentation::motion_cautions::cautions;
use coordinator::presentation::nominal_life::nominal_lives;
use coordinator::presentation::report::ReportInput;
use coordinator::presentation::report::format::{
    count as grouped, duration, number_of_cycles, three_digits, with_unit,
};
use coordinator::presentation::report::nominal_page::page;
use coordinator::results::result_files::write_text;
use coordinator::results::summary_rows::control_points_rows;
use coordinator::study::{Settings, blank};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Instant;
use worker::simulate::{self, SimulateOptions};

/// Arguments of `coordinator simulate`.
#[derive(Debug, Clone, Args)]
pub struct SimulateArguments {
    #[command(flatten)]
    pub scene: SceneName,
    /// Set a quantity of the scene by its key, or a random variable by its name, e.g. rod_length=40.05mm; repeatable
    #[arg(long, value_name = "KEY=VALUE", help_heading = "Scene")]
    pub set: Vec<String>,
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Write the JSON to simulate.json in this folder, created if missing, instead of standard output; a path with an ending is the file
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Write a page with figures: outputs over life against the limits, motion, worn bores, first and last cycle
    #[arg(long, value_name = "FILE.html", help_heading = "Output")]
    pub report: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`].
pub fn simulate(arguments: &SimulateArguments, verbosity: Verbosity) -> Done {
    let out = arguments.out.as_deref().map(|out| file_of(out, "simulate.json")).transpose()?;
    check_destination(arguments.report.as_deref())?;
    let mut source = SceneSource::load(arguments.scene.get())?;
    let settings = source.parse_settings(&arguments.set)?;
    let mut cautioned = Vec::new();
    let (scene, accuracy, evaluation, wall) = if let Some(simulator) = source.nominal().simulator.clone() {
        external::check_accuracy(&source, &arguments.accuracy)?;
        // What is no variable changes the scene around the simulator.
        let (of_sample, of_scene): (Vec<_>, Vec<_>) = settings
            .iter()
            .cloned()
            .zip(&arguments.set)
            .partition(|((name, _), _)| source.variable(name).is_some());
        if !of_scene.is_empty() {
            let set: Vec<String> = of_scene.into_iter().map(|(_, text)| text.clone()).collect();
            source = scene_with(&source, &set)?;
        }
        let of_sample: Vec<_> = of_sample.into_iter().map(|(setting, _)| setting).collect();
        let sample = source.sample_with(&of_sample)?;
        let scene = source.resolve_sample(&sample)?;
        let accuracy = simulator.cycles.as_ref().map(|_| scene.accuracy.name.clone());
        let (evaluation, wall) = external::simulate(&source, sample)?;
        (scene, accuracy, evaluation, wall)
    } else {
        let scene = source.resolve_with(&settings).map_err(one_of_each_cause)?;
        cautioned = check_linkage(source.origin(), &source, &scene)?;
        let accuracy = arguments.accuracy.for_one(&scene, verbosity.quiet)?.setting;
        let start = Instant::now();
        let evaluation = simulate::simulate(&scene, &accuracy.accuracy, SimulateOptions::WITH_FIRST_CYCLE)
            .map_err(|failure| CommandError::of_simulation(source.origin(), &scene, failure))?;
        (scene, Some(accuracy.name), evaluation, start.elapsed().as_secs_f64())
    };
    let cautioned = [cautioned, cautions(&scene, &evaluation)].concat();
    let simulated = Simulated {
        scene: &scene,
        accuracy: accuracy.as_deref(),
        evaluation: &evaluation,
        cautions: cautioned.into_iter().map(|caution| caution.message).collect(),
        wall,
    };
    if let Some(file) = &arguments.report {
        write_text(file, &simulated.report(&arguments.set, source.text()))?;
    }
    // A person reads lines, a script the object.
    let to_person = !verbosity.json && out.is_none() && std::io::stdout().is_terminal();
    if !to_person {
        let mut all = of_outputs(&scene, &settings, &evaluation, wall);
        all.extend(accuracy.iter().flat_map(|accuracy| of_mechanism(&scene, accuracy, &evaluation)));
        all.insert("cautions".to_owned(), simulated.cautions.as_slice().into());
        deliver(&to_json(&all)?, out.as_deref())?;
    }
    let files: Vec<&Path> = [&out, &arguments.report].into_iter().flatten().map(PathBuf::as_path).collect();
    let has_lines = to_person || out.is_some();
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

/// One evaluation and how it was made.
struct Simulated<'e> {
    /// The scene with its settings.
    pub scene: &'e Scene,
    /// Name of the accuracy; none of a simulator that has its own.
    pub accuracy: Option<&'e str>,
    /// Result of the simulation.
    pub evaluation: &'e Evaluation,
    /// What is to be said about it.
    pub cautions: Vec<String>,
    /// Time that it took [s].
    pub wall: f64,
}

impl Simulated<'_> {
    /// The lines for a person, with the files that were written.
    pub fn text(&self, files: &[&Path]) -> String {
        let Self { scene, evaluation, .. } = self;
        let cycles = evaluation.cycles.last().copied().unwrap_or_default();
        let mut text = format!("{}: {}\n", scene.name, self.work());
        for (i, output) in scene.outputs.iter().enumerate() {
            text += &line(output, &scene.unit_of(output), evaluation, i);
        }
        for life in nominal_lives(scene, evaluation) {
            text += &format!("limit state {}", life.line(cycles));
        }
        for NarrowGroove { joint, since, angle, open, .. } in &evaluation.diagnostics.narrow_grooves {
            let shown = |usual, value: f64| with_unit(&scene.units.of(usual), value);
            text += &format!(
                "joint {joint}: a groove at {} is narrower than the journal, which stays {} above its bottom; first at {} cycles\n",
                shown(OutputUnit::Angle, *angle),
                shown(OutputUnit::Length, *open),
                grouped((*since).into())
            );
        }
        for caution in &self.cautions {
            text += &format!("caution: {caution}\n");
        }
        for file in files {
            text += &format!("written: {}\n", file.display());
        }
        text.replace('\u{a0}', " ")
    }

    /// The page of the evaluation; `set` are its settings as given, `source` is the text of its scene.
    pub fn report(&self, set: &[String], source: &str) -> String {
        let Self { scene, evaluation, .. } = self;
        let mut summary = blank(scene, &Settings::from(scene.study));
        summary.control_points = control_points_rows(scene, &evaluation.diagnostics);
        let mut input = ReportInput::of_one(scene, summary, Some((*evaluation).clone()));
        let more: Vec<String> =
            self.cautions.iter().filter(|caution| !input.notes.contains(caution)).cloned().collect();
        input.notes.splice(0..0, more);
        let set =
            if set.is_empty() { "every random variable at its mean".to_owned() } else { set.join(", ") };
        let facts = [
            ("scene", scene.name.clone()),
            ("set", set),
            ("work", self.work()),
            ("version", format!("Hingewise {}", env!("CARGO_PKG_VERSION"))),
        ];
        page(&input, &facts, source).html(None)
    }

    /// Life, accuracy, time steps or cycles simulated, and time.
    fn work(&self) -> String {
        let cycles = self.evaluation.cycles.last().copied().unwrap_or_default();
        let work = &self.evaluation.diagnostics;
        let done = match self.scene.simulator {
            None => count(work.steps as usize, "step"),
            Some(_) => count(work.simulated_cycles as usize, "simulated cycle"),
        };
        let by = self.accuracy.map(|accuracy| format!(", accuracy {accuracy}, {done}")).unwrap_or_default();
        format!("{}{by} in {}", number_of_cycles(cycles), duration(self.wall))
    }
}

/// An output at the start and at the end of life, with its stated numerical error.
fn line(output: &Output, unit: &OutputUnit, evaluation: &Evaluation, i: usize) -> String {
    let shown = |value: f64| three_digits(unit.to_shown(value));
    let last = |rows: &[Vec<f64>]| rows.get(i).and_then(|row| row.last()).copied();
    let start = evaluation.start.get(i).copied().flatten();
    let from = start.map(|value| format!("{} unworn, ", shown(value))).unwrap_or_default();
    let end = last(&evaluation.histories).map_or_else(String::new, shown);
    let error = last(&evaluation.errors).map(|error| format!(" ± {}", shown(error))).unwrap_or_default();
    format!("{}: {from}{} at the end of life\n", output.name, unit.after(&format!("{end}{error}")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;

    #[test]
    fn a_person_reads_values_limits_margins_and_life() {
        let scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let depths: Vec<f64> = (1..=8).map(|k| 1.25e-6 * f64::from(k)).collect();
        let cycles = (1..=8).map(|k| 1000 * k).collect();
        let mut evaluation = Evaluation::from_histories(cycles, vec![depths, vec![44.4; 8]]);
        evaluation.start = vec![Some(0.0), None];
        evaluation.errors = vec![vec![1e-7; 8], vec![0.1; 8]];
        let text = |evaluation: &Evaluation, files: &[&Path]| {
            let (accuracy, cautions) = (Some("draft"), vec![]);
            Simulated { scene: &scene, accuracy, evaluation, cautions, wall: 0.25 }.text(files)
        };
        let shown = text(&evaluation, &[Path::new("one.json")]);
        let lines: Vec<&str> = shown.lines().collect();
        assert_eq!(lines[0], "four-bar: 8 000 cycles, accuracy draft, 0 steps in 0.2 s");
        assert!(
            lines[1].starts_with("max_wear_depth: ")
                && lines[1].ends_with("10.0 ± 0.100 µm at the end of life")
        );
        assert!(lines[2].starts_with("coupler_joint_speed: 424 ± 0.955 r/min"), "{shown}");
        assert!(
            lines[3].starts_with("limit state wear: 10.0 µm after 8 000 cycles, limit 8.00 µm, margin -25 %"),
            "{shown}"
        );
        assert_eq!(lines[4..], ["written: one.json"]);
        let once = Evaluation::from_histories(vec![1], vec![vec![1e-6], vec![44.4]]);
        assert!(text(&once, &[]).starts_with("four-bar: 1 cycle, accuracy draft, "), "{}", text(&once, &[]));
        evaluation.diagnostics.narrow_grooves =
            vec![NarrowGroove { joint: "crank".into(), since: 4000, angle: 1.0, width: 0.3, open: 1.25e-6 }];
        let text = text(&evaluation, &[]);
        let line = "joint crank: a groove at 57.3 deg is narrower than the journal, which stays 1.25 µm above its bottom; \
                    first at 4 000 cycles\n";
        assert!(text.ends_with(line), "{text}");
    }
}
