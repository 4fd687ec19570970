//! One round of learning on the results so far: fit the surrogates, classify the population, estimate the
//! errors of the curves, and prepare the selection of the next samples.

use super::campaign_data::CampaignData;
use super::requests::Requests;
use super::surrogates::{GRID, Surrogate, SurrogateState, fit_surrogates};
use super::{CampaignError, Feasibility, Plan, Problem};
use crate::results::summary::Round;
use crate::statistics::design::{Population, Stream, open_stream};
use crate::statistics::learning::{
    Classification, ClassifiedMode, Coupled, EARLY, Figures, Gap, JointPool, Mode, SURROGATE_SAFETY,
    Selection, UNCERTAIN, choose_pool, classify_cached, coupled_criterion, curves, dominance,
    estimate_errors, explore, farthest, noise_shifts, sample_of_open, widest_gap, with_system,
};
use crate::statistics::reliability::governing_checkpoint;
use crate::statistics::surrogate::{Effort, Kriging, PredictionCache};
use faer::{Mat, MatRef};
use rand::Rng;
use std::borrow::Cow;

/// Change of a life over itself by the surrogate error, below which an early life is known well enough [1].
const SHORT: f64 = 0.01;
/// Least size of the pool per point of a batch.
const POOL_PER_BATCH: usize = 8;
/// Numbers per point of the population besides its values and classification: coupled criterion, marks of requests,
/// and what the end of a study computes.
const OTHERS: usize = 16;

/// Result of one round.
#[derive(Debug)]
pub struct Assessment {
    /// Surrogates per mode.
    pub surrogates: Vec<Surrogate>,
    /// Classification per mode.
    pub modes: Vec<Classification>,
    /// Indices of the checkpoints at which means and errors are kept `(a,)`, ascending.
    pub grid: Vec<usize>,
    /// Failure shares `(modes + 1, m)` [1]: each mode, then the system.
    pub curves: Vec<Vec<f64>>,
    /// Surrogate errors of the failure shares on the grid.
    pub errors: Vec<Vec<f64>>,
    /// Shift of each failure share by the numerical noise of the simulator `(modes + 1, a)` [1]. No further
    /// simulation removes it, so it counts in the standard errors but not for stopping.
    pub noise_shift: Vec<Vec<f64>>,
    /// Index of the checkpoint at which the system's R is nearest 1/2.
    pub governing: usize,
    /// Share of the population with U_c < 2 [1].
    pub share_uncertain: f64,
    /// Mean dominance weight over the pool at the governing checkpoint [1].
    pub dominance: Option<f64>,
    /// Input of the stopping rules.
    pub figures: Figures,
    /// Number of repairs: nuggets raised and starts of the likelihood that failed.
    pub repairs: usize,
    /// Estimated probability that a simulation gives a result.
    pub feasibility: Feasibility,
    /// Marks the points of the population where it is settled that simulations fail `(N,)`; empty without failures.
    settled: Vec<bool>,
    /// Selection of the next samples.
    pub(super) selection: Selection,
}

impl Assessment {
    /// Failure share of the system at the governing checkpoint [1].
    pub fn governing_failed(&self) -> f64 {
        self.curves[self.curves.len() - 1][self.governing]
    }

    /// Index of the checkpoint by which each point of the population has failed `(modes + 1)(N,)`, the system last; m if
    /// never.
    pub fn first_failures(&self) -> Vec<Vec<u32>> {
        first_failures(&self.modes)
    }

    /// Returns the point of the population with the largest predicted variance, as an index, and removes it from the
    /// selection. `requested` `(N,)` marks the points requested before, `known` holds the standardised points `(d,)` that
    /// were explored before and are in no surrogate.
    pub(super) fn explore(
        &mut self,
        population: &Population,
        requested: &[bool],
        known: &[Vec<f64>],
    ) -> Option<usize> {
        let models: Vec<&Kriging> = self.surrogates.iter().map(|surrogate| &surrogate.model).collect();
        let closed = closed(requested, &self.settled);
        let feasible = |points: MatRef<'_, f64>| self.feasibility.probability(points);
        let chosen = explore((&models, &self.modes), population, &closed, known, feasible)?;
        self.selection.believe_point(chosen);
        Some(chosen)
    }

