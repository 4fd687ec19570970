//! One round of learning on the results so far: fit, classify the population, estimate the error.

use super::campaign::{CampaignError, Problem};
use super::observations::Observations;
use crate::design::Population;
use crate::learning::{
    Classification, CurveErrors, Figures, Pool, checkpoints_that_matter, choose_pool, classify,
    coupled_criterion, curves, dominance, estimate_errors, noise_shifts,
};
use crate::reliability::governing_checkpoint;
use crate::surrogate::{
    Candidate, Effort, Form, FormSettings, Incumbent, Kriging, LeaveOneOut, NoiseShape, Posterior, Sharing,
    StatedErrors, TrainingSet, compare_sharing, fit_surrogate,
};
use faer::Mat;
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
    /// The pool of uncertain points and its joint posterior per mode.
    pub(super) pool: Pool,
    pub(super) posteriors: Vec<Posterior>,
}

impl Assessment {
    /// Failure share of the system at the governing checkpoint.
    pub fn governing_failed(&self) -> f64 {
        self.curves[self.curves.len() - 1][self.governing]
    }

    /// Index into the grid of the checkpoint nearest the governing one.
    pub fn governing_on_grid(&self) -> usize {
        nearest(&self.grid, self.governing)
    }
}

/// The surrogate of one mode.
#[derive(Debug)]
pub struct Surrogate {
    /// Conditioned on the running maximum at all m checkpoints.
    pub model: Kriging,
    /// Checkpoints whose likelihoods set the lengths.
    pub fitted_on: Vec<usize>,
    /// Leave-one-out figures at those.
    pub leave_one_out: Vec<LeaveOneOut>,
    /// The forms compared for it, if this fit compared any.
    pub candidates: Vec<Candidate>,
    /// Whether one correlation for all checkpoints does as well as separate ones, if this fit compared that.
    pub sharing: Option<Sharing>,
    /// Standard deviation of the noise that goes with the stated errors over the stated errors themselves (root mean
    /// squares over points and fitted checkpoints) [1]; absent where the surrogate makes nothing of them.
    pub share_of_stated: Option<f64>,
    /// Repairs.
    pub repairs: usize,
}

impl Surrogate {
    /// Factor on the predicted variances: the leave-one-out ratio where it shows them too small, averaged over the
    /// checkpoints, never below 1.
    fn inflation(&self) -> f64 {
        let ratios = self.leave_one_out.iter().map(|l| l.variance_ratio);
        (ratios.sum::<f64>() / self.leave_one_out.len() as f64).max(1.0)
    }
}

/// Assesses the results. `pool` is the least size of the pool, the seed and the number of the round.
#[allow(clippy::too_many_arguments)] // a pure function of everything a campaign knows
pub(super) fn assess(
    problem: &Problem,
    population: &Population,
    evaluated: &[bool],
    observations: &Observations,
    incumbents: &[Option<Incumbent>],
    previous: Option<&[Vec<f64>]>,
    (effort, reading): (Effort, StatedErrors),
    (least, seed, round): (usize, u64, u32),
) -> Result<Assessment, CampaignError> {
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
            let observed = (&points, &values, &errors);
            fit_mode(observed, fitted_on, incumbents[s].as_ref(), effort, reading)
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
    let modes: Vec<Classification> = surrogates
        .iter()
        .zip(&problem.modes)
        .map(|(surrogate, mode)| classify(&surrogate.model, population, mode.threshold, &grid))
        .collect();
    let first_failures: Vec<&[u32]> = modes.iter().map(|mode| mode.first_failure.as_slice()).collect();
    let curves = curves(&first_failures, problem.checkpoints.len());
    let coupled = coupled_criterion(&modes);

    // The pool, its posterior, and the error of the curves.
    let pool = choose_pool(&coupled, evaluated, least, seed, round);
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
    let free = || coupled.iter().zip(evaluated).filter(|(_, evaluated)| !**evaluated).map(|(c, _)| c);
    let figures = Figures {
        points: observations.len(),
        min_u: free().map(|c| c.system).fold(f64::INFINITY, f64::min),
        change: previous.map(|previous| largest_difference(previous, &curves)),
        error: errors.largest(),
        governing_error: errors.by_curve[system][on_grid],
        governing_share: failed.min(1.0 - failed),
    };
    let uncertain = free().filter(|c| c.system < crate::learning::UNCERTAIN).count();
    let weights: Vec<f64> = pool.members.iter().filter_map(|j| dominance(&modes, *j, on_grid)).collect();
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
        pool,
        posteriors,
    })
}

/// Fits and conditions the surrogate of one mode to points `(d, n)`, values `(n, m)` and their stated errors `(n, m)`.
fn fit_mode(
    (points, values, errors): (&Mat<f64>, &Mat<f64>, &Mat<f64>),
    fitted_on: Vec<usize>,
    incumbent: Option<&Incumbent>,
    effort: Effort,
    reading: StatedErrors,
) -> Result<Surrogate, crate::surrogate::SurrogateError> {
    let on_grid = |of: &Mat<f64>| Mat::from_fn(of.nrows(), fitted_on.len(), |i, o| of[(i, fitted_on[o])]);
    let (chosen, errors) = (on_grid(values), on_grid(errors));
    let noise = NoiseShape::new(chosen.as_ref(), errors.as_ref(), reading);
    let training = TrainingSet { points: points.as_ref(), values: chosen.as_ref(), noise: noise.as_ref() };
    let found = fit_surrogate(training, FormSettings::default(), incumbent, effort)?;
    let sharing = match effort {
        Effort::MultiStart => {
            let Incumbent { correlation, trend } = found.model.incumbent();
            compare_sharing(training, Form { kernel: correlation.kernel, trend }, &correlation)?
        }
        Effort::Warm => None,
    };
    let mut model = found.model;
    let leave_one_out = model.leave_one_out(chosen.as_ref());
    let stated = errors.squared_norm_l2() / errors.nrows() as f64;
    let as_noise = model.correlation().stated * model.sigma2().iter().sum::<f64>();
    let share_of_stated = noise.map(|_| (as_noise / stated).sqrt());
    model.set_values(values.as_ref());
    let (candidates, repairs) = (found.candidates, found.repairs);
    Ok(Surrogate { model, fitted_on, leave_one_out, candidates, sharing, share_of_stated, repairs })
}

fn nearest(grid: &[usize], checkpoint: usize) -> usize {
    (0..grid.len()).min_by_key(|i| grid[*i].abs_diff(checkpoint)).expect("the grid is never empty")
}

fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}
