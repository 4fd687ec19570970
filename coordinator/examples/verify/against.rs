//! Validation of surrogates against simulations that they were not fitted to, point by point.
//!
//! The surrogates of a study are those it ended with: its learning is repeated from the stored outcomes, so that forms,
//! lengths and the results they were fitted to are the same to the last bit. Those of another study are fitted anew.
//!
//! A study estimates R(n) over its population, direct Monte Carlo over other samples. The difference of the two
//! estimates is mostly sampling error: 5000 samples leave a standard error of 0.007 where R = 1/2. Here the surrogates
//! classify the very points that were simulated, so that the sampling error cancels and the error of the surrogates
//! remains. With N points and the indicator 1(.), both [1]:
//!
//!   D_j = 1(simulated not failed) - 1(predicted not failed),   difference = mean D_j,   standard error = sqrt(Var D_j / N).
//!
//! # Source
//! The standard error of paired differences is that of common random numbers: Glasserman (2003), Monte Carlo Methods in
//! Financial Engineering, Springer.

use crate::simulated::{SimulatedPoint, completed};
use common::failure::SimulationFailure;
use common::scene::Scene;
use coordinator::statistics::learning::{Mode, with_system};
use coordinator::study::{
    Campaign, CampaignResult, Observations, ObservedOutcome, Plan, Problem, Settings, StoredOutcome,
    StudyError, Surrogate, learn_from_results,
};
use faer::Mat;
use std::collections::HashMap;

/// Comparison of surrogates and simulations at the same points.
#[derive(Debug, Clone, PartialEq)]
pub struct Verification {
    /// Simulations the surrogates were fitted to.
    pub learned_from: usize,
    /// Simulations they were compared with.
    pub points: usize,
    /// Accuracy of the surrogate of each limit state.
    pub surrogates: Vec<Verified>,
    /// Limit states, in the scene's order, and the system last as `total`; the order of the arrays in `rows`.
    pub curves: Vec<String>,
    /// Checkpoints at which some points have failed, but not all.
    pub rows: Vec<VerifiedRow>,
}

/// Accuracy of one surrogate at points that it was not fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Verified {
    /// Name of the limit state.
    pub limit_state: String,
    /// Names of kernel and trend.
    pub form: String,
    /// Q2 = 1 - sum of squared errors / sum of squared deviations, smallest over the checkpoints it was fitted on [1].
    pub q2: f64,
    /// Smallest leave-one-out Q2 over the points and checkpoints it was fitted to [1].
    pub q2_leave_one_out: f64,
    /// Mean over those checkpoints and the points of (error / predicted standard deviation, noise included)^2 [1].
    pub variance_ratio: f64,
}

/// Reliabilities by simulation and by surrogate at one checkpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct VerifiedRow {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// R by simulation, per curve [1].
    pub simulated: Vec<f64>,
    /// R by surrogate, per curve [1].
    pub predicted: Vec<f64>,
    /// Standard error of their difference, per curve [1].
    pub standard_error: Vec<f64>,
}