    /// Returns the point of a population in the widest gap at `place`, as an index. `requested` `(N,)` marks the points of the one
    /// that is classified, from whose selection it is removed; `None` for another one. `known` are all simulated points `(d,)` with
    /// factors on squared distances [1].
    pub(super) fn fill_gap<'a>(
        &mut self,
        population: &Population,
        requested: Option<&[bool]>,
        known: impl Iterator<Item = (&'a [f64], f64)>,
        place: Gap,
        rng: &mut impl Rng,
    ) -> Option<usize> {
        let none = || Cow::Owned(vec![false; population.len()]);
        let closed = requested.map_or_else(none, |requested| closed(requested, &self.settled));
        let sample = sample_of_open(population, &closed, rng);
        let points =
            Mat::from_fn(population.dimension(), sample.len(), |k, i| population.standardised(sample[i])[k]);
        let feasible = self.feasibility.open_probability(points.as_ref());
        let limits = (&self.modes[..], nearest(&self.grid, self.governing));
        let chosen = widest_gap(population, (&sample, &feasible), known, place, limits)?;
        if requested.is_some() {
            self.selection.believe_point(chosen);
        }
        Some(chosen)
    }

    /// The one of the standardised points `rim` `(c)(d,)` farthest from the points `known` `(d,)`, which have factors on squared
    /// distances [1].
    pub(super) fn explore_rim<'a>(
        &self,
        rim: &[Vec<f64>],
        known: impl Iterator<Item = (&'a [f64], f64)>,
    ) -> Option<Vec<f64>> {
        let points: Vec<&[f64]> = rim.iter().map(Vec::as_slice).collect();
        let columns = Mat::from_fn(points.first().map_or(0, |z| z.len()), points.len(), |k, i| points[i][k]);
        let chosen = farthest(&points, known, &self.feasibility.open_probability(columns.as_ref()), 1);
        chosen.first().map(|place| rim[*place].clone())
    }

    /// The row of this round in the summary, for a population of `population` points under a condition of
    /// probability `condition`. The campaign adds round number, evaluations, governing cycle and coefficient
    /// of variation.
    pub(super) fn row(&self, condition: f64, population: usize) -> Round {
        let figures = &self.figures;
        let relative = |change: f64| change / figures.governing_share.max(1.0 / population as f64);
        Round {
            // JSON has no infinity; above 100 the value carries no information.
            min_u: figures.min_u.min(100.0),
            share_uncertain: self.share_uncertain,
            change_of_r: figures.change.map(relative),
            surrogate_error: condition * figures.error,
            dominance: self.dominance,
            reliability_total: 1.0 - condition * self.governing_failed(),
            repairs: self.repairs,
            ..Round::default()
        }
    }

    /// Stated error [1] per curve at the checkpoints of the grid: root sum of squares of [`SURROGATE_SAFETY`] times the surrogate
    /// error and of the simulator's noise. Beyond the grid, where the share goes on towards 0 or 1, the error has the same ratio to
    /// it (or to its distance from 1) as at the end of the grid.
    pub(super) fn combined_errors(&self) -> Vec<Vec<(usize, f64)>> {
        let (first, last) = (self.grid[0], self.grid[self.grid.len() - 1]);
        let in_proportion =
            |error: f64, share: f64, at_end: f64| error * (share / at_end.max(share)).min(1.0);
        let of_curve = |((errors, noise), shares): ((&Vec<f64>, &Vec<f64>), &Vec<f64>)| {
            let both = errors.iter().zip(noise);
            let combined = both.map(|(error, noise)| (SURROGATE_SAFETY * error).hypot(*noise));
            let combined: Vec<f64> = combined.collect();
            let before = (0..first).filter(|n| shares[*n] > 0.0);
            let before = before.map(|n| (n, in_proportion(combined[0], shares[n], shares[first])));
            let after = (last + 1..shares.len()).filter(|n| shares[*n] < 1.0);
            let end = combined[combined.len() - 1];
            let after = after.map(|n| (n, in_proportion(end, 1.0 - shares[n], 1.0 - shares[last])));
            before.chain(self.grid.iter().copied().zip(combined.iter().copied())).chain(after).collect()
        };
        self.errors.iter().zip(&self.noise_shift).zip(&self.curves).map(of_curve).collect()
    }
}

