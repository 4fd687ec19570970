//! Active learning on the simulations of a direct Monte Carlo study: they take the place of the simulator, and their
//! samples are the population. The error of every round is therefore known, and a change of the learner can be judged
//! on a real mechanism in seconds.

use crate::against::{first_failures, observations};
use crate::simulated::{SimulatedPoint, completed};
use common::failure::SimulationFailure;
use common::scene::Scene;
use coordinator::statistics::learning::{StoppingTargets, curves, with_system};
use coordinator::study::{Campaign, Observed, Plan, Problem, Settings, StopReason, StudyError, Surrogate};
use std::collections::HashMap;
use std::time::Instant;
use thiserror::Error;

/// An error of a replay.
#[derive(Debug, Error)]
pub enum ReplayError {
    /// The samples are not the first points of the population of this seed.
    #[error(
        "sample {0} is not that of the study's seed; expected a direct Monte Carlo run (--method monte-carlo) without failed \
         simulations"
    )]
    Foreign(usize),
    /// The surrogates cannot be fitted, or too many simulations failed.
    #[error(transparent)]
    Study(StudyError),
}

/// One round of learning with its true error.
#[derive(Debug, Clone, PartialEq)]
pub struct Round {
    /// Number of evaluations so far.
    pub evaluations: usize,
    /// Largest error that the surrogates state for any curve at any checkpoint [1].
    pub stated_error: f64,
    /// Largest difference of any curve at any checkpoint from the simulated one [1].
    pub true_error: f64,
    /// Root mean square over curves and checkpoints of the grid of (difference / stated error) [1].
    pub error_ratio: f64,
    /// Share of the population with U_c < 2.
    pub uncertain: f64,
    /// Per limit state: kernel, trend, smallest Q2 by leaving one out and by cross-validation, and the factor on the predicted
    /// variances.
    pub surrogates: Vec<String>,
}

/// Rounds of a replayed study, and the reason of its stop.
#[derive(Debug, Clone, PartialEq)]
pub struct Replayed {
    /// Rounds in their order.
    pub rounds: Vec<Round>,
    /// The rule or budget that ended the learning.
    pub stopped_by: String,
    /// Time of learning [s].
    pub seconds: f64,
}

/// Learns from the nominal evaluation and the evaluations of the population's first points, in its order, as a study
/// with these settings and this population would.
///
/// # Errors
/// [`ReplayError`].
pub fn replay(
    scene: &Scene,
    settings: &Settings,
    nominal: &SimulatedPoint,
    samples: &[SimulatedPoint],
) -> Result<Replayed, ReplayError> {
    let problem = Problem::from_scene(scene);
    let settings = Settings { samples: samples.len(), ..settings.clone() };
    // The population is all there is: it neither grows nor becomes conditional.
    let targets = StoppingTargets { cov: f64::INFINITY, ..settings.targets() };
    let plan =
        Plan { largest_population: samples.len(), retry: false, targets, ..Plan::new(&settings, scene) };
    let simulated: Vec<Vec<u32>> = first_failures(&problem, &observations(scene, &problem, samples));
    let truth = curves(&with_system(simulated), problem.checkpoints.len());
    let points: Vec<SimulatedPoint> = samples.iter().chain([nominal]).cloned().collect();
    let outcomes = completed(scene, &points);
    let known: HashMap<Vec<u64>, &Observed> =
        points.iter().map(|point| bits(&point.sample)).zip(&outcomes).collect();
    let campaign = Campaign::new(problem, plan);
    if let Some(foreign) = (0..samples.len()).find(|j| !known.contains_key(&bits(&campaign.sample(*j)))) {
        return Err(ReplayError::Foreign(foreign));
    }
    let started = Instant::now();
    let mut rounds: Vec<Round> = Vec::new();
    let simulate = |sample: &[f64]| -> Result<Observed, SimulationFailure> {
        let unknown =
            || SimulationFailure::NotModelled { what: "a sample that was not simulated".to_owned() };
        known.get(&bits(sample)).map(|observed| (*observed).clone()).ok_or_else(unknown)
    };
    let learned = campaign.learn_from(simulate, |campaign| {
        if campaign.rounds.len() > rounds.len()
            && let Some(round) = round_of(campaign, &truth)
        {
            rounds.push(round);
        }
    });
    let learned = learned.map_err(|error| ReplayError::Study(StudyError::from_campaign(error, scene)))?;
    let stopped_by = match learned.stop {
        StopReason::Budget => "budget".to_owned(),
        StopReason::Rule(rule) => format!("{rule:?}").to_lowercase(),
    };
    Ok(Replayed { rounds, stopped_by, seconds: started.elapsed().as_secs_f64() })
}

