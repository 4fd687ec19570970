//! The surrogate of one limit state: fitted anew, or extended by the latest results; and the surrogates of a campaign between
//! two rounds, with their cached predictions.

use super::mode_results::{ModeResults, columns};
use super::observations::Observations;
use super::outliers::outliers;
use super::{CampaignError, Plan};
use crate::statistics::learning::{LearnedThreshold, Mode, checkpoints_that_matter};
use crate::statistics::surrogate::{
    Chosen, CrossValidation, Effort, Kriging, LeaveOneOut, NoiseShape, PredictionCache, ResponseScale,
    SurrogateError, compare_sharing,
};
use faer::Mat;
use rayon::prelude::*;

/// Most checkpoints used for one mode, and for all modes together.
pub(super) const GRID: usize = 24;

/// The surrogate of one mode.
#[derive(Debug, Clone)]
pub struct Surrogate {
    /// Conditioned on the running maximum at all m checkpoints.
    pub model: Kriging,
    /// Scale in which the response is learned.
    pub scale: ResponseScale,
    /// Indices of the checkpoints whose likelihood determines the lengths.
    pub fitted_on: Vec<usize>,
    /// Leave-one-out figures at these checkpoints.
    pub leave_one_out: Vec<LeaveOneOut>,
    /// Cross-validation of the last fit from several starts.
    pub cross_validation: Option<CrossValidation>,
    /// Mean of squared errors over predicted variances in the cross-validation, at the results nearest to the
    /// threshold [1].
    variance_ratio: Option<f64>,
    /// True if separate correlations would be clearly better than one for all checkpoints, by the last fit from several starts.
    pub separate_would_gain: Option<bool>,
    /// Standard deviation of the noise in proportion to the stated errors, over the stated errors themselves
    /// (root mean squares over points and fitted checkpoints) [1]; `None` if the surrogate does not use them.
    pub share_of_stated: Option<f64>,
    /// Variance of the simulations' noise over that of their values, largest over the fitted checkpoints [1].
    pub noise_share: f64,
    /// Outliers at the fitted checkpoints: checkpoint, index of the result, and distance from the median of all over their interquartile
    /// range [1].
    pub(super) outliers: Vec<(usize, usize, f64)>,
    /// Number of repairs: starts of the likelihood that failed, and nuggets raised.
    pub repairs: usize,
    /// Threshold that the surrogate uses, in its scale, and the jump of the response there.
    pub threshold: LearnedThreshold,
    /// Change of the values over that of what is learned, at the middle of the results `(m,)` [unit of the output, or 1 of values].
    slopes: Vec<f64>,
    /// Noise of the points in proportion to the stated errors.
    noise: Option<NoiseShape>,
    /// Number of results of the initial design.
    initial: usize,
}

impl Surrogate {
    /// Fits and conditions a surrogate of these results, which are values. With [`Effort::Keep`] the surrogate of the round before is
    /// extended by the new results at its lengths; if its factor cannot be extended, it is fitted with [`Effort::Warm`]. With
    /// [`Effort::MultiStart`] values and logarithms of a response over several checkpoints are compared.
    ///
    /// # Errors
    /// Those of [`fit_surrogate`] and [`compare_sharing`].
    pub(super) fn fit(
        results: &ModeResults<'_>,
        fitted_on: Vec<usize>,
        before: Option<&Self>,
        (plan, effort): (&Plan, Effort),
    ) -> Result<Self, SurrogateError> {
        let as_before = before.and_then(|before| results.in_scale(before.scale));
        let before = before.filter(|_| as_before.is_some());
        let standing = as_before.as_ref().unwrap_or(results);
        if effort == Effort::Keep
            && let Some(extended) = before.and_then(|before| before.extended(standing))
        {
            return Ok(extended);
        }
        let effort = if effort == Effort::Keep { Effort::Warm } else { effort };
        let found = standing.fitted(&fitted_on, before.map(|before| &before.model), (plan, effort))?;
        let values = columns(&results.values, &fitted_on);
        let is_compared =
            effort == Effort::MultiStart && !plan.is_as_published() && results.values.ncols() > 1;
        let other = results.in_scale(standing.scale.other()).filter(|other| {
            is_compared && (other.scale == ResponseScale::Values || ResponseScale::is_wide(values.as_ref()))
        });
        let Some(other) = other else {
            return Self::conditioned(standing, found, fitted_on, before, (plan, effort));
        };
        match other.fitted(&fitted_on, None, (plan, effort)) {
            Ok(better) if standing.scale.is_surpassed(values.as_ref(), &found, &better) => {
                Self::conditioned(&other, better, fitted_on, None, (plan, effort))
            }
            _ => Self::conditioned(standing, found, fitted_on, before, (plan, effort)),
        }
    }

