//! Outputs with steps: counts, flags, and numbers printed with few digits. Their values lie on a grid, and a limit is reached
//! with a jump from the largest value below it, b, to the smallest value a at or above it. A surrogate is smooth and passes
//! through the values in between; it passes (a + b) / 2 where the jump is, but its threshold t on a plateau of height t anywhere.
//! So the threshold of the surrogate is
//!
//!   t' = (a + b) / 2,   b < t <= a,
//!
//! which classifies every simulation as t does. It is taken from the simulated values:
//!
//! - where both neighbours of the threshold occur in three simulations or more, they are a and b;
//! - otherwise, where the four values nearest to the threshold are multiples of a common step h apart, a and b are the
//!   neighbours of the threshold on that grid, a = b + h, unless the variables are on grids, too;
//! - otherwise, where at least two simulations equal the threshold, a = t and b is the next smaller value;
//! - otherwise the output has no steps, and t' = t.
//!
//! Nor has it steps where histories over several checkpoints are hardly different: their values are those of a few functions of the life,
//! e.g. of one without scatter.
//!
//! # Source
//! The rounding of x to the grid changes at the middles between its values (round to nearest), and a continuous function that
//! approximates a jump in the mean crosses the middle of both heights there. This project's own choice.

use std::collections::HashSet;

/// Simulations in which both neighbours of the threshold occur from which on they count as plateaus.
const PLATEAU: usize = 3;
/// Values nearest to the threshold that tell a common step.
const NEAREST: usize = 4;
/// Remainder over the largest difference that counts as none [1]. Numbers without a common step pass this and [`LEAST_STEP`] with a
/// probability of about 1e-9.
const REMAINDER: f64 = 1e-9;
/// Jump at the limit over the standard deviation of the values from which on steps count as coarse [1].
const COARSE: f64 = 0.1;
/// Relative difference of values that count as equal [1].
const EQUAL: f64 = 1e-12;
/// Smallest common step over the largest difference [1].
const LEAST_STEP: f64 = 1e-3;

/// The threshold that a surrogate of a response uses, and the jump of the response there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LearnedThreshold {
    /// The threshold t' [unit of the output].
    pub value: f64,
    /// The jump a - b; 0 without steps [unit of the output].
    pub jump: f64,
    /// Number of different values of the response, if the jump is more than a tenth of their standard deviation.
    pub coarse: Option<usize>,
}

/// The threshold of the surrogate of a response with this `threshold`, from its simulated histories `(n)(m,)`, which are
/// running maxima [unit of the output]. `on_grid` tells whether all variables are on grids ([`is_on_grid`]).
pub fn learned_threshold<H: Iterator<Item = f64>>(
    histories: impl Iterator<Item = H>,
    threshold: f64,
    on_grid: bool,
) -> LearnedThreshold {
    let none = LearnedThreshold { value: threshold, jump: 0.0, coarse: None };
    let histories: Vec<Vec<f64>> = histories.map(Iterator::collect).collect();
    let of_bits = |history: &Vec<f64>| history.iter().map(|y| y.to_bits()).collect::<Vec<u64>>();
    let different: HashSet<Vec<u64>> = histories.iter().map(of_bits).collect();
    if different.len() < PLATEAU && histories.iter().any(|history| history.len() > 1) {
        return none;
    }
    let mut values = different_values(histories.into_iter().map(Vec::into_iter));
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Distances from the middle of two limits differ by their rounding.
    values.dedup_by(|later, first| {
        let equal = later.0 - first.0 <= EQUAL * later.0.abs().max(threshold.abs());
        if equal {
            *first = (later.0, first.1 + later.1);
        }
        equal
    });
    let least = COARSE * standard_deviation(&values);
    let above = values.partition_point(|(y, _)| *y < threshold);
    let between = |b: f64, a: f64| LearnedThreshold {
        value: 0.5 * (a + b),
        jump: a - b,
        coarse: (a - b > least).then_some(values.len()),
    };
    let below = above.checked_sub(1).map(|place| values[place]);
    if let (Some((b, below)), Some((a, reached))) = (below, values.get(above))
        && below.min(*reached) >= PLATEAU
    {
        return between(b, *a);
    }
    if !on_grid && let Some((first, step)) = common_step(&values, above) {
        // Rounding of decimal fractions must not move a threshold on the grid to the next value.
        let steps = ((threshold - first) / step - 1e-6).ceil();
        return between(first + (steps - 1.0) * step, first + steps * step);
    }
    match (below, values.get(above)) {
        (Some((b, _)), Some((a, 2..))) if *a == threshold => between(b, *a),
        _ => none,
    }
}

/// The different values of each history, each as `(value, 1)`.
fn different_values<H: Iterator<Item = f64>>(histories: impl Iterator<Item = H>) -> Vec<(f64, usize)> {
    let mut values = Vec::new();
    for history in histories {
        let mut last = f64::NAN;
        for y in history.filter(|y| y.is_finite()) {
            if y != last {
                values.push((y, 1));
            }
            last = y;
        }
    }
    values
}

/// Standard deviation of the values `(value, number)`, each as often as it occurs.
fn standard_deviation(values: &[(f64, usize)]) -> f64 {
    let count = values.iter().map(|(_, number)| number).sum::<usize>().max(1) as f64;
    let mean = values.iter().map(|(y, number)| y * *number as f64).sum::<f64>() / count;
    (values.iter().map(|(y, number)| (y - mean).powi(2) * *number as f64).sum::<f64>() / count).sqrt()
}

