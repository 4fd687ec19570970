//! Counts of the lives of many samples: when each limit state of a sample is reached, by the best estimate, by its bounds,
//! and with the response shifted by its errors.
//!
//! Every interval between two checkpoints is divided into equal parts; a life falls into a part, and the parts of one interval
//! never mix with those of the next, so that the shares at the checkpoints are those of the classification. The system's life
//! is the shortest of its limit states, for each estimate by itself.
//!
//! Range of the reliability under the numerical errors of the simulations: R(n) is counted twice more, with all responses
//! shifted by their errors to the unsafe and to the safe side.
//!
//! The numerical error of neighbouring simulations is alike, so it moves all responses together. It is 1.96 standard deviations of the
//! correction by pairs of levels, see [`super::super::levels`], or without pairs the error that the simulations state, which is larger
//! than nearly all true ones. The range enters the interval of R(n) as an independent part of it, on either side.
//!
//! With surrogates the error of a point of the population follows from a straight line through the stated
//! errors e_i over the values y_i at the same checkpoint, by least squares, clamped to the range of the
//! stated errors:
//!
//!   e(y) = mean(e) + slope (y - mean(y)),   slope = sum (y_i - mean(y)) (e_i - mean(e)) / sum (y_i - mean(y))^2.
//!
//! So the error may grow with the response, as that of a growing vibration does.
//!
//! # Source
//! Derived here, from the crossings of `crossing.rs`.
//! The line is ordinary least squares; the range is this project's own convention.

use super::crossing::{Crossing, Track};
use faer::MatRef;

/// A life: the interval in which it ends, and the share of the interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LifePosition {
    /// Index of the checkpoint at the end of the interval.
    pub interval: u32,
    /// Share of the interval that has passed [1].
    pub share: f64,
}

impl LifePosition {
    /// A life beyond the last checkpoint.
    pub const NEVER: Self = Self { interval: u32::MAX, share: 0.0 };

    /// The shorter of two lives.
    #[must_use]
    pub fn earlier(self, other: Self) -> Self {
        if (other.interval, other.share) < (self.interval, self.share) { other } else { self }
    }
}

/// Least number of parts of all intervals together.
const PARTS: usize = 4096;
/// Least number of parts of one interval.
const LEAST_PARTS: usize = 2;

/// An estimate of a life.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LifeEstimate {
    /// Best estimate of the life.
    Best,
    /// Shortest life that the values at the checkpoints allow.
    Earliest,
    /// Longest life that they allow.
    Latest,
    /// Best estimate with the response larger by its numerical error.
    Unsafe,
    /// Best estimate with the response smaller by its numerical error.
    Safe,
    /// Best estimate with the response larger by its predicted standard deviation.
    Larger,
    /// Best estimate with the response smaller by its predicted standard deviation.
    Smaller,
}

/// Number of estimates.
const ESTIMATES: usize = 7;

/// Lives of one sample by one limit state, one per [`LifeEstimate`].
pub type ModeLives = [LifePosition; ESTIMATES];

