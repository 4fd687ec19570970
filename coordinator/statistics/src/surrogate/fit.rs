//! Maximum likelihood of the correlation parameters theta_1 .. theta_d, nugget and level of the stated noise:
//! descents from several starts, of which the best is continued to its end.
//!
//! The function f to be minimised is that of [`Likelihood`]. It has several local minima; with 400 points and
//! more the starts compete on 250 of them, because the best start shows there at 3 % of the cost.
//!
//! Fixed starts of the descents of a likelihood.
//!
//! With w_k the mean squared linear correlation of variable k with the outputs, a weighted start has
//! theta_k = sum (0.02 / d + 0.98 w_k / (w_1 + ... + w_d)); an isotropic one theta_k = sum / d.
//!
//! # Source
//! Multi-start maximum likelihood of Kriging: Lophaven, Nielsen, Sondergaard (2002), DACE, a Matlab Kriging
//! toolbox; the competition of starts on a part of the points is this project's own.
//! This project's own choice, from the fits of its built-in scenes.

use super::bounds::{Bounds, NUGGET, THETA};
use super::likelihood::{DescentResult, descend};
use super::{Correlation, Form, Kernel, Likelihood, NoiseShape};
use faer::{ColRef, Mat, MatRef};
use rayon::prelude::*;

/// Number of points from which starts compete on a part of the points: the start that leads to the best
/// optimum shows there already, at 3 % of the cost of 937 points.
const RACE_FROM: usize = 400;
/// Number of points of that part.
const RACE_POINTS: usize = 250;
/// Most iterations of a competing start.
const RACE: u64 = 25;
/// Most iterations of the last descent.
const LAST: u64 = 60;

/// Least theta and nugget from which the fit to a part of the points starts: where all points gave a variable
/// or the noise no influence, the likelihood is flat, and the descent would not leave it.
const REFIT_FROM: (f64, f64) = (1e-4, 1e-6);

/// Effort of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// No fit: the previous parameters stay.
    Keep,
    /// One descent from the previous parameters.
    Warm,
    /// Descents from several fixed starts and from the previous parameters.
    MultiStart,
    /// Descents from the fixed start of this number and from the previous parameters.
    TwoStarts(usize),
}

/// Data to which a surrogate is fitted.
#[derive(Debug, Clone, Copy)]
pub struct TrainingSet<'a> {
    /// Points in standardised units `(d, n)` [1].
    pub points: MatRef<'a, f64>,
    /// Values `(n, m)` [unit of the output].
    pub values: MatRef<'a, f64>,
    /// Noise of the points in proportion to stated errors, if it is used.
    pub noise: Option<&'a NoiseShape>,
    /// True for values without noise: the nugget is that against round-off and not fitted.
    pub is_exact: bool,
}

impl<'a> TrainingSet<'a> {
    /// Weights of the points' noise `(n,)` [1]; `None` if all are equal.
    pub fn weights(&self) -> Option<&'a [f64]> {
        self.noise.map(|noise| noise.weights.as_slice())
    }

    /// Bounds of the correlation with this kernel.
    fn bounds(&self, kernel: Kernel) -> Bounds {
        Bounds::new(kernel, self.points.nrows(), self.noise.map(|noise| noise.levels), self.is_exact)
    }
}

/// Correlation of greatest likelihood, with figures of its fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The fitted parameters.
    pub correlation: Correlation,
    /// f at the fitted parameters, see [`Likelihood`].
    pub value: f64,
    /// Number of evaluations of the likelihood.
    pub evaluations: usize,
    /// Number of starts without any usable point.
    pub failed_starts: usize,
    /// Number of the fixed start that reached the lowest f, if several starts competed.
    pub best_start: Option<usize>,
}