/// Assesses the results in the `round`th round, with lengths found with the given effort. The `state` of the surrogates is that of the
/// round before; its caches, one per mode, are of predictions of this population, as its curves.
///
/// # Errors
/// [`CampaignError::Surrogate`].
pub(super) fn assess(
    (problem, plan): (&Problem, &Plan),
    population: &Population,
    requests: &Requests,
    CampaignData { observations, failed, .. }: &CampaignData,
    state: &mut SurrogateState,
    (round, effort): (u32, Effort),
) -> Result<Assessment, CampaignError> {
    let points = observations.points();
    let previous = state.previous_curves.as_deref();
    let surrogates = fit_surrogates(observations, &problem.modes, (&state.models, previous), (plan, effort))?;
    let grid = common_grid(&surrogates);
    let modes = classify_modes((problem, plan), population, &surrogates, &mut state.caches, &grid);
    let curves = curves(&first_failures(&modes), problem.checkpoints.len());
    let coupled = coupled_criterion(&modes);
    let feasibility = Feasibility::new(points.as_ref(), failed);
    let settled = feasibility.settled(population);
    let closed = closed(&requests.requested, &settled);
    let least = POOL_PER_BATCH * plan.settings.batch;
    let pool = choose_pool(&coupled, &closed, least, plan.settings.seed, round);
    let models: Vec<&Kriging> = surrogates.iter().map(|surrogate| &surrogate.model).collect();
    let pool = JointPool::new(pool, &requests.members_under_way(), population, &models);
    let mut rng = open_stream(plan.settings.seed, Stream::Realisations(round));
    let errors = estimate_errors(&modes, &coupled, &pool, &mut rng);
    // The noise of the simulations, in units of the enlarged standard deviations. The surrogates have taken it off; what pairs of
    // levels show of it is known, so that the difference of the two counts.
    let noise_of = |(s, mode): (&Surrogate, &Mode)| {
        let unexplained = s.model.correlation.noise() - s.rough_share(observations.rough(mode.output));
        (unexplained.abs() / s.inflation()).sqrt()
    };
    let noise: Vec<f64> = surrogates.iter().zip(&problem.modes).map(noise_of).collect();
    let noise_shift = noise_shifts(&modes, &noise);

    let governing = governing_checkpoint(&curves[curves.len() - 1]);
    let on_grid = nearest(&grid, governing);
    let has_steps = surrogates.iter().any(|surrogate| surrogate.threshold.coarse.is_some());
    let (system, failed) = (curves.len() - 1, curves[curves.len() - 1][governing]);
    let figures = Figures {
        points: observations.len(),
        min_u: open_points(&coupled, &closed).map(|c| c.system).fold(f64::INFINITY, f64::min),
        change: previous.map(|previous| largest_change(previous, &curves)),
        error: errors.iter().flatten().copied().fold(0.0, f64::max),
        governing_error: errors[system][on_grid],
        governing_share: failed.min(1.0 - failed),
        early_error: early_error((&grid, &problem.checkpoints), &curves, &errors),
        steps: if has_steps { noise_shift[system][on_grid] } else { 0.0 },
    };
    let uncertain = open_points(&coupled, &closed).filter(|c| c.system < UNCERTAIN).count();
    let weights: Vec<f64> = pool.members.iter().filter_map(|j| dominance(&modes, *j, on_grid)).collect();
    let (feasible, function) = (feasibility.probability(pool.points.as_ref()), plan.settings.learning);
    Ok(Assessment {
        governing,
        share_uncertain: uncertain as f64 / population.len() as f64,
        dominance: (!weights.is_empty()).then(|| weights.iter().sum::<f64>() / weights.len() as f64),
        repairs: surrogates.iter().map(|s| s.repairs).sum(),
        figures,
        selection: Selection::new(pool, feasible, on_grid, function),
        surrogates,
        modes,
        grid,
        curves,
        errors,
        noise_shift,
        feasibility,
        settled,
    })
}

