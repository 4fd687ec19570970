//! Lives of a population by the surrogates: every point's response is predicted at the start of life and at the checkpoints,
//! and its crossing of the threshold interpolated. The response of a point is its predicted mean and its deviation from that,
//! as in the classification, so that lives and failure shares belong together.
//!
//! # Source
//! The crossing as in `crossing.rs`, the numerical errors as in `life_counts.rs`; the predictions are those of Kriging, see
//! [`crate::surrogate`].

use super::crossing::Track;
use super::life_counts::{ErrorLine, LifeCounts, ModeLives, mode_lives};
use crate::design::{Population, deviation};
use crate::surrogate::{Kriging, ResponseScale};
use faer::Mat;
use rayon::prelude::*;

/// Number of points predicted together.
const BLOCK: usize = 512;

/// A surrogate of a history: its first output is the start of life, if that is known, the others are the checkpoints.
#[derive(Debug)]
pub struct PredictedHistory {
    /// The surrogate conditioned on these values.
    pub model: Kriging,
    /// Its dual weights, see [`Kriging::dual`].
    pub dual: Mat<f64>,
    /// Predicted standard deviations of what is learned where the variance factor is 1 [unit of the output, or 1 of logarithms].
    pub scale: Vec<f64>,
    /// True if the first output of the model is the start of life.
    pub has_start: bool,
    /// Scale in which the model has learned the values.
    pub learned: ResponseScale,
    /// Value at the start of life of all points, which the model does not contain [unit of the output].
    pub start: Option<f64>,
}

impl PredictedHistory {
    /// The history of a model whose predicted variances are enlarged by `inflation` [1].
    pub fn new(model: Kriging, has_start: bool, inflation: f64) -> Self {
        let scale = model.sigma2.iter().map(|s| (s * inflation).sqrt()).collect();
        let learned = ResponseScale::Values;
        Self { dual: model.dual(), scale, has_start, model, learned, start: None }
    }

    /// Values at the start, if the model has it, and at the checkpoints [unit of the output] from their predicted `means`, `deviation`
    /// standard deviations away where the variance factor is 1.
    pub fn values<'a>(&'a self, means: &'a [f64], deviation: f64) -> impl Iterator<Item = f64> + 'a {
        means.iter().zip(&self.scale).map(move |(mean, scale)| self.learned.value(mean + scale * deviation))
    }

    /// The checkpoint at which the history of these `means` and this `deviation`, see [`Self::values`], first reaches `threshold` [unit of
    /// the output]. `values` then holds it as far as its crossing needs it; the others are not numbers.
    pub fn reached(
        &self,
        means: &[f64],
        deviation: f64,
        threshold: f64,
        values: &mut Vec<f64>,
    ) -> Option<usize> {
        let first = usize::from(self.has_start);
        let value = |o: usize| self.learned.value(means[o] + self.scale[o] * deviation);
        // An exponential takes longer than all the rest: only what may reach the threshold but for rounding needs one.
        let bound = self.learned.learned(threshold);
        let may_reach = |o: usize| means[o] + self.scale[o] * deviation >= bound - 1e-9 * (1.0 + bound.abs());
        let reached = (first..means.len()).find(|o| may_reach(*o) && value(*o) >= threshold)?;
        values.clear();
        values.resize(means.len(), f64::NAN);
        let around = reached.saturating_sub(2)..means.len().min(reached + 3);
        (0..first).chain(around).for_each(|o| values[o] = value(o));
        Some(reached - first)
    }

    /// The history with these values at the start, if the model has it, and at the checkpoints.
    pub fn track<'a>(&self, times: &'a [f64], values: &'a [f64]) -> Track<'a> {
        let (start, values) =
            if self.has_start { (Some(values[0]), &values[1..]) } else { (self.start, values) };
        Track { times, values, start }
    }
}

/// The prediction of one limit state.
#[derive(Debug)]
pub struct PredictedMode<'a> {
    /// The surrogate of its response.
    pub history: PredictedHistory,
    /// Stated error over the value at each checkpoint `(m,)`.
    pub lines: Vec<ErrorLine>,
    /// Threshold of the limit state [unit of the output].
    pub threshold: f64,
    /// Index of the checkpoint by which each point has failed `(N,)`; m if never.
    pub first_failure: &'a [u32],
    /// Variance of the prediction of each point over the process variance `(N,)` [1]; empty if lives are those of the means.
    pub variance_factor: &'a [f64],
    /// Index of the mode: that of the deviations of its points.
    pub index: usize,
}

impl PredictedMode<'_> {
    /// Lives of point `j`, whose predicted means are `means`: at the start, if it is known, and at the checkpoints. `room` is
    /// memory for its values, their errors and its shifted values.
    fn lives(&self, j: usize, means: &[f64], times: &[f64], room: &mut [Vec<f64>; 4]) -> ModeLives {
        let PredictedHistory { scale, has_start, learned, .. } = &self.history;
        let [values, numerical, predicted, shifted] = room;
        let std = self.variance_factor.get(j).map_or(0.0, |factor| factor.max(0.0).sqrt());
        let in_sigma = std * deviation(self.index, j);
        values.clear();
        values.extend(self.history.values(means, in_sigma));
        let track = self.history.track(times, values);
        numerical.clear();
        numerical.extend(self.lines.iter().zip(track.values).map(|(line, y)| line.evaluate(*y)));
        predicted.clear();
        let of_checkpoints = track.values.iter().zip(&scale[usize::from(*has_start)..]);
        predicted.extend(of_checkpoints.map(|(y, scale)| learned.slope(*y) * scale * std));
        let first = self.first_failure[j] as usize;
        mode_lives(&track, (numerical, predicted), self.threshold, first, shifted)
    }
}

/// Counts the lives of all points of a population over the checkpoints `times` `(m,)` [cycles].
pub fn population_lives(modes: &[PredictedMode<'_>], population: &Population, times: &[f64]) -> LifeCounts {
    let blocks: Vec<usize> = (0..population.len()).step_by(BLOCK).collect();
    let empty = || LifeCounts::new(modes.len(), times.len());
    let add_block = |mut counts: LifeCounts, start: &usize| {
        let end = population.len().min(start + BLOCK);
        let predict = |PredictedMode { history, .. }: &PredictedMode<'_>| {
            let outputs = 0..history.scale.len();
            history.model.predict_means(population.columns(*start..end), &history.dual, outputs)
        };
        let means: Vec<Mat<f64>> = modes.iter().map(predict).collect();
        let mut room = <[Vec<f64>; 4]>::default();
        for j in *start..end {
            let of_mode = |(mode, means): (&PredictedMode<'_>, &Mat<f64>)| {
                mode.lives(j, means.col_as_slice(j - start), times, &mut room)
            };
            let lives: Vec<ModeLives> = modes.iter().zip(&means).map(of_mode).collect();
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
            history: PredictedHistory::new(model, true, 1.0),
            lines: ErrorLine::by_checkpoint(y.subcols(1, 3), errors.as_ref()),
            threshold: 2.0,
            first_failure: &first_failure,
            variance_factor: &vec![0.0; population.len()],
            index: 0,
        };
        let counts = population_lives(&[mode], &population, &[1.0, 2.0, 3.0]);
        let parts = counts.parts;
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
        let [_, most] = &band;
        assert_eq!(most[0], most[1]);
        assert!((most[0][1] - standard_normal_cdf(0.5)).abs() < 0.01, "{band:?}");
    }
}