/// Returns the correlation of greatest likelihood for a surrogate of this form.
///
/// Columns of the values without variance carry no information on lengths and are left out; if none remains,
/// the lengths are the longest allowed. The kernel of `previous` is ignored. The result depends on the
/// arguments only.
pub fn fit_correlation(
    training: TrainingSet<'_>,
    form: Form,
    previous: Option<&Correlation>,
    effort: Effort,
) -> Fitted {
    let (d, n) = training.points.shape();
    let Form { kernel, trend } = form;
    let values = standardise(training.values);
    if values.ncols() == 0 {
        let correlation = Correlation { kernel, theta: vec![THETA.0; d], nugget: NUGGET.0, stated: 0.0 };
        let value = f64::NEG_INFINITY;
        return Fitted { correlation, value, evaluations: 0, failed_starts: 0, best_start: None };
    }
    let weights = training.weights();
    let likelihood = Likelihood { points: training.points, values: values.as_ref(), trend, weights };
    let bounds = training.bounds(kernel);
    let to_free = |correlation: &Correlation| bounds.free(correlation);
    let mut starts: Vec<Vec<f64>> = previous.map(to_free).into_iter().collect();
    let before = starts.len();
    let fixed = || fixed_starts(kernel, &likelihood);
    match effort {
        Effort::TwoStarts(number) => starts.extend(fixed().iter().skip(number).take(1).map(to_free)),
        Effort::Keep | Effort::Warm if !starts.is_empty() => {}
        _ => starts.extend(fixed().iter().map(to_free)),
    }
    if starts.len() == 1 {
        let outcome = descend(&likelihood, bounds, starts.swap_remove(0), LAST);
        return finish(bounds, outcome.best, outcome.evaluations, 0, None);
    }
    // All starts in parallel, each far enough to distinguish them; then the best to its end.
    let race = |likelihood: &Likelihood<'_>| -> Vec<DescentResult> {
        starts.into_par_iter().map(|start| descend(likelihood, bounds, start, RACE)).collect()
    };
    let whole = n < RACE_FROM;
    let outcomes = if whole { race(&likelihood) } else { on_part(&likelihood, race) };
    let mut evaluations = outcomes.iter().map(|o| o.evaluations).sum();
    let failed_starts = outcomes.iter().filter(|o| o.best.is_none()).count();
    let value_of = |outcome: &DescentResult| outcome.best.as_ref().map_or(f64::INFINITY, |best| best.1);
    let values: Vec<f64> = outcomes[before..].iter().map(value_of).collect();
    let best_start = (0..values.len()).min_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut best = outcomes.into_iter().filter_map(|o| o.best).reduce(|a, b| if b.1 < a.1 { b } else { a });
    if let Some((free, value)) = &best {
        let last = descend(&likelihood, bounds, free.clone(), LAST);
        evaluations += last.evaluations;
        // f of a part of the points cannot be compared with f of all points.
        best = last.best.filter(|last| !whole || last.1 < *value).or(best.filter(|_| whole));
    }
    finish(bounds, best, evaluations, failed_starts, best_start)
}

/// Returns the correlation of greatest likelihood for a part of the points, by one descent from `whole`, that
/// of all points.
pub(super) fn refit(part: TrainingSet<'_>, form: Form, whole: &Correlation) -> Correlation {
    let values = standardise(part.values);
    let weights = part.weights();
    let likelihood = Likelihood { points: part.points, values: values.as_ref(), trend: form.trend, weights };
    let bounds = part.bounds(form.kernel);
    let theta = whole.theta.iter().map(|theta| theta.max(REFIT_FROM.0)).collect();
    let start = Correlation { theta, nugget: whole.nugget.max(REFIT_FROM.1), ..whole.clone() };
    if values.ncols() == 0 {
        return start;
    }
    let best = descend(&likelihood, bounds, bounds.free(&start), RACE).best;
    best.map_or_else(|| bounds.cautious(), |(free, _)| bounds.correlation(&free))
}

/// The fitted correlation of the best free parameters, or a cautious one without any.
fn finish(
    bounds: Bounds,
    best: Option<(Vec<f64>, f64)>,
    evaluations: usize,
    failed_starts: usize,
    best_start: Option<usize>,
) -> Fitted {
    let failed_starts = failed_starts + usize::from(best.is_none() && failed_starts == 0);
    let (correlation, value) = match best {
        Some((free, value)) => (bounds.correlation(&free), value),
        None => (bounds.cautious(), f64::INFINITY),
    };
    Fitted { correlation, value, evaluations, failed_starts, best_start }
}