/// One of the values `(value, number)` nearest to the threshold, which comes before place `above`, and the largest step of
/// which their differences are multiples; `None` if they have no common step.
fn common_step(values: &[(f64, usize)], above: usize) -> Option<(f64, f64)> {
    if values.len() < NEAREST {
        return None;
    }
    let first = above.saturating_sub(NEAREST / 2).min(values.len() - NEAREST);
    let near: Vec<f64> = values[first..first + NEAREST].iter().map(|(y, _)| *y).collect();
    step_of(&near).map(|step| (near[0], step))
}

/// The largest step of which the differences of these ascending values are multiples, if they have one.
fn step_of(values: &[f64]) -> Option<f64> {
    let differences = || values.windows(2).map(|pair| pair[1] - pair[0]);
    let largest = differences().fold(0.0, f64::max);
    let rounding = 8.0 * f64::EPSILON * values.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    let none = REMAINDER * largest + rounding;
    let step = differences().fold(0.0, |step, difference| divisor(step, difference, none));
    (step > LEAST_STEP * largest && step > 1e3 * rounding).then_some(step)
}

/// True if the values of a variable in a design of experiments are multiples of a step apart, or all the same: a response of such variables
/// alone may have their steps.
pub fn is_on_grid(mut values: Vec<f64>) -> bool {
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.len() < 2 || step_of(&values).is_some()
}

/// The greatest common divisor of two numbers at least 0, with remainders up to `none` taken as 0.
fn divisor(mut a: f64, mut b: f64, none: f64) -> f64 {
    while b > none {
        let remainder = a % b;
        // A remainder just below the divisor is none either.
        let remainder = if b - remainder <= none { 0.0 } else { remainder };
        (a, b) = (b, remainder);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learned(values: &[f64], threshold: f64) -> LearnedThreshold {
        learned_threshold(values.iter().map(|y| std::iter::once(*y)), threshold, false)
    }

    /// Values without a step between -2 and 2.
    fn continuous(count: usize) -> Vec<f64> {
        (0..count).map(|i| 2.0 * (12.9898 * i as f64).sin()).collect()
    }

    #[test]
    fn issue_half_a_plateau_at_the_limit_was_safe() {
        // Integers: from a few simulations, and with every value in several.
        let count = |scale: f64, n| continuous(n).iter().map(|y| (scale * y).floor()).collect::<Vec<f64>>();
        for n in [12, 60] {
            for (threshold, expected) in [(1.0, 0.5), (0.4, 0.5), (0.5, 0.5), (-1.0, -1.5)] {
                assert_eq!(learned(&count(2.0, n), threshold).value, expected, "{n} {threshold}");
            }
        }
        // A flag has plateaus and keeps its middle; so do limits between the values of any output.
        let flag = learned(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0], 1.0);
        assert_eq!((flag.value, flag.coarse), (0.5, Some(2)));
        assert_eq!(learned(&[0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0], 0.5).value, 0.5);
        // Two decimals, few of which occur twice: half of 0.01, whatever the next smaller value is.
        let printed: Vec<f64> = continuous(60).iter().map(|y| (100.0 * y).round() / 100.0).collect();
        let found = learned(&printed, 1.3);
        assert!((found.value - 1.295).abs() < 1e-9 && (found.jump - 0.01).abs() < 1e-9, "{found:?}");
        assert_eq!(found.coarse, None);
        // Three digits: the step is 1 above 100 and 0.1 below it.
        let three = |y: f64| {
            if 100.0 + y >= 100.0 { (100.0 + y).round() } else { (10.0 * (100.0 + y)).round() / 10.0 }
        };
        let printed: Vec<f64> = continuous(60).iter().map(|y| three(2.0 * y)).collect();
        assert_eq!(learned(&printed, 102.0).value, 101.5);
        let shown = learned(&printed, 98.0).value;
        assert!((shown - 97.95).abs() < 1e-9, "{shown}");
    }

    #[test]
    fn outputs_without_steps_keep_their_threshold() {
        for n in [3, 12, 200] {
            let found = learned(&continuous(n), 0.7);
            assert_eq!(found, LearnedThreshold { value: 0.7, jump: 0.0, coarse: None });
        }
        // A single value on the limit is no step, and a constant output has none.
        let mut values = continuous(40);
        values.push(0.7);
        assert_eq!(learned(&values, 0.7).value, 0.7);
        assert_eq!(learned(&[5.0; 20], 5.0).value, 5.0);
        // A response that is cut off at its limit jumps from the next smaller value.
        let cut: Vec<f64> = continuous(40).iter().map(|y| y.min(0.7)).collect();
        let below = cut.iter().copied().filter(|y| *y < 0.7).fold(f64::MIN, f64::max);
        assert_eq!(learned(&cut, 0.7).value, 0.5 * (below + 0.7));
    }

    #[test]
    fn issue_rounded_values_of_a_variable_gave_its_response_steps() {
        let forces: Vec<f64> =
            [0, 31, 8, 64, 15, 40, 77, 22].iter().map(|k| 1.0 + 0.02 * f64::from(*k)).collect();
        let free = continuous(8);
        assert!(is_on_grid(forces.iter().map(|x| (x - 1.3) / 0.7).collect()) && !is_on_grid(free));
        let found =
            |on_grid| learned_threshold(forces.iter().map(|y| std::iter::once(*y)), 1.6, on_grid).value;
        assert_eq!((found(true), (found(false) - 1.59).abs() < 1e-9), (1.6, true));
    }

    #[test]
    fn issue_an_output_without_scatter_failed_at_the_middle_of_two_checkpoints() {
        for different in [1, 2] {
            let history = |k: usize| (1..=10).map(move |n| f64::from(n) * 10.0 * (1 + k % different) as f64);
            assert_eq!(learned_threshold((0..20).map(history), 63.0, false).value, 63.0);
        }
    }
}