impl Verification {
    /// Largest difference of any curve at any checkpoint [1].
    pub fn largest_difference(&self) -> f64 {
        let largest_of_row = |row: &VerifiedRow| {
            row.simulated.iter().zip(&row.predicted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        self.rows.iter().map(largest_of_row).fold(0.0, f64::max)
    }
}

/// Compares the surrogates of a study, from its outcomes, with `unseen`.
///
/// # Errors
/// [`StudyError`] if no surrogates can be fitted.
pub fn verify(
    scene: &Scene,
    settings: &Settings,
    stored: &[StoredOutcome],
    unseen: &[SimulatedPoint],
) -> Result<Verification, StudyError> {
    let own = if settings.method.learns() { repeat_learning(scene, settings, stored) } else { None };
    let learned = own.map_or_else(|| learn_from_results(scene, scene, settings, stored), Ok)?;
    Ok(compare(scene, &learned.assessment.surrogates, unseen))
}

/// Repeats the learning of a study from its outcomes; `None` if a sample is requested that is not stored.
fn repeat_learning(scene: &Scene, settings: &Settings, stored: &[StoredOutcome]) -> Option<CampaignResult> {
    let bits = |sample: &[f64]| sample.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let known: HashMap<Vec<u64>, &ObservedOutcome> =
        stored.iter().map(|stored| (bits(&stored.sample), &stored.outcome)).collect();
    let mut same = true;
    let recalled = |sample: &[f64]| {
        let Some(outcome) = known.get(&bits(sample)) else {
            same = false;
            return Err(SimulationFailure::NotModelled {
                what: "a sample that was not simulated".to_owned(),
            });
        };
        let observed = (*outcome).clone()?;
        let point = SimulatedPoint { sample: sample.to_vec(), observed };
        Ok(completed(scene, &[point]).swap_remove(0))
    };
    let campaign = Campaign::new(Problem::from_scene(scene), Plan::new(settings, scene));
    campaign.learn_from(recalled, |_| {}).ok().filter(|_| same)
}

/// Compares surrogates with `unseen`.
fn compare(scene: &Scene, fitted: &[Surrogate], unseen: &[SimulatedPoint]) -> Verification {
    let problem = Problem::from_scene(scene);
    let unseen = observations(scene, &problem, unseen);
    let unseen_points = unseen.points();
    let m = problem.checkpoints.len();
    let mut predicted: Vec<Vec<u32>> = Vec::new();
    let mut surrogates = Vec::new();
    for ((mode, surrogate), limit) in problem.modes.iter().zip(fitted).zip(&scene.limit_states) {
        let prediction = surrogate.model.predict(unseen_points.as_ref());
        let values = unseen.running_maxima(mode.output);
        predicted.push(firsts(unseen.len(), m, |j, n| prediction.mean[(n, j)] >= surrogate.threshold.value));
        surrogates.push(verified(
            &limit.name,
            surrogate,
            &prediction.mean,
            &prediction.variance_factor,
            &values,
        ));
    }
    let limits = scene.limit_states.iter().map(|limit| limit.name.clone());
    Verification {
        learned_from: fitted[0].model.points(),
        points: unseen.len(),
        surrogates,
        curves: limits.chain(["total".to_owned()]).collect(),
        rows: rows(&problem.checkpoints, first_failures(&problem, &unseen), predicted),
    }
}

/// Index of the first checkpoint by which each simulation has failed, m if never, `(limit states)(N,)`.
pub fn first_failures(problem: &Problem, simulated: &Observations) -> Vec<Vec<u32>> {
    let m = problem.checkpoints.len();
    let of_mode = |mode: &Mode| {
        let values = simulated.running_maxima(mode.output);
        firsts(simulated.len(), m, |j, n| values[(j, n)] >= mode.threshold)
    };
    problem.modes.iter().map(of_mode).collect()
}

/// First checkpoint by which each point has failed.
fn firsts(points: usize, m: usize, failed: impl Fn(usize, usize) -> bool) -> Vec<u32> {
    let first = |j| (0..m).find(|n| failed(j, *n)).unwrap_or(m) as u32;
    (0..points).map(first).collect()
}

/// The simulations as observations; all count as initial design, since no learning follows.
pub fn observations(scene: &Scene, problem: &Problem, simulated: &[SimulatedPoint]) -> Observations {
    let mut all = Observations::new(problem.inputs.dimension());
    for (point, complete) in simulated.iter().zip(completed(scene, simulated)) {
        all.add(&problem.inputs.standardise(&point.sample), complete);
    }
    all.close_design();
    all
}

fn verified(
    limit_state: &str,
    surrogate: &Surrogate,
    mean: &Mat<f64>,
    variance_factor: &[f64],
    values: &Mat<f64>,
) -> Verified {
    let model = &surrogate.model;
    let n = values.nrows() as f64;
    let noise = model.correlation.noise();
    let (mut q2, mut ratio) = (1.0_f64, 0.0);
    for o in &surrogate.fitted_on {
        let centre = values.col(*o).iter().sum::<f64>() / n;
        let (mut errors, mut deviations) = (0.0, 0.0);
        for (j, factor) in variance_factor.iter().enumerate() {
            let error = (values[(j, *o)] - mean[(*o, j)]).powi(2);
            errors += error;
            deviations += (values[(j, *o)] - centre).powi(2);
            ratio += error / (model.sigma2[*o] * (factor + noise)).max(f64::MIN_POSITIVE);
        }
        q2 = q2.min(if deviations > 0.0 { 1.0 - errors / deviations } else { 1.0 });
    }
    Verified {
        limit_state: limit_state.to_owned(),
        form: format!("{}, {} trend", model.correlation.kernel.name(), model.trend().name()),
        q2,
        q2_leave_one_out: surrogate.leave_one_out.iter().map(|l| l.q2).fold(1.0, f64::min),
        variance_ratio: ratio / (n * surrogate.fitted_on.len() as f64),
    }
}

/// First failures per limit state `(modes)(N,)` as reliabilities over life.
fn rows(cycles: &[u32], simulated: Vec<Vec<u32>>, predicted: Vec<Vec<u32>>) -> Vec<VerifiedRow> {
    let m = cycles.len();
    let (simulated, predicted) = (with_system(simulated), with_system(predicted));
    let points = simulated[0].len() as f64;
    let survives = |first: u32, n: usize| f64::from(u8::from(first as usize > n));
    let row = |n: usize| {
        let reliability = |firsts: &[Vec<u32>]| -> Vec<f64> {
            let share = |first: &Vec<u32>| first.iter().map(|f| survives(*f, n)).sum::<f64>() / points;
            firsts.iter().map(share).collect()
        };
        let standard_error = |(a, b): (&Vec<u32>, &Vec<u32>)| {
            let differences = || a.iter().zip(b).map(|(a, b)| survives(*a, n) - survives(*b, n));
            let mean = differences().sum::<f64>() / points;
            (differences().map(|d| (d - mean).powi(2)).sum::<f64>() / points / points).sqrt()
        };
        VerifiedRow {
            cycles: cycles[n],
            simulated: reliability(&simulated),
            predicted: reliability(&predicted),
            standard_error: simulated.iter().zip(&predicted).map(standard_error).collect(),
        }
    };
    let open = |row: &VerifiedRow| row.simulated.iter().chain(&row.predicted).any(|r| *r > 0.0 && *r < 1.0);
    (0..m).map(row).filter(open).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::SceneSource;
    use coordinator::statistics::design::Population;
    use coordinator::statistics::surrogate::Kernel;
    use coordinator::study::Observed;

    fn scene() -> Scene {
        let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\n\
        life = { cycles = 50, checkpoint_every = 10 }\n\
        outputs = [{ name = \"a\" }, { name = \"b\" }]\n\
        limit_states = [{ name = \"high\", output = \"a\", threshold = 5 },\n\
        { name = \"low\", output = \"b\", threshold = -5, fails = \"below\" }]\n\
        variables = [{ name = \"x\", mean = 0, std = 1 }, { name = \"y\", mean = 0, std = 1 }]";
        SceneSource::parse(text, "s").unwrap().nominal().clone()
    }

    /// High fails earlier with x + 0.1 x y, low with y; at nine tenths of the life on average.
    fn simulated(sample: Vec<f64>) -> SimulatedPoint {
        let (x, y) = (sample[0], sample[1]);
        let life = |bend: f64| (1..=5).map(|n| 5.0 * f64::from(n) / 4.5 + 0.5 * bend).collect::<Vec<f64>>();
        let low = life(y - 0.3 * x).into_iter().map(|value| -value).collect();
        SimulatedPoint { sample, observed: Observed::exact(vec![life(x + 0.1 * x * y), low]) }
    }

    fn settings(scene: &Scene) -> Settings {
        let mut settings = Settings::from(scene);
        (settings.initial, settings.batch, settings.max_evaluations) = (20, 4, 60);
        settings.forms.kernel = Some(Kernel::Gaussian);
        settings
    }

    fn stored(point: SimulatedPoint) -> StoredOutcome {
        StoredOutcome { sample: point.sample, outcome: Ok(point.observed) }
    }

    fn samples(scene: &Scene, count: usize) -> Vec<SimulatedPoint> {
        let population = Population::draw(&Problem::from_scene(scene).inputs, count, scene.study.seed);
        (0..count).map(|j| simulated(population.physical(j))).collect()
    }

    #[test]
    fn surrogates_agree_with_simulations_of_what_they_learned_and_not_with_others() {
        let scene = scene();
        let settings = settings(&scene);
        let all = samples(&scene, 1000);
        let (learned, unseen) = all.split_at(40);
        let stored: Vec<StoredOutcome> = learned.iter().cloned().map(stored).collect();
        let found = verify(&scene, &settings, &stored, unseen).unwrap();
        assert_eq!((found.learned_from, found.points, found.curves.len()), (40, 960, 3));
        assert!(found.surrogates.iter().all(|surrogate| surrogate.q2 > 0.9999), "{:?}", found.surrogates);
        assert!(found.largest_difference() < 3e-3, "{found:?}");
        // R of high at the checkpoint before its mean life: P(x + 0.1 x y < 1.11), counted.
        let row = found.rows.iter().find(|row| row.cycles == 40).unwrap();
        let safe = |point: &&SimulatedPoint| {
            40.0 / 9.0 + 0.5 * (point.sample[0] + 0.1 * point.sample[0] * point.sample[1]) < 5.0
        };
        assert_eq!(row.simulated[0], unseen.iter().filter(safe).count() as f64 / 960.0);
        assert!(row.simulated[2] < row.simulated[0].min(row.simulated[1]));

        // Simulations of something else: every value a third of a standard deviation higher.
        let mut others = unseen.to_vec();
        others
            .iter_mut()
            .for_each(|point| point.observed.histories[0].iter_mut().for_each(|value| *value += 0.17));
        let found = verify(&scene, &settings, &stored, &others).unwrap();
        let row = found.rows.iter().find(|row| row.cycles == 40).unwrap();
        let difference = row.predicted[0] - row.simulated[0];
        assert!(difference > 0.03 && difference > 5.0 * row.standard_error[0], "{row:?}");
    }

    #[test]
    fn learning_is_repeated_only_with_the_samples_of_the_study() {
        let scene = scene();
        let settings = settings(&scene);
        let mut all = Vec::new();
        let campaign = Campaign::new(Problem::from_scene(&scene), Plan::new(&settings, &scene));
        let simulate = |x: &[f64]| {
            let point = simulated(x.to_vec());
            all.push(stored(point.clone()));
            Ok(completed(&scene, &[point]).swap_remove(0))
        };
        let learned = campaign.learn_from(simulate, |_| {}).unwrap();
        let repeated = repeat_learning(&scene, &settings, &all).unwrap();
        let q2 = |found: &CampaignResult| found.assessment.surrogates[0].leave_one_out[0].q2.to_bits();
        assert_eq!(q2(&repeated), q2(&learned));
        all[5].sample[0] += 1e-9;
        assert!(repeat_learning(&scene, &settings, &all).is_none());
    }
}
