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
//! # Source
//! Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, section 5.4.2.

use super::cross_validation::cross_validate;
use super::{
    Correlation, CrossValidation, Effort, Fitted, Form, FormSettings, Kriging, SurrogateError, TrainingSet,
    Trend, fit_correlation,
};

/// Gain in mean log density [1] below which two forms count as equal: 1 % of the density at a point.
const LEAST_GAIN: f64 = 0.01;

/// Correlation and trend of the previous fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Incumbent {
    /// Correlation of the previous fit.
    pub correlation: Correlation,
    /// Trend of the previous fit.
    pub trend: Trend,
}

impl Incumbent {
    /// Kernel and trend as a form.
    pub fn form(&self) -> Form {
        Form { kernel: self.correlation.kernel, trend: self.trend }
    }
}

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
    /// Correlation and trend from which the next fit starts.
    pub fn incumbent(&self) -> Incumbent {
        Incumbent { correlation: self.correlation().clone(), trend: self.trend() }
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
    incumbent: Option<&Incumbent>,
    effort: Effort,
) -> Result<Chosen, SurrogateError> {
    let forms = settings.candidates(training.points.nrows(), training.points.ncols());
    let standing = incumbent.map(Incumbent::form).filter(|form| forms.contains(form)).unwrap_or(forms[0]);
    let previous = incumbent.map(|incumbent| &incumbent.correlation);
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
    let repairs = fitted.failed_starts + model.raised();
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
    let standing = &compared[0];
    let clearly =
        |i: &usize| Gain::between(standing.densities(), compared[*i].densities()).exceeds(LEAST_GAIN);
    let denser = |a: &usize, b: &usize| compared[*a].log_density().total_cmp(&compared[*b].log_density());
    (1..compared.len()).filter(clearly).max_by(denser)
}

/// Gain of one set of log densities over another, point by point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gain {
    /// Mean gain [1].
    pub mean: f64,
    /// Standard error of the mean [1].
    pub standard_error: f64,
}

impl Gain {
    /// Gain of `other` over `standing`, log densities of the same points `(n,)`.
    pub fn between(standing: &[f64], other: &[f64]) -> Self {
        let n = standing.len() as f64;
        let differences = || standing.iter().zip(other).map(|(a, b)| b - a);
        let mean = differences().sum::<f64>() / n;
        let variance = differences().map(|gain| (gain - mean).powi(2)).sum::<f64>() / (n - 1.0);
        Self { mean, standard_error: (variance / n).sqrt() }
    }

    /// True if the mean gain exceeds both `least` and its own standard error.
    pub fn exceeds(&self, least: f64) -> bool {
        self.mean > least.max(self.standard_error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surrogate::Kernel;
    use faer::Mat;

    /// Points of a fixed sequence in [-2, 2].
    fn points(d: usize, n: usize) -> Mat<f64> {
        Mat::from_fn(d, n, |k, i| {
            4.0 * ((i + 1) as f64 * [0.819_172_513, 0.671_043_607, 0.549_700_478][k]).fract() - 2.0
        })
    }

    fn choose(x: &Mat<f64>, y: &Mat<f64>, incumbent: Option<&Incumbent>, effort: Effort) -> Chosen {
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
        assert_ne!(chosen.model.correlation().kernel, Kernel::Gaussian);
        // The same data give the same choice.
        let again = choose(&x, &kinked, Some(&chosen.model.incumbent()), Effort::MultiStart);
        assert_eq!(again.model.incumbent().form(), chosen.model.incumbent().form());
    }

    #[test]
    fn a_smooth_function_keeps_the_gaussian_kernel() {
        let x = points(2, 40);
        let y = Mat::from_fn(40, 2, |i, o| (x[(0, i)] + 0.3 * o as f64).sin() * (0.7 * x[(1, i)]).cos());
        let chosen = choose(&x, &y, None, Effort::MultiStart);
        assert_eq!(chosen.model.correlation().kernel, Kernel::Gaussian);
        let training = TrainingSet { points: x.as_ref(), values: y.as_ref(), noise: None, is_exact: false };
        let log_density = |kernel| {
            let fixed = FormSettings::fixed(Form { kernel, ..Form::default() });
            let found = fit_surrogate(training, fixed, None, Effort::MultiStart).unwrap();
            let densities = found.cross_validation.unwrap().log_densities;
            densities.iter().sum::<f64>() / densities.len() as f64
        };
        assert!(log_density(Kernel::Gaussian) > log_density(Kernel::Matern32) + 1.0);
        // Without the effort to compare, the incumbent's form stays.
        let rough = Incumbent {
            correlation: Correlation { kernel: Kernel::Matern32, ..chosen.model.correlation().clone() },
            trend: Trend::Linear,
        };
        let kept = choose(&x, &y, Some(&rough), Effort::Warm);
        assert_eq!((kept.model.incumbent().form(), kept.cross_validation), (rough.form(), None));
    }

    #[test]
    fn a_gain_within_its_standard_error_changes_nothing() {
        let standing = [0.0; 4];
        assert!(!Gain::between(&standing, &[1.0, -1.0, 1.0, -0.5]).exceeds(LEAST_GAIN));
        assert!(!Gain::between(&standing, &[0.009; 4]).exceeds(LEAST_GAIN));
        let gain = Gain::between(&standing, &[1.0, 2.0, 1.0, 2.0]);
        assert!(gain.exceeds(LEAST_GAIN) && (gain.standard_error - (1.0f64 / 12.0).sqrt()).abs() < 1e-15);
    }
}
