//! The empirical distribution: measured values as they are, with straight lines between them.
//!
//! | | |
//! |---|---|
//! | parameters | n values, of which value k of the m different ones, v_1 < ... < v_m, m >= 2, has the ranks a_k to b_k, counted from 0 to n - 1 |
//! | support | [v_1, v_m]: no value beyond those measured |
//! | quantile | v_k for (n - 1) p from a_k to b_k, linear in p between b_k and a_(k+1) = b_k + 1 |
//! | distribution function | linear between the values; at a value that occurs c times it jumps by (c - 1) / (n - 1), and the middle of the jump is stated |
//! | density | 1 / ((n - 1) (v_(k+1) - v_k)) between neighbours; the jumps have none |
//! | moments | those of the distribution, jumps included; without equal values the variance is smaller than that of the values by a share of the order 1 / n |
//!
//! The quantiles are those of definition 7 of Hyndman and Fan, the default of R and NumPy, also where values are equal. Failures with
//! probabilities below about 1 / n depend on values that were not measured: then a fitted family is needed. The scores hold the support
//! fixed: see `law::tilted`, whose functions of x are weighted with the jumps as with the density.
//!
//! # Source
//! Hyndman, Fan (1996), Sample quantiles in statistical packages, The American Statistician 50, 361-365.

use super::law::{FitError, Law, LawError, moments, tilted};
use crate::random::standard::Tail;
use serde::{Deserialize, Serialize};

/// Fewest values of an empirical distribution.
const FEWEST: usize = 3;

/// Empirical distribution of measured values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Empirical {
    /// The different values, increasing `(m,)` [unit of the variable].
    values: Vec<f64>,
    /// Ranks of the first and the last of the equal values, from 0 on `(m,)`.
    ranks: Vec<[f64; 2]>,
    mean: f64,
    std: f64,
    /// E[t^3] and E[t^4] of the standardised variable.
    higher: [f64; 2],
}

impl Empirical {
    pub(super) fn new(samples: &[f64]) -> Result<Self, FitError> {
        if samples.len() < FEWEST {
            return Err(FitError::TooFew { found: samples.len(), least: FEWEST });
        }
        let mut sorted = samples.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (mut values, mut ranks) = (Vec::new(), Vec::new());
        let mut before = 0;
        for equal in sorted.chunk_by(|a, b| a == b) {
            values.push(equal[0]);
            ranks.push([before, before + equal.len() - 1].map(|rank| rank as f64));
            before += equal.len();
        }
        if values.len() < 2 {
            return Err(FitError::AllEqual);
        }
        let mut made = Self { values, ranks, mean: 0.0, std: 1.0, higher: [0.0; 2] };
        made.mean = made.pieces().map(|(p, [a, b])| p * 0.5 * (a + b)).sum();
        // Moments of a constant density between two standardised values, or of a jump at one, without differences of their powers.
        let moment = |law: &Self, k: i32| -> f64 {
            let powers = |[a, b]: [f64; 2]| (0..=k).map(|i| a.powi(i) * b.powi(k - i)).sum::<f64>();
            law.pieces().map(|(p, ends)| p * powers(ends.map(|x| law.t(x))) / f64::from(k + 1)).sum()
        };
        made.std = moment(&made, 2).sqrt();
        made.higher = [moment(&made, 3), moment(&made, 4)];
        Ok(made)
    }

    /// The same distribution, moved and stretched to a mean and a standard deviation > 0 [unit of the variable].
    ///
    /// # Errors
    /// [`LawError`] if there is no such distribution.
    pub fn moved(&self, mean: f64, std: f64) -> Result<Self, LawError> {
        let (mean, std) = moments(mean, std)?;
        let values = self.values.iter().map(|x| mean + std * self.t(*x)).collect();
        Ok(Self { values, ranks: self.ranks.clone(), mean, std, higher: self.higher })
    }

    /// The rank of the largest value.
    fn last_rank(&self) -> f64 {
        self.ranks[self.ranks.len() - 1][1]
    }