/// Lives of a response by a threshold [unit of the output]. `first` is the index of the first checkpoint by which it has failed,
/// m if never; `room` is memory for its shifted values. The errors of the values at the checkpoints `(m,)` [unit of the output] are
/// the numerical ones, the same for all points, and the predicted standard deviations, none for simulated values.
pub fn mode_lives(
    track: &Track<'_>,
    (numerical, predicted): (&[f64], &[f64]),
    threshold: f64,
    first: usize,
    room: &mut Vec<f64>,
) -> ModeLives {
    let m = track.times.len();
    let place = |k: usize, share: f64| LifePosition { interval: k as u32, share };
    let mut lives = [LifePosition::NEVER; ESTIMATES];
    if first < m {
        let Crossing { best, earliest, latest } = track.crossing(first, threshold);
        lives.iter_mut().zip([best, earliest, latest]).for_each(|(life, share)| *life = place(first, share));
    }
    let mut shifted = |of: &[f64], sign: f64| {
        room.clear();
        room.extend(track.values.iter().zip(of).map(|(value, error)| value + sign * error));
        let Some(k) = room.iter().position(|value| *value >= threshold) else { return LifePosition::NEVER };
        let start = track.start.map(|start| start + sign * of[0]);
        place(k, Track { values: room, start, ..*track }.crossing(k, threshold).best)
    };
    lives[LifeEstimate::Unsafe as usize] = shifted(numerical, 1.0);
    lives[LifeEstimate::Safe as usize] = shifted(numerical, -1.0);
    let best = lives[LifeEstimate::Best as usize];
    let mut by_prediction = |sign: f64| if predicted.is_empty() { best } else { shifted(predicted, sign) };
    lives[LifeEstimate::Larger as usize] = by_prediction(1.0);
    lives[LifeEstimate::Smaller as usize] = by_prediction(-1.0);
    lives
}

/// Counts over the samples of a population.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LifeCounts {
    /// Number of limit states.
    modes: usize,
    /// Number m of intervals.
    intervals: usize,
    /// Number of parts of one interval.
    pub parts: usize,
    /// Number of samples.
    samples: usize,
    /// Number of lives that end in each part `(modes + 1, estimates, m parts)`, the system last.
    counts: Vec<u32>,
    /// Number of lives that end at their very start, among those of the first part `(modes + 1, estimates)`.
    at_start: Vec<u32>,
    /// Number of samples that each limit state fails first, then of those that several fail at once `(modes + 1, m)`.
    first: Vec<u32>,
}

impl LifeCounts {
    /// No samples yet of `modes` limit states over m `intervals`.
    pub fn new(modes: usize, intervals: usize) -> Self {
        let parts = PARTS.div_ceil(intervals.max(1)).max(LEAST_PARTS);
        let counts = vec![0; (modes + 1) * ESTIMATES * intervals * parts];
        let (at_start, first) = (vec![0; (modes + 1) * ESTIMATES], vec![0; (modes + 1) * intervals]);
        Self { modes, intervals, parts, samples: 0, counts, at_start, first }
    }

    /// Adds a sample: the lives by each limit state `(modes,)`.
    pub fn add(&mut self, lives: &[ModeLives]) {
        self.samples += 1;
        for estimate in 0..ESTIMATES {
            let mut system = LifePosition::NEVER;
            for (mode, lives) in lives.iter().enumerate() {
                self.count(mode, estimate, lives[estimate]);
                system = system.earlier(lives[estimate]);
            }
            self.count(self.modes, estimate, system);
            if estimate == LifeEstimate::Best as usize && system != LifePosition::NEVER {
                let mut firsts = (0..self.modes).filter(|mode| lives[*mode][estimate] == system);
                let mode = firsts.next().unwrap_or(self.modes);
                let cause = if firsts.next().is_some() { self.modes } else { mode };
                self.first[cause * self.intervals + system.interval as usize] += 1;
            }
        }
    }

    fn count(&mut self, curve: usize, estimate: usize, life: LifePosition) {
        if life != LifePosition::NEVER {
            let part = ((life.share * self.parts as f64).ceil() as usize).clamp(1, self.parts) - 1;
            let parts = self.intervals * self.parts;
            let row = (curve * ESTIMATES + estimate) * parts;
            self.counts[row + life.interval as usize * self.parts + part] += 1;
            if life.interval == 0 && life.share <= 0.0 {
                self.at_start[curve * ESTIMATES + estimate] += 1;
            }
        }
    }

    /// Adds the counts of other samples.
    #[must_use]
    pub fn merged(mut self, other: &Self) -> Self {
        self.samples += other.samples;
        self.counts.iter_mut().zip(&other.counts).for_each(|(a, b)| *a += b);
        self.at_start.iter_mut().zip(&other.at_start).for_each(|(a, b)| *a += b);
        self.first.iter_mut().zip(&other.first).for_each(|(a, b)| *a += b);
        self
    }