    /// The surrogate of all checkpoints by the form and lengths `found` for these results.
    fn conditioned(
        results: &ModeResults<'_>,
        found: Chosen,
        fitted_on: Vec<usize>,
        before: Option<&Self>,
        (plan, effort): (&Plan, Effort),
    ) -> Result<Self, SurrogateError> {
        let (chosen, noise) = results.chosen(&fitted_on, plan);
        let mut model = found.model;
        let mut cross_validation = found.cross_validation;
        let threshold = results.learned_threshold();
        let near = |crossed: &CrossValidation| crossed.variance_ratio_near(threshold.value, chosen.as_ref());
        let (mut separate_would_gain, mut variance_ratio) = (None, cross_validation.as_ref().map(near));
        if effort == Effort::MultiStart {
            let training = results.training(&chosen, noise.as_ref(), plan);
            separate_would_gain = compare_sharing(training, model.form(), &model.correlation)?;
        } else if let Some(before) = before {
            separate_would_gain = before.separate_would_gain;
            cross_validation = before.cross_validation.clone();
            variance_ratio = before.variance_ratio;
        }
        if plan.is_as_published() {
            variance_ratio = Some(1.0);
        }
        match &results.sides {
            Some(sides) => model.set_sides(sides.values.as_ref()),
            None => model.set_values(results.values.as_ref()),
        }
        let mut surrogate = Self {
            model,
            scale: results.scale,
            fitted_on,
            leave_one_out: vec![],
            cross_validation,
            variance_ratio,
            separate_would_gain,
            share_of_stated: None,
            noise_share: 0.0,
            outliers: vec![],
            repairs: found.repairs,
            threshold,
            slopes: vec![],
            noise,
            initial: plan.settings.initial,
        };
        surrogate.update_figures(results);
        Ok(surrogate)
    }

    /// The surrogate with the new points added at the same lengths; `None` if the factor cannot be extended
    /// by them.
    fn extended(&self, results: &ModeResults<'_>) -> Option<Self> {
        let (n, all) = (self.model.points(), results.points.ncols());
        if n == all {
            return Some(Self { repairs: 0, ..self.clone() });
        }
        let rows = |of: &Mat<f64>| of.subrows(n, all - n).to_owned();
        let weights = self.noise.as_ref().map(|noise| {
            let errors = columns(&rows(results.learned().1), &results.columns_of(&self.fitted_on));
            noise.weights_of(errors.as_ref())
        });
        let (points, values) = (results.points.subcols(n, all - n), rows(results.learned().0));
        let model = self.model.extended(points, values.as_ref(), weights.as_deref()).ok()?;
        let threshold = results.learned_threshold();
        let mut extended = Self { model, repairs: 0, threshold, ..self.clone() };
        extended.update_figures(results);
        Some(extended)
    }

    /// Updates the leave-one-out figures, and the noise in relation to the stated errors and to the variance
    /// of the values.
    fn update_figures(&mut self, results: &ModeResults<'_>) {
        let all = self.model.leave_one_out(results.learned().0.as_ref());
        self.leave_one_out = self.fitted_on.iter().map(|n| all[*n]).collect();
        let errors = columns(&results.errors, &self.fitted_on);
        let stated = errors.squared_norm_l2() / errors.nrows() as f64;
        let sigma2: f64 = self.fitted_on.iter().map(|n| self.model.sigma2[*n]).sum();
        let as_noise = self.model.correlation.stated * sigma2;
        self.share_of_stated = self.noise.as_ref().map(|_| (as_noise / stated).sqrt());
        let noise = self.model.correlation.noise();
        let share = |n: &usize| {
            let values = results.values.col(*n);
            let mean = values.iter().sum::<f64>() / values.nrows() as f64;
            let variance = values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / values.nrows() as f64;
            if variance > 0.0 { noise * self.model.sigma2[*n] / variance } else { 0.0 }
        };
        self.noise_share = self.fitted_on.iter().map(share).fold(0.0, f64::max);
        let middle = |column: faer::ColRef<'_, f64>| column.iter().sum::<f64>() / column.nrows() as f64;
        let slope = |column| self.scale.slope(self.scale.value(middle(column)));
        self.slopes = results.values.col_iter().map(slope).collect();
        let initial = self.initial;
        let of_checkpoint = |n: &usize| {
            let values: Vec<f64> = results.values.col(*n).iter().copied().collect();
            let n = *n;
            outliers(&values, initial).into_iter().map(move |(i, distance)| (n, i, distance))
        };
        self.outliers = self.fitted_on.iter().flat_map(of_checkpoint).collect();
    }

    /// Largest distance of an outlier from the median of all values over their interquartile range [1]; `None` without outliers.
    pub(super) fn outlier(&self) -> Option<f64> {
        self.outliers.iter().map(|(.., distance)| *distance).reduce(f64::max)
    }