    /// Probability and ends of every jump, whose ends are equal, and of every interval, in increasing order.
    fn pieces(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        let whole = self.last_rank();
        let of_value = move |k: usize| {
            let (x, [first, last]) = (self.values[k], self.ranks[k]);
            let next = self.values.get(k + 1).map(|next| (1.0 / whole, [x, *next]));
            [Some(((last - first) / whole, [x, x])), next]
        };
        (0..self.values.len()).flat_map(of_value).flatten()
    }

    /// The standardised value [1].
    fn t(&self, x: f64) -> f64 {
        (x - self.mean) / self.std
    }

    /// The interval that has x, the last one for the largest value.
    fn interval(&self, x: f64) -> usize {
        let above = self.values.partition_point(|value| *value <= x);
        above.clamp(1, self.values.len() - 1) - 1
    }

    /// The rank at x, from the first value on; the mean rank of equal values.
    fn rank(&self, x: f64) -> f64 {
        let k = self.interval(x);
        let (a, b) = (self.values[k], self.values[k + 1]);
        let middle = |[first, last]: [f64; 2]| 0.5 * (first + last);
        if x < a || x > b {
            if x < a { 0.0 } else { self.last_rank() }
        } else if x == a || x == b {
            middle(self.ranks[if x == a { k } else { k + 1 }])
        } else {
            self.ranks[k][1] + (x - a) / (b - a)
        }
    }

    /// The rank from x to the largest value, with the digits that a difference has lost.
    fn rank_above(&self, x: f64) -> f64 {
        let (k, whole) = (self.interval(x), self.last_rank());
        let (a, b) = (self.values[k], self.values[k + 1]);
        if x <= a || x >= b { whole - self.rank(x) } else { whole - self.ranks[k + 1][0] + (b - x) / (b - a) }
    }
}

impl Law for Empirical {
    fn pdf(&self, x: f64) -> f64 {
        let (lower, upper) = self.support();
        if x < lower || x > upper {
            return 0.0;
        }
        let k = self.interval(x);
        1.0 / self.last_rank() / (self.values[k + 1] - self.values[k])
    }

    fn probability(&self, x: f64, tail: Tail) -> f64 {
        let rank = if tail == Tail::Lower { self.rank(x) } else { self.rank_above(x) };
        rank / self.last_rank()
    }

    fn at(&self, p: f64, tail: Tail) -> f64 {
        let whole = self.last_rank();
        let rank = p * whole;
        if tail == Tail::Upper {
            let k = self.ranks.partition_point(|[_, last]| whole - last > rank).min(self.values.len() - 1);
            let (b, past) = (self.values[k], rank - (whole - self.ranks[k][0]));
            return match k.checked_sub(1).map(|below| self.values[below]) {
                Some(a) if past > 0.0 => (b - (b - a) * past).clamp(a, b),
                _ => b,
            };
        }
        let k = self.ranks.partition_point(|[first, _]| *first <= rank).max(1) - 1;
        let (a, past) = (self.values[k], rank - self.ranks[k][1]);
        match self.values.get(k + 1) {
            Some(b) if past > 0.0 => (a + (b - a) * past).clamp(a, *b),
            _ => a,
        }
    }

    fn mean_and_std(&self) -> (f64, f64) {
        (self.mean, self.std)
    }

