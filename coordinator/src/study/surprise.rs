//! What results say of surrogates that have not seen them: whether they matter to what fails, and how unexpected they are.
//!
//! A result matters where it is on the other side of the threshold than predicted, or nearer to it than half of what was
//! predicted. One that explores and does not matter has tested the surrogates and is not taken up by them: far from the limit a
//! response may be so steep (`rp31` among the published problems, 256 x^4) that no stationary correlation serves it and the
//! surroundings of the limit at once.

use super::observations::{Observations, Observed};
use super::surrogates::{Results, Surrogate};
use crate::statistics::learning::{Mode, running_maximum};
use faer::{Mat, MatRef};

impl Surrogate {
    /// Largest error of the predictions of results that are not in the surrogate yet and matter, in predicted standard deviations
    /// with the [`Surrogate::inflation`]; 0 if there are none [1].
    fn surprise(&self, results: &Results<'_>) -> f64 {
        let (n, all) = (self.model.points(), results.points.ncols());
        if all == n {
            return 0.0;
        }
        let prediction = self.model.predict(results.points.subcols(n, all - n));
        let (noise, inflation) = (self.model.correlation().noise(), self.inflation());
        let surprise = |i: usize, o: usize| {
            let (value, mean) = (results.values[(n + i, o)], prediction.mean[(o, i)]);
            let variance = self.model.sigma2()[o] * (prediction.variance_factor[i] + noise) * inflation;
            let error = (value - mean).abs() / variance.max(f64::MIN_POSITIVE).sqrt();
            if matters(value, mean, results.threshold) { error } else { 0.0 }
        };
        let pairs = (0..all - n).flat_map(|i| self.fitted_on.iter().map(move |o| (i, *o)));
        pairs.map(|(i, o)| surprise(i, o)).fold(0.0, f64::max)
    }
}

fn matters(value: f64, predicted: f64, threshold: f64) -> bool {
    let (left, predicted) = (threshold - value, threshold - predicted);
    left * predicted < 0.0 || left.abs() < 0.5 * predicted.abs()
}

/// Largest surprise of any surrogate by what was observed since it was made.
pub(super) fn largest_surprise(surrogates: &[Surrogate], modes: &[Mode], observations: &Observations) -> f64 {
    let points = observations.points();
    let of = |(surrogate, mode): (&Surrogate, &Mode)| {
        let values = observations.running_maxima(mode.output);
        let errors = observations.errors_of_running_maxima(mode.output);
        let threshold = mode.threshold;
        surrogate.surprise(&Results { points: &points, values: &values, errors: &errors, threshold })
    };
    surrogates.iter().zip(modes).map(of).fold(0.0, f64::max)
}

/// Whether a result at the standardised point `z` matters to any surrogate, at any of the checkpoints it was fitted on.
pub(super) fn matters_to(surrogates: &[Surrogate], modes: &[Mode], z: &[f64], observed: &Observed) -> bool {
    let point: Mat<f64> = MatRef::from_column_major_slice(z, z.len(), 1).to_owned();
    surrogates.iter().zip(modes).any(|(surrogate, mode)| {
        let mean = surrogate.model.predict(point.as_ref()).mean;
        let values = running_maximum(&observed.histories[mode.output]);
        surrogate.fitted_on.iter().any(|o| matters(values[*o], mean[(*o, 0)], mode.threshold))
    })
}

#[cfg(test)]
mod tests {
    use super::matters;

    #[test]
    fn what_matters_is_nearer_to_the_limit_than_predicted_or_beyond_it() {
        let cases = [(9.0, 5.0), (10.5, 9.9), (12.0, 20.0), (9.0, 11.0)].map(|(v, p)| matters(v, p, 10.0));
        assert_eq!(cases, [true; 4]);
        let cases = [(5.0, 5.0), (-90.0, 5.0), (6.0, 5.0), (20.0, 12.0)].map(|(v, p)| matters(v, p, 10.0));
        assert_eq!(cases, [false; 4]);
    }
}
