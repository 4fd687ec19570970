//! Time against error of the accuracy settings of one scene: what each costs, and how far its outputs are from a
//! reference, at the nominal point and at random points of the variables.

mod page;
mod settings;

pub use page::{csv, figures, table};
pub use settings::{Setting, settings};

use common::failure::SimulationFailure;
use common::outputs::Evaluation;
use common::scene::Scene;

/// One setting at one point.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Time on one core [s].
    pub seconds: f64,
    /// What came of it.
    pub outcome: Result<Evaluation, SimulationFailure>,
}

/// How one output of a setting compares with the reference, over all points and checkpoints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutputError {
    /// Largest difference over the threshold of the output's limit state, or over its largest value where it has
    /// none [1].
    pub relative: f64,
    /// Largest displacement of the life at which the limit state is reached [cycles]; none where no point reaches it.
    pub life: Option<f64>,
    /// Share of the values within the error stated of them [1].
    pub within: f64,
    /// Share within twice that [1].
    pub within_twice: f64,
}

/// One setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The setting.
    pub setting: Setting,
    /// Mean time of an evaluation on one core [s].
    pub seconds: f64,
    /// Mean number of time steps.
    pub steps: f64,
    /// Points at which it failed.
    pub failures: usize,
    /// One per output of the scene; empty if it failed everywhere.
    pub outputs: Vec<OutputError>,
    /// Whether no other setting is both quicker and nearer in the worst of its outputs.
    pub efficient: bool,
}

impl Row {
    /// Error of its worst output.
    pub fn worst(&self) -> f64 {
        self.outputs.iter().fold(0.0, |a: f64, o| a.max(o.relative))
    }
}

/// Compares every setting with the reference: `measured` holds one list of points per setting, `reference` the same
/// points. Points that the reference could not simulate are left out.
pub fn compare(
    scene: &Scene,
    settings: Vec<Setting>,
    measured: &[Vec<Measured>],
    reference: &[Measured],
) -> Vec<Row> {
    let mut rows: Vec<Row> = settings
        .into_iter()
        .zip(measured)
        .map(|(setting, points)| {
            let pairs: Vec<(&Measured, &Evaluation, &Evaluation)> = points
                .iter()
                .zip(reference)
                .filter_map(|(m, r)| Some((m, m.outcome.as_ref().ok()?, r.outcome.as_ref().ok()?)))
                .collect();
            let mean = |of: &dyn Fn(&Measured, &Evaluation) -> f64| {
                pairs.iter().map(|(m, found, _)| of(m, found)).sum::<f64>() / pairs.len().max(1) as f64
            };
            let outputs = (0..scene.outputs.len()).map(|k| output_error(scene, k, &pairs));
            Row {
                setting,
                seconds: mean(&|m, _| m.seconds),
                steps: mean(&|_, found| found.diagnostics.steps as f64),
                failures: points.iter().filter(|m| m.outcome.is_err()).count(),
                outputs: if pairs.is_empty() { vec![] } else { outputs.collect() },
                efficient: false,
            }
        })
        .collect();
    for k in 0..rows.len() {
        let (seconds, worst) = (rows[k].seconds, rows[k].worst());
        let beaten = rows.iter().any(|other| {
            !other.outputs.is_empty()
                && other.seconds <= seconds
                && other.worst() <= worst
                && (other.seconds < seconds || other.worst() < worst)
        });
        rows[k].efficient = !rows[k].outputs.is_empty() && !beaten;
    }
    rows
}

fn output_error(scene: &Scene, k: usize, pairs: &[(&Measured, &Evaluation, &Evaluation)]) -> OutputError {
    let threshold = scene.limit_states.iter().filter(|l| l.output == k).map(|l| l.threshold).reduce(f64::min);
    let largest =
        pairs.iter().flat_map(|(.., r)| &r.histories[k]).fold(f64::MIN_POSITIVE, |a, x| a.max(x.abs()));
    let scale = threshold.unwrap_or(largest);
    let (mut relative, mut life) = (0.0_f64, None);
    let (mut values, mut within, mut within_twice) = (0, 0, 0);
    for (_, found, reference) in pairs {
        let (found_history, true_history) = (&found.histories[k], &reference.histories[k]);
        for ((x, truth), stated) in found_history.iter().zip(true_history).zip(&found.errors[k]) {
            let off = (x - truth).abs();
            relative = relative.max(off / scale);
            values += 1;
            within += usize::from(off <= *stated);
            within_twice += usize::from(off <= 2.0 * stated);
        }
        let crossing = |history: &[f64]| threshold.and_then(|limit| crossing(&found.cycles, history, limit));
        if let (Some(a), Some(b)) = (crossing(found_history), crossing(true_history)) {
            life = Some(life.unwrap_or(0.0_f64).max((a - b).abs()));
        }
    }
    let share = |count: usize| count as f64 / f64::from(values.max(1));
    OutputError { relative, life, within: share(within), within_twice: share(within_twice) }
}