    fn support(&self) -> (f64, f64) {
        (self.values[0], self.values[self.values.len() - 1])
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let t = self.t(x);
        tilted(t, t * t - 1.0, self.std, self.higher[0], self.higher[1])
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let (mut linear, mut quadratic) = (0.0, 0.0);
        for (p, [a, b]) in self.pieces().take_while(|(_, [a, _])| *a <= x) {
            let end = b.min(x);
            let share = match b > a {
                true => p * (end - a) / (b - a),
                // F is the middle of a jump.
                false if a == x => 0.5 * p,
                false => p,
            };
            let (from, to) = (self.t(a), self.t(end));
            linear += share * 0.5 * (from + to);
            quadratic += share * ((from * from + from * to + to * to) / 3.0 - 1.0);
        }
        tilted(linear, quadratic, self.std, self.higher[0], self.higher[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_definition_seven() {
        // numpy.quantile([15, 20, 35, 40, 50], [0.05, 0.3, 0.4, 0.5, 1.0])
        let law = Empirical::new(&[40.0, 15.0, 50.0, 20.0, 35.0]).unwrap();
        for (p, x) in [(0.0, 15.0), (0.05, 16.0), (0.3, 23.0), (0.4, 29.0), (0.5, 35.0), (1.0, 50.0)] {
            assert!((law.quantile(p) - x).abs() < 1e-12, "{p}: {}", law.quantile(p));
        }
    }

    #[test]
    fn issue_equal_values_at_the_ends_had_lost_their_share() {
        // R(4) = numpy.quantile's share above 4 of these: 0.924.
        let samples = [[1.0; 6].as_slice(), &[1.5; 2], &[2.0; 6], &[5.0; 2]].concat();
        let law = Empirical::new(&samples).unwrap();
        // numpy.quantile(samples, p)
        for (p, x) in [
            (0.0, 1.0),
            (1.0 / 3.0, 1.0),
            (0.35, 1.125),
            (0.4, 1.5),
            (0.45, 1.5),
            (0.5, 1.75),
            (0.6, 2.0),
            (0.9, 3.5),
            (0.94, 5.0),
            (1.0, 5.0),
        ] {
            assert!((law.quantile(p) - x).abs() < 1e-9, "{p}: {}", law.quantile(p));
            assert!((law.upper_quantile(1.0 - p) - x).abs() < 1e-9, "{p}: {}", law.upper_quantile(1.0 - p));
        }
        // The middle of each jump, and the values between.
        for (x, f) in [
            (1.0, 2.5),
            (1.25, 5.5),
            (1.5, 6.5),
            (2.0, 10.5),
            (4.0, 13.0 + 2.0 / 3.0),
            (5.0, 14.5),
            (0.9, 0.0),
            (5.1, 15.0),
        ] {
            assert!((law.cdf(x) - f / 15.0).abs() < 1e-12, "{x}: {}", law.cdf(x));
            assert!((law.cdf(x) + law.survival(x) - 1.0).abs() < 1e-12, "{x}");
        }
        // Mean, standard deviation and scores over equally likely quantiles.
        let count = 300_000;
        let over = |of: &dyn Fn(f64) -> f64| {
            (0..count).map(|i| of(law.quantile((f64::from(i) + 0.5) / f64::from(count)))).sum::<f64>()
                / f64::from(count)
        };
        let (mean, std) = (law.mean(), law.std());
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        near(over(&|x| x), mean);
        near(over(&|x| (x - mean).powi(2)), std * std);
        for (k, of_mean, of_square) in [(0, 1.0, 0.0), (1, 0.0, 2.0 * std)] {
            near(over(&|x| law.scores(x)[k]), 0.0);
            near(over(&|x| law.scores(x)[k] * x), of_mean);
            near(over(&|x| law.scores(x)[k] * (x - mean).powi(2)), of_square);
            near(over(&|x| if x < 1.7 { law.scores(x)[k] } else { 0.0 }), law.cdf_derivatives(1.7)[k]);
            let at_jump =
                |x: f64| law.scores(x)[k] * if x < 2.0 { 1.0 } else { f64::from(u8::from(x == 2.0)) * 0.5 };
            near(over(&at_jump), law.cdf_derivatives(2.0)[k]);
        }
    }

    #[test]
    fn equal_values_share_their_rank() {
        let law = Empirical::new(&[1.0, 2.0, 2.0, 2.0, 3.0]).unwrap();
        assert_eq!((law.cdf(2.0), law.mean(), law.support()), (0.5, 2.0, (1.0, 3.0)));
        assert_eq!(law.pdf(1.5), law.pdf(2.5));
        assert_eq!(Empirical::new(&[2.0; 4]).unwrap_err(), FitError::AllEqual);
        assert_eq!(Empirical::new(&[2.0; 2]).unwrap_err(), FitError::TooFew { found: 2, least: 3 });
    }

    #[test]
    fn many_values_have_their_own_moments() {
        let samples: Vec<f64> = (0..2000).map(|k| f64::from(k * 7919 % 2000).powi(2)).collect();
        let mean = samples.iter().sum::<f64>() / 2000.0;
        let std = (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 2000.0).sqrt();
        let law = Empirical::new(&samples).unwrap();
        assert!(
            (law.mean() / mean - 1.0).abs() < 1e-3 && (law.std() / std - 1.0).abs() < 1e-3,
            "{}",
            law.std()
        );
    }
}
