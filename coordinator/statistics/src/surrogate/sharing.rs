//! Comparison of one correlation for all outputs of a limit state with separate correlations.
//!
//! The checkpoints are split into an early and a late half; each half is fitted alone, from the shared
//! optimum, and its leave-one-out log densities are compared with those of the shared correlation, point by
//! point. Leave-one-out at fixed lengths is too favourable to both (see `cross_validation`), and more so to
//! the separate ones, which have more lengths.
//!
//! # Source
//! Leave-one-out densities: Rasmussen, Williams (2006), Gaussian Processes for Machine Learning, eqs. 5.10 to
//! 5.12; the comparison of halves is this project's own.

use super::choice::Gain;
use super::{Correlation, Effort, Form, Kriging, SurrogateError, TrainingSet, fit_correlation};

/// Gain in mean log density [1] from which separate correlations are worth a factorisation each, together
/// with twice its standard error: 5 % of the density at a point.
const WORTH: f64 = 0.05;

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
    let gain = Gain::between(&jointly, &apart);
    Ok(Some(gain.exceeds(WORTH.max(2.0 * gain.standard_error))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::Mat;

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