fn first_failures(modes: &[Classification]) -> Vec<Vec<u32>> {
    with_system(modes.iter().map(|mode| mode.first_failure.clone()).collect())
}

/// Checkpoints that matter to any mode, ascending; evenly thinned to [`GRID`].
fn common_grid(surrogates: &[Surrogate]) -> Vec<usize> {
    let mut grid: Vec<usize> = surrogates.iter().flat_map(|s| s.fitted_on.iter().copied()).collect();
    grid.sort_unstable();
    grid.dedup();
    if grid.len() > GRID {
        grid = (0..GRID).map(|i| grid[i * (grid.len() - 1) / (GRID - 1)]).collect();
    }
    grid
}

/// Classifies the population by every mode, through the caches as far as they fit into memory.
fn classify_modes(
    (problem, plan): (&Problem, &Plan),
    population: &Population,
    surrogates: &[Surrogate],
    caches: &mut [PredictionCache],
    grid: &[usize],
) -> Vec<Classification> {
    // What remains of the memory for the caches beside the population and its classification.
    let numbers_of_point = population.dimension() + problem.modes.len() * (grid.len() + 2) + OTHERS;
    let others = population.len() * numbers_of_point * size_of::<f64>();
    let limit = plan.settings.memory.saturating_mul(1_000_000).saturating_sub(others) / problem.modes.len();
    let classify = |(index, (surrogate, cache)): (usize, (&Surrogate, &mut PredictionCache))| {
        cache.set_limit(limit);
        let (threshold, inflation) = (surrogate.threshold.value, surrogate.inflation());
        let mode = ClassifiedMode { index, threshold, grid, inflation, by_mean: plan.is_as_published() };
        classify_cached(cache, &surrogate.model, population, &mode)
    };
    surrogates.iter().zip(caches).enumerate().map(classify).collect()
}

/// Largest surrogate error of a failure share over the share itself, at early lives and where it moves the life by more than
/// [`SHORT`] of itself [1].
fn early_error((grid, checkpoints): (&[usize], &[u32]), curves: &[Vec<f64>], errors: &[Vec<f64>]) -> f64 {
    let of_curve = |(curve, errors): (&Vec<f64>, &Vec<f64>)| {
        let moves_life = |n: usize, error: f64| {
            let (before, after) = (n.saturating_sub(1), (n + 1).min(curve.len() - 1));
            let (rise, time) = (curve[after] - curve[before], checkpoints[after] - checkpoints[before]);
            error * f64::from(time) > SHORT * f64::from(checkpoints[n]) * rise
        };
        let early = grid.iter().zip(errors).filter(|(n, _)| (EARLY.0..EARLY.1).contains(&curve[**n]));
        let matters = early.filter(|(n, error)| moves_life(**n, **error));
        matters.map(|(n, error)| error / curve[*n]).fold(0.0, f64::max)
    };
    curves.iter().zip(errors).map(of_curve).fold(0.0, f64::max)
}

/// The points of the population that are not requested any more `(N,)`: those requested before and those where it is `settled`
/// that simulations fail, which is empty without failures.
fn closed<'a>(requested: &'a [bool], settled: &[bool]) -> Cow<'a, [bool]> {
    if settled.is_empty() {
        return Cow::Borrowed(requested);
    }
    Cow::Owned(requested.iter().zip(settled).map(|(requested, settled)| *requested || *settled).collect())
}

/// The coupled criterion of the points that can still be requested.
fn open_points<'a>(coupled: &'a [Coupled], closed: &'a [bool]) -> impl Iterator<Item = &'a Coupled> {
    coupled.iter().zip(closed).filter(|(_, closed)| !**closed).map(|(c, _)| c)
}

fn nearest(grid: &[usize], checkpoint: usize) -> usize {
    (0..grid.len()).min_by_key(|i| grid[*i].abs_diff(checkpoint)).expect("the grid is never empty")
}

/// Largest absolute difference of two sets of curves of the same shape.
pub(super) fn largest_change(before: &[Vec<f64>], now: &[Vec<f64>]) -> f64 {
    before.iter().flatten().zip(now.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
