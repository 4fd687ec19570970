//! One evaluation in a few lines: outputs at the start and at the end of life, limits, margins and expected lives, work.

use super::output::count;
use common::outputs::Evaluation;
use common::scene::{Output, Scene};
use coordinator::presentation::nominal_life::nominal_lives;
use coordinator::presentation::report::format::{count as grouped, duration, three_digits};
use std::path::Path;

/// The lines about an evaluation that is written to `file`.
pub fn text(scene: &Scene, accuracy: &str, evaluation: &Evaluation, wall: f64, file: &Path) -> String {
    let cycles = evaluation.cycles.last().copied().unwrap_or_default();
    let mut text = format!(
        "{}: {} cycles, accuracy {accuracy}, {} in {}\n",
        scene.name,
        grouped(cycles.into()),
        count(evaluation.diagnostics.steps as usize, "step"),
        duration(wall)
    );
    for (i, output) in scene.outputs.iter().enumerate() {
        text += &line(output, evaluation, i);
    }
    for life in nominal_lives(scene, evaluation) {
        text += &format!("limit state {}", life.line(cycles));
    }
    text += &format!("written: {}\n", file.display());
    text.replace('\u{a0}', " ")
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
        let text = text(&scene, "draft", &evaluation, 0.25, Path::new("one.json"));
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
    }
}
