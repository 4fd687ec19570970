//! Choice of the form (kernel and trend) of a surrogate by cross-validation.
//!
//! Every candidate is fitted by maximum likelihood and judged by the mean log predictive density at points
//! left out of the fit ([`CrossValidation`]; with fewer than ten points one point is left out at fixed
//! lengths),
//!
//!   (1/n) sum over i of ln N(y_i; mean_i, variance_i), averaged over the outputs,
//!
//! because learning depends on predicted variances as much as on means, while Q2 measures the means alone.
//! The incumbent (at first the Gaussian kernel with a constant trend, or the first allowed form) is replaced
//! only by a candidate that is better by more than one standard error of the paired differences over the
//! points and by more than [`LEAST_GAIN`]. So the form does not change from round to round without a reason.
//!
//! One correlation for all outputs of a limit state is compared with separate correlations in a similar way: the checkpoints are split
//! into an early and a late half; each half is fitted alone, from the shared optimum, and its leave-one-out log densities are compared
//! with those of the shared correlation, point by point. Leave-one-out at fixed lengths is too favourable to both (see
//! `cross_validation`), and more so to the separate ones, which have more lengths.
//!
//! # Source
//! Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, section 5.4.2; leave-one-out densities: eqs. 5.10 to 5.12; the
//! comparison of halves is this project's own.

use super::cross_validation::cross_validate;
use super::{
    Correlation, CrossValidation, Effort, Fitted, Form, FormSettings, Kriging, SurrogateError, TrainingSet,
    fit_correlation,
};

/// Gain in mean log density [1] below which two forms count as equal: 1 % of the density at a point.
const LEAST_GAIN: f64 = 0.01;

/// A surrogate of the chosen form.
#[derive(Debug, Clone)]
pub struct Chosen {
    /// Model conditioned on the training set.
    pub model: Kriging,
    /// Fit of its correlation.
    pub fitted: Fitted,
    /// Its cross-validation; `None` after a warm fit, and with too few points.
    pub cross_validation: Option<CrossValidation>,
    /// Number of repairs: starts without a usable point, forms that could not be conditioned, nuggets raised.
    pub repairs: usize,
    form: Form,
    /// Log densities with one point left out at fixed lengths `(n,)`, for fits without cross-validation.
    left_out: Vec<f64>,
}

impl Kriging {
    /// Form of the model.
    pub fn form(&self) -> Form {
        Form { kernel: self.correlation.kernel, trend: self.trend() }
    }
}

/// Fits a surrogate. With [`Effort::MultiStart`] the forms that `settings` leave open are compared; with
/// [`Effort::Warm`] the form of the incumbent is kept, where it is allowed. The result depends on the
/// arguments only.
///
/// # Errors
/// Those of [`Kriging::condition`] for the incumbent's form.
pub fn fit_surrogate(
    training: TrainingSet<'_>,
    settings: FormSettings,
    incumbent: Option<&Kriging>,
    effort: Effort,
) -> Result<Chosen, SurrogateError> {
    let forms = settings.candidates(training.points.nrows(), training.points.ncols());
    let standing = incumbent.map(Kriging::form).filter(|form| forms.contains(form)).unwrap_or(forms[0]);
    let previous = incumbent.map(|model| &model.correlation);
    let mut first = conditioned(training, standing, previous, effort)?;
    let mut repairs = first.repairs;
    let warm = effort == Effort::Warm && incumbent.is_some();
    if !warm {
        first.cross_validate(training);
    }
    if warm || forms.len() == 1 {
        return Ok(first);
    }

    // The other forms start from the incumbent's optimum, because a length has a similar meaning for all
    // kernels, and from the fixed start that was best for the first form: from the optimum alone they could
    // stop at a local optimum that depends on the incumbent, and the same data would give another choice.
    let from = first.fitted.correlation.clone();
    let effort = first.fitted.best_start.map_or(effort, Effort::TwoStarts);
    let mut compared = vec![first];
    for form in forms.iter().filter(|form| **form != standing) {
        match conditioned(training, *form, Some(&from), effort) {
            Ok(mut other) => {
                repairs += other.repairs;
                other.cross_validate(training);
                // Cross-validated forms are not compared with forms that could not be cross-validated.
                if other.cross_validation.is_some() == compared[0].cross_validation.is_some() {
                    compared.push(other);
                }
            }
            Err(_) => repairs += 1,
        }
    }
    Ok(Chosen { repairs, ..compared.swap_remove(challenger(&compared).unwrap_or(0)) })
}

