//! How accurate a command's evaluations are: by name, or as cheap as an error budget allows.

use super::error::CommandError;
use clap::Args;
use common::accuracy::{Accuracy, NamedAccuracy};
use common::failure::SimulationFailure;
use common::scene::{Faults, Scene, SceneSource};
use coordinator::analyses::budget::{Attempt, LADDER, RANDOM_POINTS, choose};
use coordinator::farm::evaluate::local::LocalEvaluator;
use coordinator::farm::evaluate::{Evaluator, Request};
use coordinator::presentation::report::format::short_percent;
use coordinator::statistics::design::nominal_and_random;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Options on accuracy.
#[derive(Debug, Clone, Default, Args, PartialEq)]
pub struct AccuracyArguments {
    /// Numerical effort of an evaluation [default: the scene's, else balanced]: draft, balanced, reference, or one of them with
    /// knobs turned, e.g. draft+step-x0.71+jump-4000 (see `tradeoff`)
    #[arg(long, value_name = "draft|balanced|reference|NAME")]
    pub accuracy: Option<NamedAccuracy>,
    /// Let the program find the cheapest accuracy whose stated errors stay below this share of the limit, for every output
    /// with a limit state, e.g. 1%
    #[arg(long, value_name = "SHARE", value_parser = share, conflicts_with = "accuracy")]
    pub max_error: Option<f64>,
}

/// An accuracy, and the budget it was found for if there is one.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Accepted {
    /// The accuracy, by name and with every knob.
    pub setting: NamedAccuracy,
    /// Error budget, as a share of the limits [1].
    pub max_error: Option<f64>,
}

impl Accepted {
    /// What a campaign file holds, to the last bit: numbers read from JSON may differ in it, while the name gives them
    /// exactly, unless it stands for something else by now; then the numbers of the file hold.
    pub fn exact(self) -> Self {
        let kept = self.setting.accuracy;
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs();
        let named = self.setting.name.parse::<NamedAccuracy>().ok().filter(|named| {
            let a = named.accuracy;
            let rounded = Accuracy {
                step_tolerance: a.step_tolerance,
                largest_step: a.largest_step,
                jump_tolerance: a.jump_tolerance,
                wear_tolerance: a.wear_tolerance,
                warm_up: a.warm_up,
                ..kept
            };
            near(a.step_tolerance, kept.step_tolerance)
                && near(a.largest_step, kept.largest_step)
                && near(a.jump_tolerance, kept.jump_tolerance)
                && near(a.wear_tolerance, kept.wear_tolerance)
                && near(a.warm_up, kept.warm_up)
                && rounded == a
        });
        Accepted { setting: named.unwrap_or(self.setting), ..self }
    }
}

impl AccuracyArguments {
    /// The accuracy of a study of a scene: that named, or one found at the nominal point and [`RANDOM_POINTS`] others,
    /// which are those of the seed whatever the machine.
    pub fn for_study(
        &self,
        source: &SceneSource,
        scene: &Scene,
        threads: usize,
        quiet: bool,
        interrupted: Arc<AtomicBool>,
    ) -> Result<Accepted, CommandError> {
        let simulate = |request: &Request| {
            let invalid = |faults: Faults| SimulationFailure::InvalidSample { faults: faults.to_string() };
            let scene = source.resolve_sample(&request.sample).map_err(invalid)?;
            let accuracy = request.accuracy.unwrap_or_default();
            worker::simulate::simulate(&scene, &accuracy, request.with_first_cycle)
        };
        let evaluator = LocalEvaluator::new(threads, simulate).interrupted_by(interrupted);
        self.found(scene, &nominal_and_random(scene, RANDOM_POINTS), quiet, evaluator)
    }

    /// The accuracy of one evaluation of a scene as it is: that named, or one found there.
    pub fn for_one(&self, scene: &Scene, quiet: bool) -> Result<Accepted, CommandError> {
        let simulate = |request: &Request| {
            worker::simulate::simulate(scene, &request.accuracy.unwrap_or_default(), request.with_first_cycle)
        };
        self.found(scene, &[vec![]], quiet, LocalEvaluator::new(1, simulate))
    }

    fn found(
        &self,
        scene: &Scene,
        points: &[Vec<f64>],
        quiet: bool,
        mut evaluator: impl Evaluator,
    ) -> Result<Accepted, CommandError> {
        let Some(budget) = self.max_error else {
            let setting = self.accuracy.clone().unwrap_or_else(|| scene.accuracy.clone());
            return Ok(Accepted { setting, max_error: None });
        };
        let choice = choose(scene, budget, &LADDER, points, &mut evaluator, &mut |attempt| {
            if !quiet {
                eprintln!("{}", told(attempt, budget));
            }
        })?;
        if !quiet {
            eprintln!(
                "accuracy {}: the cheapest tried that states errors below {} at {}",
                choice.setting.name,
                short_percent(budget),
                if points.len() == 1 { "this point".to_owned() } else { format!("{} points", points.len()) }
            );
        }
        Ok(Accepted { setting: choice.setting, max_error: Some(budget) })
    }
}

fn told(attempt: &Attempt, budget: f64) -> String {
    let name = &attempt.setting.name;
    match &attempt.worst {
        Ok(worst) => {
            let verdict = if worst.error <= budget { "within" } else { "over" };
            format!(
                "tried {name}: {} of {}, {verdict} {}",
                short_percent(worst.error),
                worst.output,
                short_percent(budget)
            )
        }
        Err(failure) => format!("tried {name}: {failure}"),
    }
}

/// A share: `1%`, `1 %` or `0.01`.
pub fn share(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(percent) => (percent.trim_end(), 100.0),
        None => (text, 1.0),
    };
    let share = number.parse::<f64>().map(|x| x / scale);
    share
        .ok()
        .filter(|x| *x > 0.0 && *x <= 1.0)
        .ok_or_else(|| "allowed: a share above 0 and up to 1, e.g. 1%, 0.5% or 0.01".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_percent_or_plain() {
        assert_eq!(
            [share("1%"), share("1 %"), share("0.01"), share("100%")],
            [Ok(0.01), Ok(0.01), Ok(0.01), Ok(1.0)]
        );
        for slip in ["0", "0%", "-1%", "101%", "1.5", "nan", "inf", "", "%", "one", "1%%"] {
            assert!(share(slip).is_err(), "{slip}");
        }
    }

    #[test]
    fn without_a_budget_nothing_is_tried() {
        let source = SceneSource::builtin("four-bar").expect("built in");
        let named = AccuracyArguments { accuracy: "draft+jump-500".parse().ok(), max_error: None };
        let found = named.for_one(source.nominal(), true).expect("nothing to try");
        assert_eq!((found.setting.accuracy.cycle_jump, found.max_error), (500, None));
        let none = AccuracyArguments::default().for_study(&source, source.nominal(), 1, true, Arc::default());
        assert_eq!(none.expect("nothing to try"), Accepted::default());
    }
}