fn bits(sample: &[f64]) -> Vec<u64> {
    sample.iter().map(|x| x.to_bits()).collect()
}

fn round_of(campaign: &Campaign, truth: &[Vec<f64>]) -> Option<Round> {
    let assessment = campaign.assessment.as_ref()?;
    let pairs = assessment.curves.iter().flatten().zip(truth.iter().flatten());
    let true_error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let (mut squares, mut count) = (0.0, 0.0);
    for ((found, truth), errors) in assessment.curves.iter().zip(truth).zip(&assessment.errors) {
        for (n, error) in assessment.grid.iter().zip(errors).filter(|(_, error)| **error > 1e-4) {
            squares += ((found[*n] - truth[*n]) / error).powi(2);
            count += 1.0;
        }
    }
    let describe = |surrogate: &Surrogate| {
        let model = &surrogate.model;
        let q2 = surrogate.leave_one_out.iter().map(|l| l.q2).fold(1.0, f64::min);
        let crossed = surrogate.cross_validation.as_ref().map_or(q2, |crossed| crossed.q2);
        let (kernel, trend) = (model.correlation.kernel.name(), model.trend().name());
        format!("{kernel} {trend} {q2:.4} {crossed:.4} {:.2}", surrogate.inflation())
    };
    Some(Round {
        evaluations: campaign.evaluations(),
        stated_error: assessment.figures.error,
        true_error,
        error_ratio: if count > 0.0 { f64::sqrt(squares / count) } else { 0.0 },
        uncertain: assessment.share_uncertain,
        surrogates: assessment.surrogates.iter().map(describe).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;
    use coordinator::statistics::design::Population;
    use coordinator::statistics::surrogate::Kernel;

    /// A limit state that fails earlier with x + 0.1 x y, at nine tenths of the life on average.
    fn simulated(sample: Vec<f64>) -> SimulatedPoint {
        let bend = 0.5 * (sample[0] + 0.1 * sample[0] * sample[1]);
        let life = (1..=5).map(|n| 5.0 * f64::from(n) / 4.5 + bend).collect();
        SimulatedPoint { sample, observed: Observed::exact(vec![life]) }
    }

    #[test]
    fn a_replay_knows_the_error_of_every_round_and_refuses_other_samples() {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\n\
            life = { cycles = 50, checkpoint_every = 10 }\noutputs = [{ name = \"a\" }]\n\
            limit_states = [{ name = \"high\", output = \"a\", threshold = 5 }]\n\
            variables = [{ name = \"x\", mean = 0, std = 1 }, { name = \"y\", mean = 0, std = 1 }]";
        let source = SceneSource::parse(text, "s").unwrap();
        let scene = source.nominal();
        let mut settings = Settings::from(scene);
        (settings.initial, settings.batch, settings.max_evaluations) = (20, 4, 60);
        settings.forms.kernel = Some(Kernel::Gaussian);
        let nominal = simulated(vec![0.0, 0.0]);
        let samples = |count: usize| -> Vec<SimulatedPoint> {
            let population = Population::draw(&Problem::from_scene(scene).inputs, count, scene.study.seed);
            (0..count).map(|j| simulated(population.physical(j))).collect()
        };
        let mut all = samples(2000);
        let found = replay(scene, &settings, &nominal, &all).unwrap();
        assert_eq!(found.rounds[0].evaluations, 20);
        let last = found.rounds.last().unwrap();
        assert!(last.true_error < 2e-3 && found.stopped_by != "budget", "{found:?}");
        // Few samples are learned completely.
        let few = replay(scene, &settings, &nominal, &samples(60)).unwrap();
        assert!(few.rounds.last().unwrap().evaluations <= 61, "{few:?}");
        all[7].sample[0] += 1e-9;
        let error = replay(scene, &settings, &nominal, &all).unwrap_err();
        assert!(matches!(error, ReplayError::Foreign(7)), "{error}");
    }
}
