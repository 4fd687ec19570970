//! One round of learning on the results so far: fit, classify the population, estimate the error.

use super::failures::{Failed, Feasibility};
use super::observations::Observations;
use super::plan::{Plan, Problem};
use super::step::CampaignError;
use super::surrogates::{Results, Surrogate};
use crate::results::summary::Round;
use crate::statistics::design::Population;
use crate::statistics::learning::{
    Classification, CurveErrors, Figures, Selection, checkpoints_that_matter, choose_pool, classify,
    classify_cached, coupled_criterion, curves, dominance, estimate_errors, explore, noise_shifts,
};
use crate::statistics::reliability::governing_checkpoint;
use crate::statistics::surrogate::{Effort, Kriging, Posterior, PredictionCache};
use faer::{Mat, MatRef};
use rayon::prelude::*;

/// Most checkpoints on which learning looks at one mode, and at all of them.
const GRID: usize = 24;

/// What a round found.
#[derive(Debug)]
pub struct Assessment {
    /// Surrogates per mode.
    pub surrogates: Vec<Surrogate>,
    /// Classification per mode.
    pub modes: Vec<Classification>,
    /// Checkpoints that matter, as indices, ascending; means and errors are kept there.
    pub grid: Vec<usize>,
    /// Failure shares `(modes + 1, m)`: each mode, then the system.
    pub curves: Vec<Vec<f64>>,
    /// Surrogate errors on the grid.
    pub errors: CurveErrors,
    /// By how much the simulator's numerical noise, as the surrogates have it, would move each failure share on the grid,
    /// `(modes + 1, a)`: no learning removes it, so it counts in the standard errors but not for stopping.
    pub noise_shift: Vec<Vec<f64>>,
    /// Checkpoint at which the system's R is nearest 1/2.
    pub governing: usize,
    /// Share of the population with U_c < 2.
    pub share_uncertain: f64,
    /// Mean dominance weight over the pool at the governing checkpoint.
    pub dominance: Option<f64>,
    /// What the stopping rules look at.
    pub figures: Figures,
    /// Repairs: nugget raised, likelihood start failed.
    pub repairs: usize,
    /// Where simulations give results.
    pub feasibility: Feasibility,
    /// Which points to simulate next.
    pub(super) selection: Selection,
}

impl Assessment {
    /// Failure share of the system at the governing checkpoint.
    pub fn governing_failed(&self) -> f64 {
        self.curves[self.curves.len() - 1][self.governing]
    }

    /// So many points of the population where the surrogates know least, to be asked for; the selection knows of them.
    /// The `known` points `(d,)` were explored before and are in no surrogate.
    pub(super) fn explore(
        &mut self,
        population: (&Population, &[bool]),
        known: &[Vec<f64>],
        count: usize,
    ) -> Vec<usize> {
        if count == 0 {
            return vec![];
        }
        let models: Vec<&Kriging> = self.surrogates.iter().map(|surrogate| &surrogate.model).collect();
        let feasible = |points: MatRef<'_, f64>| self.feasibility.probability(points);
        let chosen = explore((&models, known), &self.modes, population, feasible, count);
        chosen.iter().for_each(|point| self.selection.leave(*point));
        chosen
    }

    /// What the round shows, over a population of so many points of a condition of this probability; its number, the evaluations,
    /// the governing cycle and the coefficient of variation are the campaign's to tell.
    pub(super) fn row(&self, condition: f64, population: usize) -> Round {
        let figures = &self.figures;
        let relative = |change: f64| change / figures.governing_share.max(1.0 / population as f64);
        Round {
            // Beyond 100 the figure says nothing more, and JSON has no infinity.
            min_u: figures.min_u.min(100.0),
            share_uncertain: self.share_uncertain,
            change_of_r: figures.change.map(relative),
            surrogate_error: figures.error,
            dominance: self.dominance,
            reliability_total: 1.0 - condition * self.governing_failed(),
            repairs: self.repairs,
            ..Round::default()
        }
    }

    /// Surrogate error and simulator noise per curve, at the checkpoints of the grid.
    pub(super) fn combined_errors(&self) -> Vec<Vec<(usize, f64)>> {
        let curves = self.errors.by_curve.iter().zip(&self.noise_shift);
        curves
            .map(|(errors, noise)| {
                let combined = errors.iter().zip(noise).map(|(error, noise)| error.hypot(*noise));
                self.grid.iter().copied().zip(combined).collect()
            })
            .collect()
    }
}

/// The pool holds at least this many points per point of a batch.
const POOL_PER_BATCH: usize = 8;

/// What a campaign knows when it assesses.
pub(super) struct Known<'a> {
    pub problem: &'a Problem,
    pub plan: &'a Plan,
    pub population: &'a Population,
    /// Points of the population that were asked for `(N,)`.
    pub asked: &'a [bool],
    /// Those of them that are under way.
    pub under_way: &'a [usize],
    pub observations: &'a Observations,
    pub failed: &'a [Failed],
    /// Surrogates of the round before, per mode; none before the first.
    pub surrogates: &'a [Surrogate],
    /// Curves of the round before, over the present population.
    pub previous: Option<&'a [Vec<f64>]>,
    /// Number of the round.
    pub round: u32,
}

/// Most that the cached predictions of all modes may take [bytes].
const CACHE: usize = 4 << 30;

