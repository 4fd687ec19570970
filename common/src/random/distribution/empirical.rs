//! The empirical distribution: measured values as they are, with straight lines between them.
//!
//! | | |
//! |---|---|
//! | parameters | n values, m of them different: v_1 < ... < v_m with mean ranks r_j (equal values share theirs), m >= 2 |
//! | support | [v_1, v_m]: no value beyond those measured |
//! | distribution function | F(v_j) = (r_j - r_1) / (r_m - r_1), linear between; without ties (j - 1) / (n - 1) |
//! | density | constant between neighbours |
//! | moments | those of this density; the variance is smaller than that of the values by a share of the order 1 / n |
//!
//! The quantiles are those of definition 7 of Hyndman and Fan, the default of R and NumPy. Failures with probabilities below about 1 / n
//! depend on values that were not measured: then a fitted family is needed. The scores hold the support fixed: see `tilted`.
//!
//! # Source
//! Hyndman, Fan (1996), Sample quantiles in statistical packages, The American Statistician 50, 361-365.

use super::fit_error::FitError;
use super::law::{Law, LawError, moments};
use super::tilted::tilted;
use serde::{Deserialize, Serialize};

/// Fewest values of an empirical distribution.
const FEWEST: usize = 3;

/// Empirical distribution of measured values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Empirical {
    /// The different values, increasing `(m,)` [unit of the variable].
    values: Vec<f64>,
    /// Mean ranks from the first one on `(m,)`, the first 0.
    ranks: Vec<f64>,
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
            ranks.push(before as f64 + 0.5 * (equal.len() as f64 - 1.0));
            before += equal.len();
        }
        if values.len() < 2 {
            return Err(FitError::AllEqual);
        }
        let first = ranks[0];
        ranks.iter_mut().for_each(|rank| *rank -= first);
        let mut made = Self { values, ranks, mean: 0.0, std: 1.0, higher: [0.0; 2] };
        made.mean = made.pieces().map(|(p, [a, b])| p * 0.5 * (a + b)).sum();
        // Moments of a constant density between two standardised values, without differences of their powers.
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
        self.ranks[self.ranks.len() - 1]
    }

    /// Probability and ends of every interval.
    fn pieces(&self) -> impl Iterator<Item = (f64, [f64; 2])> {
        let whole = self.last_rank();
        let ends = self.values.windows(2).zip(self.ranks.windows(2));
        ends.map(move |(x, rank)| ((rank[1] - rank[0]) / whole, [x[0], x[1]]))
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

    /// The rank at x, from the first value on.
    fn rank(&self, x: f64) -> f64 {
        let k = self.interval(x);
        let ([a, b], [low, high]) =
            ([self.values[k], self.values[k + 1]], [self.ranks[k], self.ranks[k + 1]]);
        low + (high - low) * ((x - a) / (b - a)).clamp(0.0, 1.0)
    }

    /// The rank from x to the largest value, with the digits that a difference has lost.
    fn rank_above(&self, x: f64) -> f64 {
        let k = self.interval(x);
        let ([a, b], [low, high]) =
            ([self.values[k], self.values[k + 1]], [self.ranks[k], self.ranks[k + 1]]);
        self.last_rank() - high + (high - low) * ((b - x) / (b - a)).clamp(0.0, 1.0)
    }
}

impl Law for Empirical {
    fn name(&self) -> &'static str {
        "empirical"
    }

    fn pdf(&self, x: f64) -> f64 {
        let (lower, upper) = self.support();
        if x < lower || x > upper {
            return 0.0;
        }
        let k = self.interval(x);
        (self.ranks[k + 1] - self.ranks[k]) / self.last_rank() / (self.values[k + 1] - self.values[k])
    }

    fn cdf(&self, x: f64) -> f64 {
        self.rank(x) / self.last_rank()
    }

    fn survival(&self, x: f64) -> f64 {
        self.rank_above(x) / self.last_rank()
    }

    fn quantile(&self, p: f64) -> f64 {
        let rank = p * self.last_rank();
        let above = self.ranks.partition_point(|known| *known <= rank).clamp(1, self.ranks.len() - 1);
        let ([a, b], [low, high]) =
            ([self.values[above - 1], self.values[above]], [self.ranks[above - 1], self.ranks[above]]);
        (a + (b - a) * ((rank - low) / (high - low))).clamp(a, b)
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        let (whole, m) = (self.last_rank(), self.ranks.len());
        let rank = q * whole;
        let last = whole - self.ranks[m - 2];
        if rank > last {
            return self.quantile(1.0 - q);
        }
        let [a, b] = [self.values[m - 2], self.values[m - 1]];
        (b - (b - a) * (rank / last)).clamp(a, b)
    }

    fn mean(&self) -> f64 {
        self.mean
    }

    fn std(&self) -> f64 {
        self.std
    }

    fn support(&self) -> (f64, f64) {
        (self.values[0], self.values[self.values.len() - 1])
    }

    fn limits(&self) -> (f64, f64) {
        self.support()
    }

    fn scores(&self, x: f64) -> [f64; 2] {
        let t = self.t(x);
        tilted(t, t * t - 1.0, self.std, self.higher[0], self.higher[1])
    }

    fn cdf_derivatives(&self, x: f64) -> [f64; 2] {
        let (mut linear, mut quadratic) = (0.0, 0.0);
        for (p, [a, b]) in self.pieces().take_while(|(_, [a, _])| *a < x) {
            let end = b.min(x);
            let (share, from, to) = (p * (end - a) / (b - a), self.t(a), self.t(end));
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
