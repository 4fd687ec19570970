//! Reliability between the checkpoints with its 95 % interval, and the lives that it reaches a level at.
//!
//! With the failed share p(t) of N samples conditional on an event E (or on none) by the best estimates of their lives, p_-(t)
//! and p_+(t) by the latest and the earliest lives that the checkpoints allow:
//!
//!   R(t) = 1 - P(E) p(t),   lower, upper limit = 1 - P(E) (p_+ + w(p_+)),  1 - P(E) (p_- - w(p_-)),
//!
//!   w(p) = 1.96 sqrt(p' (1 - p') / N (1 + gamma) + e^2 + (p cov(P(E)))^2),   p' as in [`reliability_curve`](super::reliability_curve).
//!
//! Without failures, or without survivors, w is at least 3 / N (1 + gamma). The surrogate error e(t) [1] of the share is, at a
//! checkpoint, that of the curve. Between two it follows h(t), half the difference of the shares with all responses larger
//! and smaller by their predicted standard deviation, times e / h of the checkpoints, interpolated; times 1 where no
//! checkpoint nearby has failures enough for that ratio: then all errors count as equal, the worst case. On either side w is the root
//! of the sum of squares of this and of the distance of p(t) from the share with all responses shifted by their numerical errors.
//!
//! A life is where R or its limits fall to a level. If the interpolation alone leaves a
//! factor of two between earliest and latest life, no life is stated but the limits.
//!
//! # Source
//! 3 / N: Hanley, Lippman-Hand (1983), If nothing goes wrong, is everything all right?, JAMA 249(13). The rest as in
//! `curve.rs`.

use super::curve::{CurvePoint, REACH, reliability_curve};
use super::{Condition, LifeCounts, LifeEstimate};

/// Failures, or survivors, excluded with 95 % if none is seen.
const RULE_OF_THREE: f64 = 3.0;
/// Fewest points of the population by which two shifted shares must differ to measure a ratio of errors.
const ENOUGH: f64 = 5.0;
/// Range of the ratio of errors [1].
const RATIOS: (f64, f64) = (0.2, 5.0);
/// Largest ratio of latest and earliest life that still makes a life [1].
const AMBIGUOUS: f64 = 2.0;
/// Change of a share, absolute and relative to the smaller of it and its complement, at which a point of the curve is kept.
const KEPT: (f64, f64) = (0.01, 0.15);

/// Half-width of the 95 % interval of a failure share [1] of `points` samples, whose point on the curve of R is `point`.
pub fn half_width(share: f64, point: &CurvePoint, points: usize, condition: &Condition) -> f64 {
    let count = points as f64;
    let unseen = RULE_OF_THREE / count * (1.0 + condition.gamma);
    let none = share * count < 0.5 || (1.0 - share) * count < 0.5;
    let width = REACH * point.standard_error / condition.probability.max(f64::MIN_POSITIVE);
    if none { width.max(unseen) } else { width }
}

/// Data of one curve.
#[derive(Debug)]
pub struct LifeCurveInput<'a> {
    /// Lives of the samples.
    pub counts: &'a LifeCounts,
    /// Limit state, or the system after the last one.
    pub curve: usize,
    /// Checkpoints `(m,)` [cycles].
    pub checkpoints: &'a [u32],
    /// Number of samples.
    pub points: usize,
    /// Share of all samples that have no result and are not counted [1].
    pub missing: f64,
    /// Surrogate errors of the share at some checkpoints, see [`reliability_curve`](super::reliability_curve).
    pub surrogate: &'a [(usize, f64)],
    /// The event that the samples are conditional on.
    pub condition: &'a Condition,
}

/// Reliability over life at points so close that straight lines between them are the curve.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LifeCurve {
    /// Times, increasing from 0 `(g,)` [cycles].
    pub cycles: Vec<f64>,
    /// R by the best estimates `(g,)` [1].
    pub reliability: Vec<f64>,
    /// Lower limit of the 95 % interval: sampling, surrogate, interpolation and numerical error `(g,)` [1].
    pub lower: Vec<f64>,
    /// Upper limit `(g,)` [1].
    pub upper: Vec<f64>,
    /// R by the earliest lives that the checkpoints allow `(g,)` [1].
    earliest: Vec<f64>,
    /// R by the latest lives `(g,)` [1].
    latest: Vec<f64>,
}

/// Life at which a reliability falls to a level, with 95 % limits [cycles].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LifeAtLevel {
    /// Best estimate; `None` if it lies beyond the life studied, or if the checkpoints do not resolve it.
    pub life: Option<f64>,
    /// Lower limit of its interval.
    pub lower: f64,
    /// Upper limit; `None` beyond the life studied.
    pub upper: Option<f64>,
}