    /// Shares of the samples that have failed by the end of each part, by one estimate of their lives `(m parts,)` [1]. Curve
    /// `curve` is a limit state, or the system after the last one.
    pub fn failed(&self, curve: usize, estimate: LifeEstimate) -> Vec<f64> {
        let parts = self.intervals * self.parts;
        let row = (curve * ESTIMATES + estimate as usize) * parts;
        self.cumulated(&self.counts[row..row + parts])
    }

    /// Share of the samples that exceed a limit at the start of life, by one estimate of their lives [1].
    pub fn failed_at_start(&self, curve: usize, estimate: LifeEstimate) -> f64 {
        f64::from(self.at_start[curve * ESTIMATES + estimate as usize]) / self.samples.max(1) as f64
    }

    fn cumulated(&self, counts: &[u32]) -> Vec<f64> {
        let add = |sum: &mut u64, count: &u32| {
            *sum += u64::from(*count);
            Some(*sum as f64 / self.samples.max(1) as f64)
        };
        counts.iter().scan(0, add).collect()
    }

    /// Failure shares at the checkpoints with every response smaller, and larger, by its stated numerical errors
    /// `(limit states + 1, m)` [1].
    pub fn numerical_band(&self) -> [Vec<Vec<f64>>; 2] {
        let at_checkpoints = |curve: usize, estimate: LifeEstimate| {
            self.failed(curve, estimate).into_iter().skip(self.parts - 1).step_by(self.parts).collect()
        };
        let shares = |estimate: LifeEstimate| (0..=self.modes).map(|c| at_checkpoints(c, estimate)).collect();
        [shares(LifeEstimate::Safe), shares(LifeEstimate::Unsafe)]
    }

    /// Shares of the samples that have failed by each checkpoint, by the limit state that failed first; last those
    /// that several failed at once `(modes + 1, m)` [1]. They add up to the failure share of the system.
    pub fn first_failure_shares(&self) -> Vec<Vec<f64>> {
        self.first.chunks(self.intervals).map(|counts| self.cumulated(counts)).collect()
    }
}

/// Stated error as a straight line over the value, clamped to [least, most].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorLine {
    centre: f64,
    mean: f64,
    slope: f64,
    least: f64,
    most: f64,
}

impl ErrorLine {
    /// The least-squares line through pairs of value and error; constant without any spread of the values.
    pub fn fit(pairs: &[(f64, f64)]) -> Self {
        let n = pairs.len().max(1) as f64;
        let centre = pairs.iter().map(|(y, _)| y).sum::<f64>() / n;
        let mean = pairs.iter().map(|(_, e)| e).sum::<f64>() / n;
        let square: f64 = pairs.iter().map(|(y, _)| (y - centre).powi(2)).sum();
        let product: f64 = pairs.iter().map(|(y, e)| (y - centre) * (e - mean)).sum();
        let slope = if square > 0.0 { product / square } else { 0.0 };
        let least = pairs.iter().map(|(_, e)| *e).fold(mean, f64::min);
        let most = pairs.iter().map(|(_, e)| *e).fold(mean, f64::max);
        Self { centre, mean, slope, least, most }
    }

    /// The lines at each checkpoint `(m,)` through values and their errors `(n, m)`.
    pub fn by_checkpoint(values: MatRef<'_, f64>, errors: MatRef<'_, f64>) -> Vec<Self> {
        let pairs = |k: usize| values.col(k).iter().copied().zip(errors.col(k).iter().copied());
        (0..values.ncols()).map(|k| Self::fit(&pairs(k).collect::<Vec<_>>())).collect()
    }

