//! Reliability at the checkpoints with its 95 % interval, as written to `summary.json`.

use crate::statistics::reliability::REACH;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One value per limit state, by name; the summary's `limit_states` has their order.
pub type PerLimitState = BTreeMap<String, f64>;

/// Reliability at one checkpoint.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ReliabilityRow {
    /// Checkpoint of life [cycles].
    pub cycles: u32,
    /// R(n) per limit state, and `total` for the series system; failures are absorbing.
    #[serde(flatten)]
    pub reliability: PerLimitState,
    /// Standard error per curve: root of the sum of squares of its parts.
    pub standard_error: PerLimitState,
    /// 95 % interval of R(n) per curve, every error that is known included: R -+ 1.96 standard errors, where no failure or no survivor was
    /// seen the rule of three, and on either side what the numerical error moves R to; empty in studies by earlier versions.
    #[serde(default)]
    pub interval: BTreeMap<String, ReliabilityRange>,
    /// Parts of the standard error per curve; empty in studies by earlier versions.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parts: BTreeMap<String, ErrorParts>,
    /// Range of R(n) with all responses shifted by their stated numerical errors, which the interval of a study by an earlier version does
    /// not contain; empty in later ones.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub numerical: BTreeMap<String, ReliabilityRange>,
}

impl ReliabilityRow {
    /// 95 % interval of the reliability `key`, every error that is known included.
    pub fn interval_of(&self, key: &str) -> Option<ReliabilityRange> {
        let r = *self.reliability.get(key)?;
        let within =
            |reach: f64| ReliabilityRange { lower: (r - reach).max(0.0), upper: (r + reach).min(1.0) };
        let by_error = || self.standard_error.get(key).map(|error| within(REACH * error));
        let own = self.interval.get(key).copied().or_else(by_error)?;
        Some(self.numerical.get(key).map_or(own, |range| own.widened(r, *range)))
    }

    /// Widens the interval of curve `key` by the range that the numerical error moves R within, and notes it as a part of the error.
    pub fn add_numerical(&mut self, key: &str, range: ReliabilityRange) {
        let Some(r) = self.reliability.get(key).copied() else { return };
        let numerical = 0.5 * (range.upper - range.lower).max(0.0) / REACH;
        self.parts.entry(key.to_owned()).or_default().numerical = numerical;
        if let Some(error) = self.standard_error.get_mut(key) {
            *error = error.hypot(numerical);
        }
        if let Some(interval) = self.interval.get_mut(key) {
            *interval = interval.widened(r, range);
        }
    }
}

/// Parts of the standard error of a reliability, independent of each other [1].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorParts {
    /// Counting over the samples.
    pub sampling: f64,
    /// Surrogates: 1.5 times their error, and noise of the simulations that nothing explains.
    pub surrogate: f64,
    /// Numerical error of the simulations.
    pub numerical: f64,
}

/// Interval of a reliability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReliabilityRange {
    /// Lower limit of R [1].
    pub lower: f64,
    /// Upper limit of R [1].
    pub upper: f64,
}

impl ReliabilityRange {
    /// This interval around `r` [1] with an independent error that moves `r` within `range`: on each side the root of the sum of squares.
    #[must_use]
    pub fn widened(self, r: f64, range: Self) -> Self {
        let below = (r - self.lower).max(0.0).hypot((r - range.lower).max(0.0));
        let above = (self.upper - r).max(0.0).hypot((range.upper - r).max(0.0));
        Self { lower: (r - below).max(0.0), upper: (r + above).min(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_contains_all_its_parts() {
        let of = |value: f64| PerLimitState::from([("total".to_owned(), value)]);
        let interval = ReliabilityRange { lower: 0.47, upper: 0.53 };
        let mut row = ReliabilityRow {
            reliability: of(0.5),
            standard_error: of(0.03 / REACH),
            interval: BTreeMap::from([("total".to_owned(), interval)]),
            ..ReliabilityRow::default()
        };
        let range = ReliabilityRange { lower: 0.46, upper: 0.5 };
        let mut old = row.clone();
        old.numerical.insert("total".to_owned(), range);
        row.add_numerical("total", range);
        let found = row.interval_of("total").unwrap();
        assert!((found.lower - 0.45).abs() < 1e-12 && (found.upper - 0.53).abs() < 1e-12);
        assert!((row.parts["total"].numerical - 0.02 / REACH).abs() < 1e-12);
        assert!((row.standard_error["total"] - 0.03_f64.hypot(0.02) / REACH).abs() < 1e-12);
        // A study by an earlier version has the same interval.
        assert_eq!(old.interval_of("total").unwrap(), found);
    }
}
