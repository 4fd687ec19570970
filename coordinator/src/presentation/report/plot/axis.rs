//! An axis of a chart, its scale, and the text of its ticks.

use crate::presentation::report::format::plain;
use common::random::{standard_normal_cdf, standard_normal_quantile};

/// The function of a value that an axis draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// The value itself.
    Linear,
    /// Its logarithm to the base 10.
    Logarithm,
    /// The logarithm to the base 10 of a share that is stated in per cent.
    LogarithmOfShare,
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
            Self::LogarithmOfShare => 10f64.powf(drawn + 2.0),
            Self::Weibull => -100.0 * (-drawn.exp()).exp_m1(),
            Self::Normal => 100.0 * standard_normal_cdf(drawn),
        }
    }

    /// The number drawn for a share F [1] on an axis of shares.
    pub fn of_share(self, failed: f64) -> f64 {
        match self {
            Self::Linear => 100.0 * failed,
            Self::Logarithm => (100.0 * failed).log10(),
            Self::LogarithmOfShare => failed.log10(),
            Self::Weibull => (-(-failed).ln_1p()).ln(),
            Self::Normal => standard_normal_quantile(failed),
        }
    }

    /// Its name for the script that shows values.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Logarithm => "log",
            Self::LogarithmOfShare => "log-share",
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

/// A number with at most three decimals and no trailing zeros.
pub fn tick_label(value: f64) -> String {
    plain(value, 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_no_trailing_zeros() {
        let found = [tick_label(0.5), tick_label(-0.0), tick_label(20.0), tick_label(-1.25)];
        assert_eq!(found, ["0.5", "0", "20", "\u{2212}1.25"]);
    }

    #[test]
    fn scales_of_shares_return_the_share_in_per_cent() {
        let scales =
            [Scale::Linear, Scale::Logarithm, Scale::LogarithmOfShare, Scale::Weibull, Scale::Normal];
        for scale in scales {
            for failed in [1e-4, 0.01, 0.5, 0.99] {
                let found = scale.value(scale.of_share(failed));
                assert!((found - 100.0 * failed).abs() < 1e-9, "{scale:?} {failed}: {found}");
            }
        }
    }
}