    /// Variance of the roughness `(m,)` [unit of the output] over that of the process, a mean over the fitted checkpoints [1]; 0 without
    /// any.
    pub(super) fn rough_share(&self, rough: Option<&[f64]>) -> f64 {
        let Some(rough) = rough else { return 0.0 };
        let sigma2 = &self.model.sigma2;
        let share = |n: &usize| {
            let rough = rough[n % rough.len()] / self.slopes[n % self.slopes.len()];
            if sigma2[*n] > 0.0 { rough * rough / sigma2[*n] } else { 0.0 }
        };
        self.fitted_on.iter().map(share).sum::<f64>() / self.fitted_on.len() as f64
    }

    /// Scale in which these values `(n, m)` of an output are predicted with the lengths of this surrogate: its own, as far as they allow it.
    pub(super) fn scale_of(&self, values: &Mat<f64>) -> ResponseScale {
        if self.scale.allows(values.as_ref()) { self.scale } else { ResponseScale::Values }
    }

    /// Factor on the predicted variances [1], at least 1: the mean of squared errors over predicted variances
    /// of the cross-validation, or of leave-one-out if there is none, averaged over the checkpoints.
    pub fn inflation(&self) -> f64 {
        let ratios = self.leave_one_out.iter().map(|l| l.variance_ratio);
        self.variance_ratio.unwrap_or(ratios.sum::<f64>() / self.leave_one_out.len() as f64).max(1.0)
    }
}

/// Fits one surrogate per mode, in parallel; `before` are those of the round before and `curves` its failure shares `(modes, m)`,
/// if there was one.
///
/// # Errors
/// [`CampaignError::Surrogate`].
pub(super) fn fit_surrogates(
    observations: &Observations,
    modes: &[Mode],
    (before, curves): (&[Surrogate], Option<&[Vec<f64>]>),
    (plan, effort): (&Plan, Effort),
) -> Result<Vec<Surrogate>, CampaignError> {
    let fit = |(s, mode): (usize, &Mode)| {
        let observations = observations.design_of(s);
        let points = observations.points();
        let results = ModeResults::new(&observations, &points, mode);
        let share = observations.design_share(&results.values, mode.threshold);
        let fitted_on = checkpoints_that_matter(&share, curves.map(|curves| curves[s].as_slice()), GRID);
        Surrogate::fit(&results, fitted_on, before.get(s), (plan, effort))
            .map_err(|source| CampaignError::Surrogate { mode: s, source })
    };
    modes.par_iter().enumerate().map(fit).collect()
}

/// Growth of the number of results after which the lengths are fitted anew: every fit costs a prediction of
/// the whole population, while points added at the same lengths cost a row each.
const REFIT: f64 = 1.1;
/// Growth after which the lengths are fitted from several starts, and forms compared, against a lasting local
/// optimum.
const FRESH_FIT: f64 = 1.3;

/// Surrogates of the last round and the state of their fits.
#[derive(Debug)]
pub(super) struct SurrogateState {
    /// Surrogates of the last round, one per mode; empty before the first round.
    pub models: Vec<Surrogate>,
    /// Predictions of the present population, one cache per mode.
    pub caches: Vec<PredictionCache>,
    /// Failure curves of the last round over the present population `(modes + 1, m)`.
    pub previous_curves: Option<Vec<Vec<f64>>>,
    /// Number of results at the last fit of the lengths.
    fitted_at: usize,
    /// Number of results at the last fit from several starts.
    fresh_at: usize,
}

impl SurrogateState {
    /// The state before the first round.
    pub fn new(modes: usize) -> Self {
        Self {
            models: Vec::new(),
            caches: vec![PredictionCache::default(); modes],
            previous_curves: None,
            fitted_at: 0,
            fresh_at: 0,
        }
    }

    /// Effort of the next fit over `n` results.
    pub fn effort(&self, n: usize) -> Effort {
        let (n, fitted, fresh) = (n as f64, self.fitted_at as f64, self.fresh_at as f64);
        if n >= FRESH_FIT * fresh {
            Effort::MultiStart
        } else if n >= REFIT * fitted {
            Effort::Warm
        } else {
            Effort::Keep
        }
    }

    /// Records a fit of this effort over `n` results.
    pub fn record_fit(&mut self, effort: Effort, n: usize) {
        match effort {
            Effort::Keep => {}
            Effort::Warm | Effort::TwoStarts(_) => self.fitted_at = n,
            Effort::MultiStart => (self.fitted_at, self.fresh_at) = (n, n),
        }
    }

    /// Has the lengths fitted anew in the next round.
    pub fn require_fit(&mut self) {
        self.fitted_at = 0;
    }

    /// True if the last fit from several starts used nine tenths of `n` results or more.
    pub fn is_fresh(&self, n: usize) -> bool {
        (n as f64) < REFIT * self.fresh_at as f64
    }

    /// Forgets what was computed over the previous population.
    pub fn reset_population(&mut self) {
        self.caches.fill(PredictionCache::default());
        self.previous_curves = None;
    }
}
