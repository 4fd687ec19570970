//! Lives of a population by the surrogates: every point's response is predicted at the start of life and at the checkpoints,
//! and its crossing of the threshold interpolated. The response of a point is its predicted mean and its deviation from that,
//! as in the classification, so that lives and failure shares belong together.
//!
//! # Source
//! The crossing as in `crossing.rs`, the numerical errors as in `life_counts.rs`; the predictions are those of Kriging, see
//! [`crate::surrogate`].

use super::crossing::Track;
use super::life_counts::ErrorLine;
use super::life_counts::{LifeCounts, ModeLives, ResponseErrors, mode_lives};
use crate::design::{Population, deviation};
use crate::surrogate::Kriging;
use faer::{Mat, MatRef};
use rayon::prelude::*;

/// Number of points predicted together.
const BLOCK: usize = 512;

/// The prediction of one limit state.
#[derive(Debug)]
pub struct PredictedMode<'a> {
    /// The surrogate conditioned on the values at the checkpoints, or on those and, first, the values at the start of life.
    pub model: &'a Kriging,
    /// Factor on the predicted variances [1].
    pub inflation: f64,
    /// Values of the simulations at the checkpoints `(n, m)` [unit of the output].
    pub values: MatRef<'a, f64>,
    /// Errors stated for them `(n, m)` [unit of the output].
    pub errors: MatRef<'a, f64>,
    /// Threshold of the limit state [unit of the output].
    pub threshold: f64,
    /// Index of the checkpoint by which each point has failed `(N,)`; m if never.
    pub first_failure: &'a [u32],
    /// Variance of the prediction of each point over the process variance `(N,)` [1]; empty if lives are those of the means.
    pub variance_factor: &'a [f64],
    /// Index of the mode: that of the deviations of its points.
    pub index: usize,
}

/// A mode with what is the same for all points.
struct PreparedMode<'a> {
    mode: &'a PredictedMode<'a>,
    dual: Mat<f64>,
    /// Stated error over the value at each checkpoint `(m,)`.
    lines: Vec<ErrorLine>,
    /// Standard deviation of each output of the model where the variance factor is 1: at the start, if it is known, and
    /// at the checkpoints [unit of the output].
    scale: Vec<f64>,
    /// True if the first output of the model is the start of life.
    has_start: bool,
}

impl<'a> PreparedMode<'a> {
    fn new(mode: &'a PredictedMode<'a>) -> Self {
        let sigma2 = mode.model.sigma2();
        let has_start = sigma2.len() > mode.values.ncols();
        Self {
            dual: mode.model.dual(),
            lines: ErrorLine::by_checkpoint(mode.values, mode.errors),
            scale: sigma2.iter().map(|s| (s * mode.inflation).sqrt()).collect(),
            has_start,
            mode,
        }
    }

    /// Lives of point `j`, whose predicted means are `means`: at the start, if it is known, and at the checkpoints.
    fn lives(&self, j: usize, means: &[f64], times: &[f64], room: &mut Room) -> ModeLives {
        let std = self.mode.variance_factor.get(j).map_or(0.0, |factor| factor.max(0.0).sqrt());
        let in_sigma = std * deviation(self.mode.index, j);
        room.values.clear();
        room.values.extend(means.iter().zip(&self.scale).map(|(mean, scale)| mean + scale * in_sigma));
        let checkpoints = usize::from(self.has_start);
        let (start, values) = (self.has_start.then_some(room.values[0]), &room.values[checkpoints..]);
        room.numerical.clear();
        room.numerical.extend(self.lines.iter().zip(values).map(|(line, y)| line.evaluate(*y)));
        room.predicted.clear();
        room.predicted.extend(self.scale[checkpoints..].iter().map(|scale| scale * std));
        let errors = ResponseErrors { numerical: &room.numerical, predicted: &room.predicted };
        let first = self.mode.first_failure[j] as usize;
        mode_lives(&Track { times, values, start }, &errors, self.mode.threshold, first, &mut room.shifted)
    }
}

/// Memory for the values of one point, their errors and shifted values.
#[derive(Default)]
struct Room {
    values: Vec<f64>,
    numerical: Vec<f64>,
    predicted: Vec<f64>,
    shifted: Vec<f64>,
}

