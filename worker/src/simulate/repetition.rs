//! How the motion of an evaluation repeats itself from cycle to cycle, as settling (`settling.rs`) and the probes (`probe.rs`) find it.
//!
//! # Sequences of states
//! States at the starts of successive cycles, and the periodic motion that they approach.
//!
//! The states x_n, over the scales of the error control, change by u_n = x_(n+1) - x_n. Near a periodic motion s the change is linear,
//! x_(n+1) - s = A (x_n - s), and decays geometrically. Reduced-rank extrapolation finds
//!
//!   s = x_0 + sum over j < k of xi_j u_j,   xi: least squares of |u_0 + sum of xi_j (u_(j+1) - u_j)|,
//!
//! exactly if k modes are left, as of a vibration of k / 2 natural frequencies. s - x_n is the sum of all changes still to come.
//!
//! # Source
//! Sidi, Vector Extrapolation Methods with Applications (2017), chapters 1 and 2.

use common::outputs::UnsettledMotion;
use nalgebra::{DMatrix, DVector};

/// How a motion repeats itself.
#[derive(Debug, Clone, Default)]
pub struct Repetition {
    /// True if drives and ideal joints leave no freedom, so that the bodies move beside their ideal motion by the clearances alone.
    pub is_determined: bool,
    /// True if no cycle repeats the one before, so that none is measured again.
    pub is_irregular: bool,
    /// Sum of all changes still to come over that of the next cycle, for a motion that came to repeat itself only in further settling cycles;
    /// else zero [1].
    pub slowness: f64,
    /// What is still to come of a motion that has not settled: for every output of the motion `(outputs,)` [SI], and relative to the wear rate of every
    /// surface of every joint of the scene `(SURFACES joints,)` [1].
    pub to_come: Option<(Vec<f64>, Vec<f64>)>,
    /// Output that changes most from cycle to cycle if the motion has not settled, as the result states it.
    pub unsettled: Option<UnsettledMotion>,
}

/// Most modes of the change that are taken out at a time.
const MODES: usize = 4;
/// Singular values of the changes over the largest one below which they are rounding [1].
const ROUNDING: f64 = 1e-9;
/// Ratio of successive changes above which they count as not decaying [1].
pub(super) const NOT_DECAYING: f64 = 0.98;

/// Change from one of the `states` of an island at the starts of successive cycles `(k, 2 n)` [1], angles without whole turns, to the next one `(2 n,)` [1].
fn change(states: &[Vec<f64>], k: usize) -> DVector<f64> {
    let (now, next) = (&states[k], &states[k + 1]);
    DVector::from_iterator(now.len(), next.iter().zip(now).map(|(next, now)| next - now))
}

/// Sum of the changes of such states still to come `(2 n,)` [1]: the change of the last cycle where it cannot be extrapolated.
pub(super) fn to_come(states: &[Vec<f64>]) -> Vec<f64> {
    let n = states.len();
    let last = change(states, n - 2);
    let modes = MODES.min(n - 2);
    if modes == 0 {
        return last.as_slice().to_vec();
    }
    let base = n - 2 - modes;
    let changes: Vec<DVector<f64>> = (base..n - 1).map(|k| change(states, k)).collect();
    let second: Vec<DVector<f64>> = changes.windows(2).map(|pair| &pair[1] - &pair[0]).collect();
    let svd = DMatrix::from_columns(&second).svd(true, true);
    let least = ROUNDING * svd.singular_values.max();
    let Ok(xi) = svd.solve(&-&changes[0], least.max(f64::MIN_POSITIVE)) else {
        return last.as_slice().to_vec();
    };
    // From the first of these states, less the way from there to the last one.
    let mut to_come = -changes.iter().sum::<DVector<f64>>();
    for (xi, change) in xi.iter().zip(&changes) {
        to_come += change * *xi;
    }
    to_come.as_slice().to_vec()
}

/// Sum of a geometric series over its first term, with the mean ratio of the changes of such states; infinite if they do not decay [1].
pub(super) fn slowness(states: &[Vec<f64>]) -> f64 {
    let n = states.len();
    let size = |k: usize| change(states, k).norm();
    if n < 3 || size(0) == 0.0 {
        return 1.0;
    }
    let ratio = (size(n - 2) / size(0)).powf(1.0 / (n - 2) as f64);
    if ratio < NOT_DECAYING { 1.0 / (1.0 - ratio) } else { f64::INFINITY }
}

/// Largest magnitude [1].
pub(super) fn size(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |a: f64, x| if x.is_nan() { f64::INFINITY } else { a.max(x.abs()) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two vibrations of other frequencies that decay by 0.97 and 0.9 a cycle around (3, -2, 5, 1).
    fn states(n: usize) -> Vec<Vec<f64>> {
        let at = |k: usize| -> Vec<f64> {
            let of = |decay: f64, turn: f64| {
                let (s, c) = (turn * k as f64).sin_cos();
                (decay.powi(k as i32) * c, decay.powi(k as i32) * s)
            };
            let ((a, b), (c, d)) = (of(0.97, 1.1), of(0.9, 2.3));
            vec![3.0 + a + 0.5 * c, -2.0 + b, 5.0 - c, 1.0 + d + 0.3 * a]
        };
        (0..n).map(at).collect()
    }

    #[test]
    fn two_vibrations_are_extrapolated_to_where_they_end() {
        let sequence = states(7);
        let ends = sequence[6].iter().zip(to_come(&sequence)).map(|(state, rest)| state + rest);
        for (end, exact) in ends.zip([3.0, -2.0, 5.0, 1.0]) {
            assert!((end - exact).abs() < 1e-9, "{end} for {exact}");
        }
    }

    #[test]
    fn a_geometric_decay_has_the_sum_of_its_series() {
        let decay: Vec<Vec<f64>> = (0..5).map(|k| vec![0.8_f64.powi(k)]).collect();
        assert!((slowness(&decay) - 5.0).abs() < 1e-12);
        assert!((to_come(&decay)[0] + 0.8_f64.powi(4)).abs() < 1e-9);
        let turning: Vec<Vec<f64>> = (0..5).map(|k| vec![f64::from(k)]).collect();
        assert_eq!(slowness(&turning), f64::INFINITY);
    }
}