impl LifeCurve {
    /// The curve of a limit state or of the system.
    pub fn new(input: &LifeCurveInput<'_>) -> Self {
        let failed = |estimate| {
            let at_start = input.counts.failed_at_start(input.curve, estimate);
            std::iter::once(at_start).chain(input.counts.failed(input.curve, estimate)).collect::<Vec<f64>>()
        };
        let errors = surrogate_errors(input);
        let Condition { probability, .. } = *input.condition;
        let reliability = |shares: Vec<f64>| -> Vec<f64> {
            shares.into_iter().map(|share| 1.0 - probability * share.clamp(0.0, 1.0)).collect()
        };
        // Failures do not heal: a limit of the share never falls.
        let best = failed(LifeEstimate::Best);
        let limit = |estimate: LifeEstimate, shifted: LifeEstimate, sign: f64| {
            let mut largest = 0.0_f64;
            let (shares, moved) = (failed(estimate), failed(shifted));
            let shares = shares.into_iter().enumerate().map(|(i, share)| {
                let numerical = (sign * (moved[i] - best[i])).max(0.0);
                largest = largest.max(share + sign * width_with(share, errors[i], input).hypot(numerical));
                largest
            });
            reliability(shares.collect())
        };
        let curve = Self {
            cycles: times(input),
            lower: limit(LifeEstimate::Earliest, LifeEstimate::Unsafe, 1.0),
            upper: limit(LifeEstimate::Latest, LifeEstimate::Safe, -1.0),
            reliability: reliability(best.clone()),
            earliest: reliability(failed(LifeEstimate::Earliest)),
            latest: reliability(failed(LifeEstimate::Latest)),
        };
        curve.thinned(probability, input.counts.parts)
    }

    /// Life at this level of reliability [1].
    pub fn life_at(&self, level: f64) -> LifeAtLevel {
        let last = self.cycles.last().copied().unwrap_or(0.0);
        let reach = |curve: &[f64]| self.reached(curve, level);
        let (lower, upper) = (reach(&self.lower), reach(&self.upper));
        let lower = lower.unwrap_or(last);
        let Some(life) = reach(&self.reliability) else {
            return LifeAtLevel { life: None, lower, upper: None };
        };
        let (earliest, latest) = (reach(&self.earliest).unwrap_or(last), reach(&self.latest).unwrap_or(last));
        if earliest > self.cycles[1] && latest <= AMBIGUOUS * earliest {
            return LifeAtLevel { life: Some(life), lower, upper };
        }
        let lower = if lower <= self.cycles[1] { 0.0 } else { lower };
        LifeAtLevel { life: None, lower, upper: upper.map(|upper| self.next_point(upper)) }
    }

    /// The curve with failure probabilities up to `possible` [1], a function of the time [cycles], within its intervals.
    #[must_use]
    pub fn with_possible(mut self, possible: impl Fn(f64) -> f64) -> Self {
        self.lower.iter_mut().zip(&self.cycles).for_each(|(r, time)| *r = r.min(1.0 - possible(*time)));
        self
    }

    /// Lower limit of R at a time [cycles] of the life [1].
    pub fn lower_at(&self, time: f64) -> f64 {
        let after = self.cycles.partition_point(|at| *at < time).min(self.cycles.len() - 1);
        let before = after.saturating_sub(1);
        let width = self.cycles[after] - self.cycles[before];
        let along = if width > 0.0 { (time - self.cycles[before]) / width } else { 0.0 };
        self.lower[before] + along * (self.lower[after] - self.lower[before])
    }

    /// Time at which a curve of this object falls to a level; `None` if it does not.
    fn reached(&self, curve: &[f64], level: f64) -> Option<f64> {
        let at = curve.iter().position(|r| *r <= level)?;
        if at == 0 {
            return Some(0.0);
        }
        let (before, after) = (curve[at - 1], curve[at]);
        let along = (before - level) / (before - after);
        Some(self.cycles[at - 1] + along * (self.cycles[at] - self.cycles[at - 1]))
    }

    /// First point of the curve that is not before `time` [cycles].
    fn next_point(&self, time: f64) -> f64 {
        self.cycles.iter().copied().find(|point| *point >= time).unwrap_or(time)
    }

