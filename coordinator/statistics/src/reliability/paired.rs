//! The change between two estimates over the same population: reliabilities before and after a change of the inputs, or the
//! lives read from them.
//!
//! Both populations are made from the same uniform numbers (common random numbers), point by point, so most points fail at
//! nearly the same life before and after, and their scatter cancels in the change. From the two 95 % intervals, with the
//! sampling correlation r of the two estimates, the interval of the change a - b is
//!
//!   lower = (a - b) - sqrt((a - l_a)^2 + (u_b - b)^2 - 2 r h_a h_b),
//!   upper = (a - b) + sqrt((u_a - a)^2 + (b - l_b)^2 - 2 r h_a h_b),
//!
//! where h is the part of a distance that comes from sampling. The other errors of the two are taken as independent, or those of
//! one as a part of the other's ([`OtherErrors`]). With
//! the shares p_a and p_b of the points that have failed, and p_ab of those that have failed in both,
//!
//!   r = (p_ab - p_a p_b) / sqrt(p_a (1 - p_a) p_b (1 - p_b)).
//!
//! # Source
//! Interval of a difference from two intervals (method of variance estimates recovery): Zou, Donner (2008), Construction of
//! confidence limits about effect measures, Statistics in Medicine 27(10). Common random numbers: Glasserman (2003), Monte
//! Carlo Methods in Financial Engineering, Springer.

use serde::{Deserialize, Serialize};

/// An estimate with its 95 % interval, in any unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntervalEstimate {
    /// Best estimate of the quantity.
    pub value: f64,
    /// Lower limit of the interval.
    pub lower: f64,
    /// Upper limit; `None` where it is not known.
    pub upper: Option<f64>,
    /// Half of the width of the 95 % interval of sampling alone.
    pub sampling: f64,
}

/// A change with its 95 % interval, as it is also printed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Best estimate of the change.
    pub value: f64,
    /// Lower limit; `None` where it is not known.
    pub lower: Option<f64>,
    /// Upper limit; `None` where it is not known.
    pub upper: Option<f64>,
}

/// The errors of two estimates beside those of sampling.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OtherErrors {
    /// They have nothing in common.
    Independent,
    /// Those of the first are a part of those of the second, to whose squares its own are added: the same surrogates, shifted.
    Nested,
}

/// The change from `before` to `after`, whose samples have the correlation `r` [1].
pub fn change(before: IntervalEstimate, after: IntervalEstimate, r: f64, errors: OtherErrors) -> Change {
    let value = after.value - before.value;
    let width = |of_after: f64, of_before: f64| {
        let (h_a, h_b) = (after.sampling.min(of_after), before.sampling.min(of_before));
        let (own, known) = (of_after * of_after - h_a * h_a, of_before * of_before - h_b * h_b);
        let others = match errors {
            OtherErrors::Independent => own + known,
            OtherErrors::Nested => (own - known).abs(),
        };
        (others + h_a * h_a + h_b * h_b - 2.0 * r * h_a * h_b).max(0.0).sqrt()
    };
    let below = |of: IntervalEstimate| (of.value - of.lower).max(0.0);
    let above = |of: IntervalEstimate| of.upper.map(|upper| (upper - of.value).max(0.0));
    let (for_lower, for_upper) = match errors {
        OtherErrors::Independent => (above(before), Some(below(before))),
        OtherErrors::Nested => (Some(below(before)), above(before)),
    };
    Change {
        value,
        lower: for_lower.map(|of_before| value - width(below(after), of_before)),
        upper: above(after).zip(for_upper).map(|(after, before)| value + width(after, before)),
    }
}

/// Correlation r [1] of the failure shares of the points that have failed by checkpoint `by.0` of `before` and `by.1` of
/// `after`; both `(N,)` hold the index of the checkpoint by which each point has failed. 0 where all or none have.
pub fn sampling_correlation(before: &[u32], after: &[u32], by: (usize, usize)) -> f64 {
    let (mut first, mut second, mut both) = (0.0, 0.0, 0.0);
    for (b, a) in before.iter().zip(after) {
        let failed = (*b as usize <= by.0, *a as usize <= by.1);
        first += f64::from(u8::from(failed.0));
        second += f64::from(u8::from(failed.1));
        both += f64::from(u8::from(failed.0 && failed.1));
    }
    let n = before.len() as f64;
    let (first, second, both) = (first / n, second / n, both / n);
    let variance = first * (1.0 - first) * second * (1.0 - second);
    if variance > 0.0 && both == first && both == second {
        // Without the rounding errors of the quotient, which would leave the change of a study to itself an interval.
        return 1.0;
    }
    if variance > 0.0 { (both - first * second) / variance.sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_a_change_has_its_closed_form() {
        let of = |value: f64, half: f64, sampling: f64| IntervalEstimate {
            value,
            lower: value - half,
            upper: Some(value + half),
            sampling,
        };
        let nested = |before, after| super::change(before, after, 1.0, OtherErrors::Nested);
        let change = |before, after, r| super::change(before, after, r, OtherErrors::Independent);
        // Independent: root of the sum of squares. All of it sampling, fully correlated: nothing remains.
        let found = change(of(5.0, 3.0, 3.0), of(7.0, 4.0, 4.0), 0.0);
        assert_eq!((found.value, found.lower, found.upper), (2.0, Some(-3.0), Some(7.0)));
        let found = change(of(5.0, 3.0, 3.0), of(7.0, 3.0, 3.0), 1.0);
        assert_eq!((found.lower, found.upper), (Some(2.0), Some(2.0)));
        // The surrogate's part does not cancel: 5^2 = 3^2 + 4^2 each.
        let found = change(of(0.0, 5.0, 3.0), of(0.0, 5.0, 3.0), 1.0);
        assert!((found.upper.unwrap() - 32f64.sqrt()).abs() < 1e-12);
        // A part of the other: 13^2 = 5^2 + 12^2; the same estimate twice has no change at all.
        let found = nested(of(0.0, 5.0, 3.0), of(2.0, 13.0, 3.0));
        assert_eq!((found.lower, found.upper), (Some(-10.0), Some(14.0)));
        let found = nested(of(5.0, 5.0, 3.0), of(5.0, 5.0, 3.0));
        assert_eq!((found.lower, found.upper), (Some(0.0), Some(0.0)));
        let beyond = IntervalEstimate { upper: None, ..of(7.0, 1.0, 1.0) };
        let found = change(of(5.0, 1.0, 1.0), beyond, 0.0);
        assert_eq!((found.lower, found.upper), (Some(2.0 - 2f64.sqrt()), None));
    }

    #[test]
    fn the_correlation_is_that_of_the_indicators() {
        let before = [0, 1, 2, 3];
        assert_eq!(sampling_correlation(&before, &before, (1, 1)), 1.0);
        let many: Vec<u32> = (0..4001).map(|j| j % 7).collect();
        assert!((0..6).all(|n| sampling_correlation(&many, &many, (n, n)) == 1.0));
        assert_eq!(sampling_correlation(&before, &[3, 2, 1, 0], (1, 1)), -1.0);
        assert_eq!(sampling_correlation(&before, &[0, 3, 0, 3], (1, 1)), 0.0);
        assert_eq!(sampling_correlation(&before, &before, (4, 1)), 0.0);
    }
}