    /// Error at a value [unit of the output].
    pub fn evaluate(&self, value: f64) -> f64 {
        (self.mean + self.slope * (value - self.centre)).clamp(self.least, self.most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn life(interval: u32, share: f64) -> ModeLives {
        [LifePosition { interval, share }; ESTIMATES]
    }

    #[test]
    fn every_failure_of_the_system_has_one_cause() {
        let never = [LifePosition::NEVER; ESTIMATES];
        let mut counts = LifeCounts::new(2, 3);
        // The third sample fails by both limit states in one interval, by the second one first; the fourth by both at once.
        for lives in [[life(0, 0.5), never], [life(2, 0.1), never], [life(2, 0.5), life(2, 0.4)]] {
            counts.add(&lives);
        }
        counts.add(&[life(1, 1.0), life(1, 1.0)]);
        let expected = [[0.25, 0.25, 0.5], [0.0, 0.0, 0.25], [0.0, 0.25, 0.25]];
        assert_eq!(counts.first_failure_shares(), expected);
        let parts = counts.parts;
        for estimate in [LifeEstimate::Best, LifeEstimate::Smaller] {
            let system = counts.failed(2, estimate);
            let at_checkpoints = [1, 2, 3].map(|k| system[k * parts - 1]);
            assert_eq!(at_checkpoints, [0.25, 0.5, 1.0]);
        }
        let whole = counts.clone().merged(&counts);
        assert_eq!(whole.failed(0, LifeEstimate::Best), counts.failed(0, LifeEstimate::Best));
        assert_eq!(whole.samples, 8);
    }

    #[test]
    fn issue_failures_at_the_start_of_life_came_after_it() {
        let mut counts = LifeCounts::new(1, 2);
        for lives in [life(0, 0.0), life(0, 0.3), life(1, 0.0), [LifePosition::NEVER; ESTIMATES]] {
            counts.add(&[lives]);
        }
        let whole = counts.clone().merged(&counts);
        assert_eq!(whole.failed_at_start(1, LifeEstimate::Best), 0.25);
        assert_eq!(whole.failed(1, LifeEstimate::Best)[0], 0.25);
    }

    #[test]
    fn errors_move_lives_to_their_sides() {
        let (times, values) = ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]);
        let track = Track { times: &times, values: &values, start: Some(0.0) };
        let lives = mode_lives(&track, (&[0.5; 3], &[0.25; 3]), 2.5, 2, &mut Vec::new());
        let time = |estimate: LifeEstimate| {
            let life = lives[estimate as usize];
            f64::from(life.interval) + life.share
        };
        let expected = [
            (LifeEstimate::Best, 2.5),
            (LifeEstimate::Unsafe, 2.0),
            (LifeEstimate::Safe, 3.0),
            (LifeEstimate::Larger, 2.25),
            (LifeEstimate::Smaller, 2.75),
        ];
        for (estimate, life) in expected {
            assert!((time(estimate) - life).abs() < 1e-8, "{estimate:?} {lives:?}");
        }
        let beyond = mode_lives(&track, (&[0.5; 3], &[0.25; 3]), 3.2, 3, &mut Vec::new());
        assert_eq!(beyond[LifeEstimate::Best as usize], LifePosition::NEVER);
        assert_ne!(beyond[LifeEstimate::Unsafe as usize], LifePosition::NEVER);
    }

    #[test]
    fn a_line_follows_the_errors_and_stays_among_them() {
        let line = ErrorLine::fit(&[(0.0, 0.1), (1.0, 0.3), (2.0, 0.5), (3.0, 0.7)]);
        assert!((line.evaluate(1.5) - 0.4).abs() < 1e-15 && (line.evaluate(2.5) - 0.6).abs() < 1e-15);
        assert_eq!((line.evaluate(-9.0), line.evaluate(9.0)), (0.1, 0.7));
        let alike = ErrorLine::fit(&[(5.0, 0.2), (5.0, 0.4)]);
        assert!((alike.evaluate(7.0) - 0.3).abs() < 1e-15);
    }
}