    /// The curve without points between the checkpoints, which are `parts` points apart, that straight lines replace. `probability` [1] is
    /// that of the condition.
    fn thinned(mut self, probability: f64, parts: usize) -> Self {
        let curves = [&self.reliability, &self.lower, &self.upper, &self.earliest, &self.latest];
        let differs = |from: usize, to: usize| {
            curves.iter().any(|curve| {
                let (before, after) = ((1.0 - curve[from]) / probability, (1.0 - curve[to]) / probability);
                let smaller = before.min(1.0 - after).max(KEPT.0 / 10.0);
                (after - before).abs() > KEPT.0.min(KEPT.1 * smaller)
            })
        };
        let end = self.cycles.len() - 1;
        let mut kept = vec![0];
        // The first part is kept, so that a life within it is known as such.
        if end > 1 {
            kept.push(1);
        }
        for place in 2..end {
            let last = kept[kept.len() - 1];
            if (place % parts == 0 || differs(last, place + 1)) && last < place {
                kept.push(place);
            }
        }
        kept.push(end);
        kept.dedup();
        let stated = [&mut self.cycles, &mut self.reliability, &mut self.lower, &mut self.upper];
        for values in stated.into_iter().chain([&mut self.earliest, &mut self.latest]) {
            *values = kept.iter().map(|place| values[*place]).collect();
        }
        self
    }
}

/// Half-width of the 95 % interval of a share with this surrogate error [1].
fn width_with(share: f64, error: f64, input: &LifeCurveInput<'_>) -> f64 {
    // The second share marks a curve that comes to failures, whose early shares have an error by counting.
    let point = reliability_curve(&[share, 1.0], input.points, &[(0, error)], input.condition)[0];
    half_width(share, &point.with_missing(input.missing), input.points, input.condition)
}

/// Ends of all parts, and 0 before them [cycles].
fn times(input: &LifeCurveInput<'_>) -> Vec<f64> {
    let parts = input.counts.parts;
    let mut times = vec![0.0];
    let mut before = 0.0;
    for checkpoint in input.checkpoints {
        let width = f64::from(*checkpoint) - before;
        times.extend((1..=parts).map(|part| before + width * part as f64 / parts as f64));
        before = f64::from(*checkpoint);
    }
    times
}