/// Assesses the results with lengths found with the given effort. The caches, one a mode, hold predictions of this population.
pub(super) fn assess(
    known: &Known<'_>,
    caches: &mut [PredictionCache],
    effort: Effort,
) -> Result<Assessment, CampaignError> {
    let Known { problem, plan, population, asked, observations, previous, round, .. } = *known;
    let seed = plan.settings.seed;
    // Surrogates, one per mode, beside each other.
    let points = observations.points();
    let surrogates = problem
        .modes
        .par_iter()
        .enumerate()
        .map(|(s, mode)| {
            let values = observations.running_maxima(mode.output);
            let share = observations.design_share(&values, mode.threshold);
            let fitted_on = checkpoints_that_matter(&share, previous.map(|p| p[s].as_slice()), GRID);
            let errors = observations.errors_of_running_maxima(mode.output);
            let observed =
                Results { points: &points, values: &values, errors: &errors, threshold: mode.threshold };
            let before = known.surrogates.get(s);
            Surrogate::fit(
                &observed,
                fitted_on,
                before,
                effort,
                (plan.settings.forms, plan.settings.stated_errors),
            )
            .map_err(|source| CampaignError::Surrogate { mode: s, source })
        })
        .collect::<Result<Vec<Surrogate>, CampaignError>>()?;

    // Classification on the checkpoints that matter to any mode.
    let mut grid: Vec<usize> = surrogates.iter().flat_map(|s| s.fitted_on.iter().copied()).collect();
    grid.sort_unstable();
    grid.dedup();
    if grid.len() > GRID {
        grid = (0..GRID).map(|i| grid[i * (grid.len() - 1) / (GRID - 1)]).collect();
    }
    let cached = population.len() * points.ncols() * problem.modes.len() * size_of::<f64>() <= CACHE;
    if !cached {
        caches.fill(PredictionCache::default());
    }
    let modes: Vec<Classification> = surrogates
        .iter()
        .zip(&problem.modes)
        .zip(caches)
        .map(|((surrogate, mode), cache)| {
            if cached {
                classify_cached(cache, &surrogate.model, population, mode.threshold, &grid)
            } else {
                classify(&surrogate.model, population, mode.threshold, &grid)
            }
        })
        .collect();
    let first_failures: Vec<&[u32]> = modes.iter().map(|mode| mode.first_failure.as_slice()).collect();
    let curves = curves(&first_failures, problem.checkpoints.len());
    let coupled = coupled_criterion(&modes);

    // The pool, its posterior, and the error of the curves.
    let mut pool = choose_pool(&coupled, asked, POOL_PER_BATCH * plan.settings.batch, seed, round);
    let under_way = pool.members.len()..pool.members.len() + known.under_way.len();
    pool.members.extend(known.under_way);
    let d = population.dimension();
    let members = Mat::from_fn(d, pool.members.len(), |k, i| population.standardised(pool.members[i])[k]);
    let posteriors: Vec<Posterior> =
        surrogates.par_iter().map(|s| Posterior::new(&s.model, members.as_ref())).collect();
    let inflation: Vec<f64> = surrogates.iter().map(Surrogate::inflation).collect();
    let errors = estimate_errors(&modes, &coupled, &pool, &posteriors, &inflation, seed, round);

    let noise: Vec<f64> = surrogates.iter().map(|s| s.model.correlation().noise().sqrt()).collect();
    let noise_shift = noise_shifts(&modes, &noise);

    // Figures of the round.
    let system = curves.len() - 1;
    let governing = governing_checkpoint(&curves[system]);
    let on_grid = nearest(&grid, governing);
    let failed = curves[system][governing];
    let free = || coupled.iter().zip(asked).filter(|(_, asked)| !**asked).map(|(c, _)| c);
    let figures = Figures {
        points: observations.len(),
        min_u: free().map(|c| c.system).fold(f64::INFINITY, f64::min),
        change: previous.map(|previous| largest_difference(previous, &curves)),
        error: errors.largest(),
        governing_error: errors.by_curve[system][on_grid],
        governing_share: failed.min(1.0 - failed),
    };
    let uncertain = free().filter(|c| c.system < crate::statistics::learning::UNCERTAIN).count();
    let weights: Vec<f64> = pool.members.iter().filter_map(|j| dominance(&modes, *j, on_grid)).collect();
    let feasibility = Feasibility::new(points.as_ref(), known.failed, surrogates[0].model.correlation());
    let feasible = feasibility.probability(members.as_ref());
    let choice = (on_grid, plan.settings.learning);
    let selection = Selection::new(&modes, pool, posteriors, feasible, under_way, choice);
    Ok(Assessment {
        governing,
        share_uncertain: uncertain as f64 / population.len() as f64,
        dominance: (!weights.is_empty()).then(|| weights.iter().sum::<f64>() / weights.len() as f64),
        repairs: surrogates.iter().map(|s| s.repairs).sum(),
        figures,
        surrogates,
        modes,
        grid,
        curves,
        errors,
        noise_shift,
        feasibility,
        selection,
    })
}

fn nearest(grid: &[usize], checkpoint: usize) -> usize {
    (0..grid.len()).min_by_key(|i| grid[*i].abs_diff(checkpoint)).expect("the grid is never empty")
}

fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