/// What `of` finds with [`RACE_POINTS`] points evenly over their order, so of the initial design and of the points added later.
fn on_part<T>(whole: &Likelihood<'_>, of: impl FnOnce(&Likelihood<'_>) -> T) -> T {
    let n = whole.points.ncols();
    let index = |i: usize| i * n / RACE_POINTS;
    let (d, m) = (whole.points.nrows(), whole.values.ncols());
    let points = Mat::from_fn(d, RACE_POINTS, |k, i| whole.points[(k, index(i))]);
    let values = Mat::from_fn(RACE_POINTS, m, |i, o| whole.values[(index(i), o)]);
    let weights: Option<Vec<f64>> =
        whole.weights.map(|weights| (0..RACE_POINTS).map(|i| weights[index(i)]).collect());
    let (points, values) = (points.as_ref(), values.as_ref());
    of(&Likelihood { points, values, trend: whole.trend, weights: weights.as_deref() })
}

/// The columns with variance, scaled to mean 0 and variance 1, so that outputs of any unit have the same
/// weight.
fn standardise(values: MatRef<'_, f64>) -> Mat<f64> {
    let n = values.nrows() as f64;
    let standard = |column: ColRef<'_, f64>| {
        let mean = column.iter().sum::<f64>() / n;
        let std = (column.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / n).sqrt();
        (std > 1e-12 * mean.abs() && std > 0.0).then(|| column.iter().map(|y| (y - mean) / std).collect())
    };
    let columns: Vec<Vec<f64>> = values.col_iter().filter_map(standard).collect();
    Mat::from_fn(values.nrows(), columns.len(), |i, o| columns[o][i])
}

/// Level of the stated noise at the starts [1].
const STATED_START: f64 = 1e-4;

/// Isotropic starts at three lengths, and two with theta in proportion to the squared linear correlation
/// between variable and outputs, which are close to the optimum if few variables matter.
pub(super) fn fixed_starts(kernel: Kernel, likelihood: &Likelihood<'_>) -> Vec<Correlation> {
    let d = likelihood.points.nrows();
    let isotropic =
        |sum: f64| Correlation { kernel, theta: vec![sum / d as f64; d], nugget: 1e-4, stated: STATED_START };
    let influence: Vec<f64> = (0..d).map(|k| mean_squared_correlation(likelihood, k)).collect();
    let total: f64 = influence.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let weighted = |sum: f64| Correlation {
        kernel,
        theta: influence.iter().map(|w| sum * (0.02 / d as f64 + 0.98 * w / total)).collect(),
        nugget: 1e-4,
        stated: STATED_START,
    };
    vec![isotropic(0.02), isotropic(0.2), isotropic(2.0), weighted(0.02), weighted(0.4)]
}