/// Counts the lives of all points of a population over the checkpoints `times` `(m,)` [cycles].
pub fn population_lives(modes: &[PredictedMode<'_>], population: &Population, times: &[f64]) -> LifeCounts {
    let prepared: Vec<PreparedMode<'_>> = modes.iter().map(PreparedMode::new).collect();
    let blocks: Vec<usize> = (0..population.len()).step_by(BLOCK).collect();
    let empty = || LifeCounts::new(modes.len(), times.len());
    let add_block = |mut counts: LifeCounts, start: &usize| {
        let end = population.len().min(start + BLOCK);
        let predict = |mode: &PreparedMode<'_>| {
            let outputs = mode.mode.model.sigma2().len();
            mode.mode.model.predict_means(population.columns(*start..end), &mode.dual, 0..outputs)
        };
        let means: Vec<Mat<f64>> = prepared.iter().map(predict).collect();
        let mut room = Room::default();
        for j in *start..end {
            let of_mode = |(mode, means): (&PreparedMode<'_>, &Mat<f64>)| {
                mode.lives(j, means.col_as_slice(j - start), times, &mut room)
            };
            let lives: Vec<ModeLives> = prepared.iter().zip(&means).map(of_mode).collect();
            counts.add(&lives);
        }
        counts
    };
    blocks.par_iter().fold(empty, add_block).reduce(empty, |a, b| a.merged(&b))
}

#[cfg(test)]
mod tests {
    use super::super::life_counts::LifeEstimate;
    use super::*;
    use crate::surrogate::{Correlation, Kernel};
    use common::random::{Distribution, standard_normal_cdf};

    #[test]
    fn a_linear_response_is_shifted_by_its_errors() {
        // One standard normal variable, response z + t at checkpoints t = 1, 2, 3, limit 2, error 0.5:
        // P_f(t) = Phi(t - 2), shifted by 0.5, at every time.
        let normal = Distribution::truncated_normal(0.0, 1.0, -8.0, 8.0).unwrap();
        let population = Population::draw(&[normal], 40_000, 1);
        let x = Mat::from_fn(1, 30, |_, i| population.standardised(i)[0]);
        let y = Mat::from_fn(30, 4, |i, n| x[(0, i)] + n as f64);
        let correlation =
            Correlation { kernel: Kernel::Gaussian, theta: vec![1e-3], nugget: 1e-10, stated: 0.0 };
        let model = Kriging::condition(x.as_ref(), y.as_ref(), &correlation).unwrap();
        let errors = Mat::from_fn(30, 3, |_, _| 0.5);
        let first_failure: Vec<u32> = (0..population.len())
            .map(|j| {
                let z = population.standardised(j)[0];
                [1.0, 2.0, 3.0].iter().position(|t| z + t >= 2.0).unwrap_or(3) as u32
            })
            .collect();
        let mode = PredictedMode {
            model: &model,
            inflation: 1.0,
            values: y.subcols(1, 3),
            errors: errors.as_ref(),
            threshold: 2.0,
            first_failure: &first_failure,
            variance_factor: &vec![0.0; population.len()],
            index: 0,
        };
        let counts = population_lives(&[mode], &population, &[1.0, 2.0, 3.0]);
        let parts = counts.parts();
        for (estimate, shift) in [
            (LifeEstimate::Best, 0.0),
            (LifeEstimate::Earliest, 0.0),
            (LifeEstimate::Unsafe, 0.5),
            (LifeEstimate::Safe, -0.5),
        ] {
            let failed = counts.failed(0, estimate);
            for t in [0.5, 1.0, 1.5, 2.0, 2.75, 3.0] {
                // What lies beyond the limit at the start fails at once; the shifted tail of the first interval is bounded only.
                let expected = standard_normal_cdf(t - 2.0 + shift);
                let found = failed[(t * parts as f64) as usize - 1];
                // Four standard errors of a share of 40 000, and half a part of an interval.
                assert!((found - expected).abs() < 4.0 * 0.5 / 200.0, "{estimate:?} {t}: {found} {expected}");
            }
        }
        let band = counts.numerical_band();
        assert_eq!(band.most[0], band.most[1]);
        assert!((band.most[0][1] - standard_normal_cdf(0.5)).abs() < 0.01, "{band:?}");
    }
}
