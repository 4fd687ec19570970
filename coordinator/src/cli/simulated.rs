//! One evaluation in a few lines: outputs at the start and at the end of life, limits, margins and expected lives, work.

use super::output::count;
use common::outputs::{Evaluation, NarrowGroove};
use common::scene::{Output, Scene};
use coordinator::presentation::motion_cautions::cautions;
use coordinator::presentation::nominal_life::nominal_lives;
use coordinator::presentation::report::format::{count as grouped, duration, three_digits};
use coordinator::presentation::report::nominal_page::NominalView;
use coordinator::results::control_points::control_points_rows;
use coordinator::study::{Settings, blank};
use std::path::Path;

/// One evaluation and how it was made.
pub struct Simulated<'e> {
    /// The scene with its settings.
    pub scene: &'e Scene,
    /// Name of the accuracy.
    pub accuracy: &'e str,
    /// Result of the simulation.
    pub evaluation: &'e Evaluation,
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
            text += &line(output, evaluation, i);
        }
        for life in nominal_lives(scene, evaluation) {
            text += &format!("limit state {}", life.line(cycles));
        }
        for NarrowGroove { joint, since, angle, open, .. } in &evaluation.diagnostics.narrow_grooves {
            text += &format!(
                "joint {joint}: a groove at {:.0} deg is narrower than the journal, which stays {} µm above its bottom; \
                 first at {} cycles\n",
                angle.to_degrees(),
                three_digits(1e6 * open),
                grouped((*since).into())
            );
        }
        for caution in cautions(scene, &evaluation.diagnostics) {
            text += &format!("caution: {}\n", caution.message);
        }
        for file in files {
            text += &format!("written: {}\n", file.display());
        }
        text.replace('\u{a0}', " ")
    }

    /// The page of the evaluation; `set` are its settings as given, `source` is the text of its scene.
    ///
    /// # Errors
    /// [`CommandError::Report`] if a figure cannot be drawn.
    pub fn report(&self, set: &[String], source: &str) -> String {
        let Self { scene, evaluation, .. } = self;
        let mut summary = blank(scene, &Settings::from(scene.study));
        summary.control_points = control_points_rows(scene, &evaluation.diagnostics);
        let view = NominalView { scene, summary, evaluation: Some(evaluation), drawing: None };
        let set =
            if set.is_empty() { "every random variable at its mean".to_owned() } else { set.join(", ") };
        let facts = [
            ("scene", scene.name.clone()),
            ("set", set),
            ("work", self.work()),
            ("version", format!("Hingewise {}", env!("CARGO_PKG_VERSION"))),
        ];
        view.page(&facts, source).html(None)
    }

    /// Life, accuracy, steps and time.
    fn work(&self) -> String {
        let cycles = self.evaluation.cycles.last().copied().unwrap_or_default();
        let steps = count(self.evaluation.diagnostics.steps as usize, "step");
        format!(
            "{} cycles, accuracy {}, {steps} in {}",
            grouped(cycles.into()),
            self.accuracy,
            duration(self.wall)
        )
    }
}

/// An output at the start and at the end of life, with its stated numerical error.
fn line(output: &Output, evaluation: &Evaluation, i: usize) -> String {
    let unit = output.kind.unit();
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
        let simulated = Simulated { scene: &scene, accuracy: "draft", evaluation: &evaluation, wall: 0.25 };
        let text = simulated.text(&[Path::new("one.json")]);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "four-bar: 8 000 cycles, accuracy draft, 0 steps in 0.2 s");
        assert!(
            lines[1].starts_with("max_wear_depth: ")
                && lines[1].ends_with("10.0 ± 0.100 µm at the end of life")
        );
        assert!(lines[2].starts_with("coupler_joint_speed: 424 ± 0.955 r/min"), "{text}");
        assert!(
            lines[3].starts_with("limit state wear: 10.0 µm after 8 000 cycles, limit 8.00 µm, margin -25 %"),
            "{text}"
        );
        assert_eq!(lines[4..], ["written: one.json"]);
        evaluation.diagnostics.narrow_grooves =
            vec![NarrowGroove { joint: "crank".into(), since: 4000, angle: 1.0, width: 0.3, open: 1.25e-6 }];
        let simulated = Simulated { scene: &scene, accuracy: "draft", evaluation: &evaluation, wall: 0.25 };
        let text = simulated.text(&[]);
        let line = "joint crank: a groove at 57 deg is narrower than the journal, which stays 1.25 µm above its bottom; \
                    first at 4 000 cycles\n";
        assert!(text.ends_with(line), "{text}");
    }
}