/// Life at which a history first reaches a limit, by linear interpolation [cycles].
fn crossing(cycles: &[u32], history: &[f64], limit: f64) -> Option<f64> {
    let k = history.iter().position(|x| *x >= limit)?;
    if k == 0 {
        return Some(f64::from(cycles[0]));
    }
    let (n0, n1, y0, y1) = (f64::from(cycles[k - 1]), f64::from(cycles[k]), history[k - 1], history[k]);
    Some(n0 + (n1 - n0) * (limit - y0) / (y1 - y0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::outputs::Diagnostics;
    use common::scene::SceneSource;

    fn measured(seconds: f64, history: Vec<f64>, stated: f64) -> Measured {
        let errors = vec![vec![stated; history.len()]; 2];
        let evaluation = Evaluation {
            cycles: (1..=history.len() as u32).map(|k| 1000 * k).collect(),
            histories: vec![history.clone(), history],
            errors,
            joints: vec![],
            first_cycle: None,
            diagnostics: Diagnostics { steps: 100, ..Diagnostics::default() },
        };
        Measured { seconds, outcome: Ok(evaluation) }
    }

    #[test]
    fn errors_lives_and_the_front_are_those_of_made_up_histories() {
        let source = SceneSource::builtin("flapping-wing").expect("built in");
        let mut scene = source.nominal().clone();
        (scene.limit_states[0].threshold, scene.limit_states[1].threshold) = (2.5, 100.0);
        let reference = [measured(9.0, vec![1.0, 2.0, 3.0, 4.0], 0.0)];
        let found = [
            // Half a unit too high: 2.5 is reached 500 cycles early.
            vec![measured(1.0, vec![1.5, 2.5, 3.5, 4.5], 0.3)],
            // Slower and worse.
            vec![measured(2.0, vec![2.0, 3.0, 4.0, 5.0], 1.0)],
            vec![measured(3.0, vec![1.0, 2.0, 3.0, 4.25], 0.1)],
        ];
        let three: Vec<Setting> = settings().into_iter().take(3).collect();
        let rows = compare(&scene, three, &found, &reference);
        let first = rows[0].outputs[0];
        assert_eq!((first.relative, first.life), (0.5 / 2.5, Some(500.0)));
        assert_eq!((first.within, first.within_twice), (0.0, 1.0));
        assert_eq!(rows[0].outputs[1].life, None, "nothing reaches 100");
        assert_eq!(rows[2].outputs[0].within, 0.75);
        assert_eq!(rows.iter().map(|r| r.efficient).collect::<Vec<_>>(), [true, false, true]);
        let table = table(&scene, &rows, 1);
        assert!(table.contains("500 cycles"), "{table}");
        assert_eq!(csv(&scene, &rows).lines().count(), 4);
        assert_eq!(figures(&scene, &rows).expect("drawn").len(), 2);
    }

    #[test]
    fn a_setting_that_fails_everywhere_has_no_errors_and_is_on_no_front() {
        let source = SceneSource::builtin("four-bar").expect("built in");
        let failure = SimulationFailure::NotModelled { what: "this".into() };
        let failed = vec![vec![Measured { seconds: 0.1, outcome: Err(failure) }]];
        let reference = [measured(9.0, vec![1.0; 4], 0.0)];
        let rows = compare(source.nominal(), settings().into_iter().take(1).collect(), &failed, &reference);
        assert_eq!((rows[0].failures, rows[0].outputs.len(), rows[0].efficient), (1, 0, false));
        assert!(table(source.nominal(), &rows, 1).contains("failed"));
    }
}