/// Squared covariance of variable `k` with an output over the variance of the variable, mean over the
/// outputs, which have variance 1.
fn mean_squared_correlation(likelihood: &Likelihood<'_>, k: usize) -> f64 {
    let x = likelihood.points.row(k);
    let n = x.ncols() as f64;
    let mean = x.iter().sum::<f64>() / n;
    let var = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>().max(f64::MIN_POSITIVE);
    let squared = |y: ColRef<'_, f64>| {
        let cov: f64 = x.iter().zip(y.iter()).map(|(x, y)| (x - mean) * y).sum();
        cov * cov / (var * n)
    };
    likelihood.values.col_iter().map(squared).sum::<f64>() / likelihood.values.ncols() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a fixed low-discrepancy sequence in [-2, 2].
    fn points(d: usize, n: usize) -> Mat<f64> {
        Mat::from_fn(d, n, |k, i| {
            let irrational = [0.754_877_666, 0.569_840_296, 0.819_172_513][k % 3];
            4.0 * ((i + 1) as f64 * irrational).fract() - 2.0
        })
    }

    fn training<'a>(x: &'a Mat<f64>, y: &'a Mat<f64>) -> TrainingSet<'a> {
        TrainingSet { points: x.as_ref(), values: y.as_ref(), noise: None, is_exact: false }
    }

    #[test]
    fn finds_which_variable_matters_and_that_there_is_no_noise() {
        let x = points(3, 60);
        let y = Mat::from_fn(60, 1, |i, _| (1.5 * x[(0, i)]).sin() + 0.3 * x[(1, i)]);
        let fitted = fit_correlation(training(&x, &y), Form::default(), None, Effort::MultiStart);
        let theta = &fitted.correlation.theta;
        assert!(theta[0] > 10.0 * theta[1] && theta[1] > theta[2], "{theta:?}");
        assert!(theta[2] < 1e-4 && fitted.correlation.nugget < 1e-6, "{:?}", fitted.correlation);
    }

    #[test]
    fn estimates_the_share_of_noise() {
        use rand::SeedableRng;
        use rand_distr::Distribution;
        let n = 200;
        let x = points(2, n);
        let mut rng = rand_chacha::ChaCha12Rng::seed_from_u64(1);
        let noise: Vec<f64> =
            (0..n).map(|_| rand_distr::StandardNormal.sample(&mut rng)).map(|e: f64| 0.05 * e).collect();
        let y = Mat::from_fn(n, 1, |i, _| (1.5 * x[(0, i)]).sin() + 0.3 * x[(1, i)] + noise[i]);
        let fitted = fit_correlation(training(&x, &y), Form::default(), None, Effort::MultiStart);
        let model =
            crate::surrogate::Kriging::condition(x.as_ref(), y.as_ref(), &fitted.correlation).unwrap();
        // The noise's standard deviation from 200 points: known to about 6 %.
        let std = (model.sigma2[0] * model.correlation.nugget).sqrt();
        assert!((std / 0.05 - 1.0).abs() < 0.2, "{std}");
    }

    #[test]
    fn optimum_is_stationary_and_reproducible() {
        let x = points(3, 50);
        let y = Mat::from_fn(50, 2, |i, o| (x[(0, i)] + 0.5 * o as f64).sin() + 0.2 * x[(1, i)] * x[(2, i)]);
        let fitted = fit_correlation(training(&x, &y), Form::default(), None, Effort::MultiStart);
        assert_eq!(fitted, fit_correlation(training(&x, &y), Form::default(), None, Effort::MultiStart));
        let again =
            fit_correlation(training(&x, &y), Form::default(), Some(&fitted.correlation), Effort::Warm);
        assert!(
            (fitted.value - again.value).abs() < 1e-2,
            "{} {} {:?} {:?}",
            fitted.value,
            again.value,
            fitted.correlation,
            again.correlation
        );
    }

    #[test]
    fn constant_values_give_the_longest_lengths() {
        let x = points(2, 10);
        let y = Mat::from_fn(10, 1, |_, _| 3.0);
        let fitted = fit_correlation(training(&x, &y), Form::default(), None, Effort::MultiStart);
        assert_eq!(fitted.correlation.theta, vec![THETA.0; 2]);
    }

    #[test]
    fn starts_raced_on_a_part_of_the_points_lead_to_the_optimum_of_all() {
        let n = RACE_FROM + 20;
        let x = points(3, n);
        let y = Mat::from_fn(n, 1, |i, _| (1.5 * x[(0, i)]).sin() + 0.3 * x[(1, i)] * x[(2, i)]);
        let raced = fit_correlation(training(&x, &y), Form::default(), None, Effort::MultiStart);
        assert_eq!(raced.failed_starts, 0);
        // From a good start on all points nothing better is found.
        let start = Correlation { theta: vec![0.3, 0.02, 0.02], nugget: 1e-9, ..raced.correlation.clone() };
        let direct = fit_correlation(training(&x, &y), Form::default(), Some(&start), Effort::Warm);
        assert!(raced.value < direct.value + 0.02, "{} {}", raced.value, direct.value);
    }
}