/// Fits and conditions a surrogate of one form.
fn conditioned(
    training: TrainingSet<'_>,
    form: Form,
    previous: Option<&Correlation>,
    effort: Effort,
) -> Result<Chosen, SurrogateError> {
    let fitted = fit_correlation(training, form, previous, effort);
    let TrainingSet { points, values, .. } = training;
    let model =
        Kriging::condition_noisy(points, values, &fitted.correlation, form.trend, training.weights())?;
    let left_out = model.log_densities(values);
    let repairs = fitted.failed_starts + model.raised;
    Ok(Chosen { model, fitted, cross_validation: None, repairs, form, left_out })
}

impl Chosen {
    fn cross_validate(&mut self, training: TrainingSet<'_>) {
        self.cross_validation = cross_validate(training, self.form, &self.fitted.correlation);
    }

    fn densities(&self) -> &[f64] {
        self.cross_validation.as_ref().map_or(&self.left_out, |cross| &cross.log_densities)
    }

    fn log_density(&self) -> f64 {
        self.densities().iter().sum::<f64>() / self.densities().len() as f64
    }
}

/// Index of the form that replaces the first, if any does.
fn challenger(compared: &[Chosen]) -> Option<usize> {
    let none = vec![0.0; compared[0].left_out.len()];
    let clearly = |i: &usize| clearly_denser(&compared[0], &compared[*i], &none);
    let denser = |a: &usize, b: &usize| compared[*a].log_density().total_cmp(&compared[*b].log_density());
    (1..compared.len()).filter(clearly).max_by(denser)
}

/// True if `other`, whose log densities are comparable after these `shifts` `(n,)` [1], is better than `standing` by more than one standard
/// error and [`LEAST_GAIN`]; only with a cross-validation of both or of neither.
pub(super) fn clearly_denser(standing: &Chosen, other: &Chosen, shifts: &[f64]) -> bool {
    let shifted: Vec<f64> = other.densities().iter().zip(shifts).map(|(d, shift)| d + shift).collect();
    let (mean, standard_error) = gain(standing.densities(), &shifted);
    standing.cross_validation.is_some() == other.cross_validation.is_some()
        && mean > LEAST_GAIN.max(standard_error)
}

