//! Axes with their ticks: round values, on whatever scale they are drawn.

use super::axis::Scale;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// Number of ticks that is aimed at.
const TICKS: f64 = 5.0;

/// Least distance of two ticks of an axis of shares, as a part of its length.
const APART: f64 = 0.08;

/// Least distance of two ticks of a logarithmic axis of equal differences, as a part of its length: five digits have room.
const APART_ON_LOGARITHM: f64 = 0.14;

/// Ratio of the ends of a logarithmic axis up to which its ticks have equal differences.
const NARROW: f64 = 5.0;

/// Ratio of the ends of a logarithmic axis up to which its ticks are 1, 2 and 5 times the powers of ten.
const MODERATE: f64 = 200.0;

/// Shares in per cent that have ticks, the most important first.
const SHARES: [f64; 19] = [
    50.0, 1.0, 10.0, 0.1, 90.0, 99.0, 0.01, 99.9, 0.001, 5.0, 95.0, 20.0, 80.0, 2.0, 0.5, 98.0, 30.0, 70.0,
    60.0,
];

/// A linear axis with ticks at given numbers.
pub(super) struct TickedAxis {
    axis: RangedCoordf64,
    ticks: Vec<f64>,
}

impl TickedAxis {
    /// The axis between two numbers drawn.
    pub fn new((low, high): (f64, f64), ticks: Vec<f64>) -> Self {
        Self { axis: (low..high).into(), ticks }
    }
}

impl Ranged for TickedAxis {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        self.axis.map(value, limit)
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { vec![] } else { self.ticks.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.axis.range()
    }
}

/// The numbers drawn at the ticks between two numbers drawn, in rising order.
pub(super) fn ticks(scale: Scale, (low, high): (f64, f64)) -> Vec<f64> {
    match scale {
        Scale::Linear => round_values(low, high, TICKS),
        Scale::Logarithm => logarithmic(low, high),
        Scale::LogarithmOfShare => {
            logarithmic(low + 2.0, high + 2.0).into_iter().map(|power| power - 2.0).collect()
        }
        Scale::Weibull | Scale::Normal => shares(scale, low, high),
    }
}

/// Multiples of 1, 2 or 5 times a power of ten, about `count` of them.
fn round_values(low: f64, high: f64, count: f64) -> Vec<f64> {
    let width = high - low;
    if !(width.is_finite() && width > 0.0) {
        return vec![];
    }
    let rough = width / count;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|factor| factor * power)
        .into_iter()
        .min_by(|a, b| (a / rough).ln().abs().total_cmp(&(b / rough).ln().abs()))
        .unwrap_or(power);
    // The ends are ticks in spite of their rounding.
    let (first, last) = ((low / step - 1e-6).ceil() as i64, (high / step + 1e-6).floor() as i64);
    (first..=last).map(|k| (k as f64 * step).clamp(low, high)).collect()
}

/// Powers of the ticks between two powers of ten.
fn logarithmic(low: f64, high: f64) -> Vec<f64> {
    let ratio = 10f64.powf(high - low);
    if ratio <= NARROW {
        // Equal differences are drawn closest at the upper end.
        let powers = |count: f64| -> Vec<f64> {
            let values = round_values(10f64.powf(low), 10f64.powf(high), count);
            values.into_iter().map(|value| value.log10().clamp(low, high)).collect()
        };
        let least = APART_ON_LOGARITHM * (high - low);
        let are_apart = |powers: &Vec<f64>| powers.windows(2).all(|pair| pair[1] - pair[0] >= least);
        let found = [TICKS, 4.0, 3.0, 2.0].map(powers).into_iter().find(are_apart);
        return found.unwrap_or_else(|| powers(1.0));
    }
    let factors: &[f64] = if ratio <= MODERATE { &[1.0, 2.0, 5.0] } else { &[1.0] };
    let every = ((high - low) / (TICKS + 2.0)).ceil().max(1.0) as i64;
    let decades = (low.floor() as i64..=high.ceil() as i64).filter(|power| power % every == 0);
    let powers = decades.flat_map(|power| factors.iter().map(move |factor| power as f64 + factor.log10()));
    powers.filter(|power| (low - 1e-9..=high + 1e-9).contains(power)).collect()
}

/// Usual shares as far as they have room.
fn shares(scale: Scale, low: f64, high: f64) -> Vec<f64> {
    let mut found: Vec<f64> = Vec::new();
    for drawn in SHARES.map(|percent| scale.of_share(percent / 100.0)) {
        let is_apart = |other: &f64| (drawn - other).abs() >= APART * (high - low);
        if (low..=high).contains(&drawn) && found.iter().all(is_apart) {
            found.push(drawn);
        }
    }
    found.sort_by(f64::total_cmp);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values at the ticks with six digits.
    fn values(scale: Scale, low: f64, high: f64) -> Vec<f64> {
        let values = ticks(scale, (low, high)).into_iter().map(|drawn| scale.value(drawn));
        values.map(|value| format!("{value:.5e}").parse().unwrap()).collect()
    }

    #[test]
    fn issue_ticks_of_logarithmic_axes_were_no_round_values() {
        let lives = |low: f64, high: f64| values(Scale::Logarithm, low.log10(), high.log10());
        assert_eq!(lives(4800.0, 7300.0), [5000.0, 5500.0, 6000.0, 6500.0, 7000.0]);
        // Not 14 000, 16 000 and 18 000, whose labels met.
        assert_eq!(lives(4000.0, 19_000.0), [5000.0, 10_000.0, 15_000.0]);
        assert_eq!(lives(1500.0, 30_000.0), [2000.0, 5000.0, 10_000.0, 20_000.0]);
        assert_eq!(lives(1.0, 1e6), [1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6]);
        assert_eq!(values(Scale::LogarithmOfShare, -5.0, 0.0), [0.001, 0.01, 0.1, 1.0, 10.0, 100.0]);
    }

    #[test]
    fn issue_ticks_of_shares_were_no_round_values() {
        let scale = Scale::Weibull;
        let found = values(scale, scale.of_share(1e-4), scale.of_share(0.9999));
        assert_eq!(found, [0.01, 0.1, 1.0, 10.0, 50.0, 90.0, 99.9]);
        let scale = Scale::Normal;
        let found = values(scale, scale.of_share(1e-4), scale.of_share(0.9999));
        assert_eq!(found, [0.01, 0.1, 1.0, 10.0, 50.0, 90.0, 99.0, 99.9]);
    }

    #[test]
    fn ticks_of_linear_axes_are_multiples_of_1_2_or_5() {
        assert_eq!(values(Scale::Linear, 0.0, 1.0), [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]);
        assert_eq!(values(Scale::Linear, -3.9, 8.1), [-2.0, 0.0, 2.0, 4.0, 6.0, 8.0]);
        assert_eq!(values(Scale::Linear, 0.0, 2750.0), [0.0, 500.0, 1000.0, 1500.0, 2000.0, 2500.0]);
        assert!(ticks(Scale::Linear, (1.0, 1.0)).is_empty());
    }
}