/// Surrogate error e of the share at all times [1].
fn surrogate_errors(input: &LifeCurveInput<'_>) -> Vec<f64> {
    let (m, parts) = (input.checkpoints.len(), input.counts.parts);
    let larger = input.counts.failed(input.curve, LifeEstimate::Larger);
    let smaller = input.counts.failed(input.curve, LifeEstimate::Smaller);
    let spread: Vec<f64> = larger.iter().zip(&smaller).map(|(a, b)| 0.5 * (a - b)).collect();
    let known: Vec<f64> = (0..m).map(|k| super::curve::surrogate_error_at(k, input.surrogate)).collect();
    let ratio = |k: usize| {
        let (error, spread) = (known[k], spread[(k + 1) * parts - 1]);
        let measured = error > 0.0 && spread * input.points as f64 >= ENOUGH;
        measured.then(|| (error / spread).clamp(RATIOS.0, RATIOS.1))
    };
    // At the start of life that of the first part, if any sample exceeds a limit there.
    let at_start = [LifeEstimate::Larger, LifeEstimate::Smaller]
        .map(|estimate| input.counts.failed_at_start(input.curve, estimate));
    let of_start = 0.5 * (at_start[0] - at_start[1]);
    let mut errors = vec![ratio(0).unwrap_or(1.0) * of_start];
    for k in 0..m {
        let before = if k == 0 { (None, 0.0) } else { (ratio(k - 1), known[k - 1]) };
        let after = (ratio(k), known[k]);
        for part in 1..parts {
            let along = part as f64 / parts as f64;
            let between = |a: f64, b: f64| a + along * (b - a);
            let ratio = match (before.0, after.0) {
                (Some(a), Some(b)) => between(a, b),
                (one, other) => one.or(other).unwrap_or(1.0),
            };
            errors.push((ratio * spread[k * parts + part - 1]).max(between(before.1, after.1)));
        }
        errors.push(known[k]);
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::super::{Track, mode_lives};
    use super::*;
    use statrs::distribution::{ContinuousCDF, Normal};

    const POINTS: usize = 20_000;

    /// Responses that grow in proportion to a power of time, with normal lives of mean 1000 and standard deviation 100, at the
    /// quantiles of `POINTS` samples.
    fn counts(checkpoints: &[u32], power: f64, start: Option<f64>) -> LifeCounts {
        let lives = Normal::new(1000.0, 100.0).unwrap();
        let times: Vec<f64> = checkpoints.iter().map(|n| f64::from(*n)).collect();
        let mut counts = LifeCounts::new(1, times.len());
        let mut room = Vec::new();
        for j in 0..POINTS {
            let life = lives.inverse_cdf((j as f64 + 0.5) / POINTS as f64);
            let values: Vec<f64> = times.iter().map(|t| (t / life).powf(power)).collect();
            let track = Track { times: &times, values: &values, start };
            let first = values.iter().position(|y| *y >= 1.0).unwrap_or(times.len());
            let errors = vec![0.02; times.len()];
            counts.add(&[mode_lives(&track, (&errors, &[]), 1.0, first, &mut room)]);
        }
        counts
    }

    fn curve(counts: &LifeCounts, checkpoints: &[u32]) -> LifeCurve {
        LifeCurve::new(&LifeCurveInput {
            counts,
            curve: 1,
            checkpoints,
            points: POINTS,
            missing: 0.0,
            surrogate: &[],
            condition: &Condition::NONE,
        })
    }

    #[test]
    fn lives_within_one_interval_are_those_of_the_distribution() {
        let lives = Normal::new(1000.0, 100.0).unwrap();
        // The whole fall lies between the first and the second checkpoint.
        let checkpoints = [600, 1500, 2400];
        for power in [0.5, 1.0, 2.0] {
            let curve = curve(&counts(&checkpoints, power, Some(0.0)), &checkpoints);
            assert!(curve.cycles.len() < 400, "{}", curve.cycles.len());
            for level in [0.99, 0.9, 0.5] {
                let exact = lives.inverse_cdf(1.0 - level);
                let found = curve.life_at(level);
                let (life, upper) = (found.life.unwrap(), found.upper.unwrap());
                assert!((life / exact - 1.0).abs() < 2e-3, "{power} {level}: {found:?} {exact}");
                assert!(found.lower < exact && exact < upper, "{power} {level}: {found:?}");
                // The numerical error of 0.02 moves a life by 2 % over the power.
                let moved = 0.015 * exact / power;
                assert!(found.lower < exact - moved && exact + moved < upper, "{power} {level}: {found:?}");
            }
        }
    }

    #[test]
    fn issue_a_density_was_spread_over_checkpoints_without_failures() {
        // One sample in a hundred fails at once, then none until after 300 cycles, where R begins to fall.
        let checkpoints = [100, 200, 300, 400, 500];
        let times: Vec<f64> = checkpoints.iter().map(|n| f64::from(*n)).collect();
        let mut counts = LifeCounts::new(1, times.len());
        for j in 0..10_000 {
            let from = if j % 100 == 0 { 1.5 } else { 0.5 };
            let last = if j % 1000 == 1 { 1.2 } else { from };
            let values = [from, from, from, last, last];
            let track = Track { times: &times, values: &values, start: Some(from) };
            let first = values.iter().position(|y| *y >= 1.0).unwrap_or(times.len());
            counts.add(&[mode_lives(&track, (&[0.0; 5], &[]), 1.0, first, &mut Vec::new())]);
        }
        let curve = curve(&counts, &checkpoints);
        let at = |time: f64| {
            let place = curve.cycles.iter().position(|t| *t == time).expect("a point at every checkpoint");
            curve.reliability[place]
        };
        let found = [100.0, 200.0, 300.0, 400.0].map(at);
        assert!((found[0] - 0.99).abs() < 1e-12 && found[0] == found[1] && found[1] == found[2], "{found:?}");
        assert!((found[3] - 0.989).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn a_fall_before_the_first_checkpoint_is_bounded_by_it() {
        let checkpoints = [1500, 3000];
        let unknown = curve(&counts(&checkpoints, 1.0, None), &checkpoints);
        let found = unknown.life_at(0.5);
        assert_eq!(found, LifeAtLevel { life: None, lower: 0.0, upper: Some(1500.0) });
        // No checkpoint lies beyond 900 cycles, which nine tenths of the samples outlive.
        let checkpoints = [300, 600, 900];
        let found = curve(&counts(&checkpoints, 1.0, Some(0.0)), &checkpoints).life_at(0.5);
        assert_eq!((found.life, found.lower, found.upper), (None, 900.0, None));
        // With the start the linear growth is known.
        let checkpoints = [1500, 3000];
        let known = curve(&counts(&checkpoints, 1.0, Some(0.0)), &checkpoints).life_at(0.5);
        assert!((known.life.unwrap() - 1000.0).abs() < 2.0, "{known:?}");
    }

    #[test]
    fn no_failure_is_a_bound_and_a_few_are_an_interval() {
        let condition = Condition::NONE;
        let width = |share: f64, error: f64| {
            let point = reliability_curve(&[share], 2000, &[(0, error)], &condition)[0];
            half_width(share, &point, 2000, &condition)
        };
        assert!((width(0.0, 0.0) - 0.0015).abs() < 1e-12 && (width(1.0, 0.0) - 0.0015).abs() < 1e-12);
        assert!((width(0.1, 0.0) - 1.96 * (0.1 * 0.9 / 2000.0_f64).sqrt()).abs() < 1e-4);
        assert!(width(0.1, 0.02) > 1.96 * 0.02);
    }
}