/// Mean gain of `other` over `standing`, log densities of the same points `(n,)`, and its standard error [1].
pub(super) fn gain(standing: &[f64], other: &[f64]) -> (f64, f64) {
    let n = standing.len() as f64;
    let differences = || standing.iter().zip(other).map(|(a, b)| b - a);
    let mean = differences().sum::<f64>() / n;
    let variance = differences().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Gain in mean log density [1] from which separate correlations are worth a factorisation each, together
/// with twice its standard error: 5 % of the density at a point.
const SEPARATE: f64 = 0.05;

/// Compares the correlation shared by all outputs with one for each half of them: true if separate ones are clearly better. `None`
/// with fewer than two outputs.
///
/// # Errors
/// Those of [`Kriging::condition`].
pub fn compare_sharing(
    training: TrainingSet<'_>,
    form: Form,
    shared: &Correlation,
) -> Result<Option<bool>, SurrogateError> {
    let m = training.values.ncols();
    if m < 2 {
        return Ok(None);
    }
    let n = training.points.ncols();
    let (mut jointly, mut apart) = (vec![0.0; n], vec![0.0; n]);
    for (first, count) in [(0, m / 2), (m / 2, m - m / 2)] {
        let half = TrainingSet { values: training.values.subcols(first, count), ..training };
        let own = fit_correlation(half, form, Some(shared), Effort::Warm).correlation;
        for (correlation, sum) in [(shared, &mut jointly), (&own, &mut apart)] {
            let weights = half.weights();
            let model = Kriging::condition_noisy(half.points, half.values, correlation, form.trend, weights)?;
            let share = count as f64 / m as f64;
            sum.iter_mut().zip(model.log_densities(half.values)).for_each(|(sum, d)| *sum += share * d);
        }
    }
    let (mean, standard_error) = gain(&jointly, &apart);
    Ok(Some(mean > SEPARATE.max(2.0 * standard_error)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::{Kernel, Trend};
    use faer::Mat;

    /// Points of a fixed sequence in [-2, 2].
    fn points(d: usize, n: usize) -> Mat<f64> {
        Mat::from_fn(d, n, |k, i| {
            4.0 * ((i + 1) as f64 * [0.819_172_513, 0.671_043_607, 0.549_700_478][k]).fract() - 2.0
        })
    }

    fn choose(x: &Mat<f64>, y: &Mat<f64>, incumbent: Option<&Kriging>, effort: Effort) -> Chosen {
        let training = TrainingSet { points: x.as_ref(), values: y.as_ref(), noise: None, is_exact: false };
        fit_surrogate(training, FormSettings::default(), incumbent, effort).unwrap()
    }

    #[test]
    fn a_linear_function_takes_a_linear_trend_and_a_kinked_one_a_rough_kernel() {
        let x = points(3, 60);
        let linear = Mat::from_fn(60, 1, |i, _| 3.0 + x[(0, i)] - 2.0 * x[(1, i)] + 0.1 * x[(2, i)]);
        let chosen = choose(&x, &linear, None, Effort::MultiStart);
        assert_eq!(chosen.model.trend(), Trend::Linear);
        let kinked = Mat::from_fn(60, 1, |i, _| (x[(0, i)] - 0.3).abs() + 0.5 * (x[(1, i)] + 0.2).abs());
        let chosen = choose(&x, &kinked, None, Effort::MultiStart);
        assert_ne!(chosen.model.correlation.kernel, Kernel::Gaussian);
        // The same data give the same choice.
        let again = choose(&x, &kinked, Some(&chosen.model), Effort::MultiStart);
        assert_eq!(again.model.form(), chosen.model.form());
    }

    #[test]
    fn a_smooth_function_keeps_the_gaussian_kernel() {
        let x = points(2, 40);
        let y = Mat::from_fn(40, 2, |i, o| (x[(0, i)] + 0.3 * o as f64).sin() * (0.7 * x[(1, i)]).cos());
        let chosen = choose(&x, &y, None, Effort::MultiStart);
        assert_eq!(chosen.model.correlation.kernel, Kernel::Gaussian);
        let training = TrainingSet { points: x.as_ref(), values: y.as_ref(), noise: None, is_exact: false };
        let log_density = |kernel| {
            let fixed = FormSettings { kernel: Some(kernel), trend: Some(Trend::Constant) };
            let found = fit_surrogate(training, fixed, None, Effort::MultiStart).unwrap();
            let densities = found.cross_validation.unwrap().log_densities;
            densities.iter().sum::<f64>() / densities.len() as f64
        };
        assert!(log_density(Kernel::Gaussian) > log_density(Kernel::Matern32) + 1.0);
        // Without the effort to compare, the incumbent's form stays.
        let correlation = Correlation { kernel: Kernel::Matern32, ..chosen.model.correlation.clone() };
        let rough =
            Kriging::condition_noisy(x.as_ref(), y.as_ref(), &correlation, Trend::Linear, None).unwrap();
        let kept = choose(&x, &y, Some(&rough), Effort::Warm);
        assert_eq!((kept.model.form(), kept.cross_validation), (rough.form(), None));
    }

    #[test]
    fn a_gain_within_its_standard_error_changes_nothing() {
        let standing = [0.0; 4];
        let exceeds = |(mean, standard_error): (f64, f64)| mean > LEAST_GAIN.max(standard_error);
        assert!(!exceeds(gain(&standing, &[1.0, -1.0, 1.0, -0.5])));
        assert!(!exceeds(gain(&standing, &[0.009; 4])));
        let clear = gain(&standing, &[1.0, 2.0, 1.0, 2.0]);
        assert!(exceeds(clear) && (clear.1 - (1.0f64 / 12.0).sqrt()).abs() < 1e-15);
    }

    fn compare(function: impl Fn(f64, f64, usize) -> f64) -> bool {
        let x = Mat::from_fn(2, 50, |k, i| {
            4.0 * ((i + 1) as f64 * [0.754_877_666, 0.569_840_296][k]).fract() - 2.0
        });
        let y = Mat::from_fn(50, 6, |i, o| function(x[(0, i)], x[(1, i)], o));
        let training = TrainingSet { points: x.as_ref(), values: y.as_ref(), noise: None, is_exact: false };
        let shared = fit_correlation(training, Form::default(), None, Effort::MultiStart).correlation;
        compare_sharing(training, Form::default(), &shared).unwrap().unwrap()
    }

    #[test]
    fn outputs_that_vary_alike_share_and_others_would_gain() {
        let alike = compare(|a, b, o| (1.0 + 0.1 * o as f64) * (a.sin() + 0.5 * (b + 0.05 * o as f64).cos()));
        assert!(!alike);
        // Early: quick along the first axis and still along the second; late: the other way round.
        let other =
            compare(|a, b, o| if o < 3 { (3.0 * a).sin() + 0.1 * b } else { (3.0 * b).sin() + 0.1 * a });
        assert!(other);
    }
}
