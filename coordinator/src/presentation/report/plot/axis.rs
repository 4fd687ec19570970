//! An axis of a chart, its scale, and the text of its ticks.

use crate::presentation::report::format::{plain, shortest};
use common::random::{standard_normal_cdf, standard_normal_quantile};
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::coord::types::RangedCoordf64;
use std::ops::Range;

/// The function of a value that an axis draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The value itself.
    Linear,
    /// Its logarithm to the base 10.
    Logarithm,
    /// ln(-ln(1 - F)) of a share F that is stated in per cent.
    Weibull,
    /// The standard normal quantile of a share F that is stated in per cent.
    Normal,
}

impl Scale {
    /// The value that a drawn number belongs to.
    pub fn value(self, drawn: f64) -> f64 {
        match self {
            Self::Linear => drawn,
            Self::Logarithm => 10f64.powf(drawn),
            Self::Weibull => -100.0 * (-drawn.exp()).exp_m1(),
            Self::Normal => 100.0 * standard_normal_cdf(drawn),
        }
    }

    /// The number drawn for a share F [1] on an axis of shares.
    pub fn of_share(self, failed: f64) -> f64 {
        match self {
            Self::Linear => 100.0 * failed,
            Self::Logarithm => (100.0 * failed).log10(),
            Self::Weibull => (-(-failed).ln_1p()).ln(),
            Self::Normal => standard_normal_quantile(failed),
        }
    }

    /// Its name for the script that shows values.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Logarithm => "log",
            Self::Weibull => "weibull",
            Self::Normal => "normal",
        }
    }
}

/// Axis of a chart with its quantity and range.
#[derive(Clone, Copy)]
pub struct Axis<'a> {
    /// Quantity with its unit.
    pub label: &'a str,
    /// First and last number drawn.
    pub range: (f64, f64),
    /// Text of a tick.
    pub text: fn(f64) -> String,
    /// What is drawn of a value.
    pub scale: Scale,
}

impl<'a> Axis<'a> {
    /// An axis of the numbers themselves.
    pub fn linear(label: &'a str, range: (f64, f64)) -> Self {
        Self { label, range, text: tick_label, scale: Scale::Linear }
    }
}

/// A number with at most three decimals, or three digits where it is small, and no trailing zeros.
pub fn tick_label(value: f64) -> String {
    if value != 0.0 && value.abs() < 0.1 { shortest(value, 3) } else { plain(value, 3) }
}

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
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power).into_iter();
    let off = |step: &f64| (step / rough).ln().abs();
    let step = steps.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(power);
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

    #[test]
    fn ticks_have_no_trailing_zeros() {
        assert_eq!([5e-4, -0.025, 0.0].map(tick_label), ["5e\u{2212}4", "\u{2212}0.025", "0"]);
        let found = [tick_label(0.5), tick_label(-0.0), tick_label(20.0), tick_label(-1.25)];
        assert_eq!(found, ["0.5", "0", "20", "\u{2212}1.25"]);
    }

    #[test]
    fn scales_of_shares_return_the_share_in_per_cent() {
        for scale in [Scale::Linear, Scale::Logarithm, Scale::Weibull, Scale::Normal] {
            for failed in [1e-4, 0.01, 0.5, 0.99] {
                let found = scale.value(scale.of_share(failed));
                assert!((found - 100.0 * failed).abs() < 1e-9, "{scale:?} {failed}: {found}");
            }
        }
    }

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
