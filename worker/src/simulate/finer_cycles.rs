//! Outputs of a measured cycle on surfaces with n, 2 n and 4 n control points, and the error that follows from them.
//!
//! With the values y1, y2 and y4 of an output on n, 2 n and 4 n points and r = |y4 - y2| / |y2 - y1| the stated error is
//!
//!   |y4 - y1| + r / (1 - r) |y4 - y2|              r < 3/4, what is left of a geometric series,
//!   2 max (|y2 - y1|, |y4 - y1|, |y4 - y2|)        else: the output does not converge with the points.
//!
//! # Source
//! Comparison of three grids: Roache, Verification and Validation in Computational Science and Engineering (1998), chapter 5.

use common::outputs::PointsError;
use common::scene::{Output, Scene};

/// Ratio of successive changes above which an output does not converge [1]: a spline through a scar with edges halves them.
const CONVERGES: f64 = 0.75;
/// Stated error over the largest change of such an output [1].
const SAFETY: f64 = 2.0;

/// Outputs of the motion of one cycle on surfaces with n, 2 n and 4 n control points.
#[derive(Debug, Clone, PartialEq)]
pub struct FinerCycles {
    /// Life of the surfaces [cycles].
    pub life: u32,
    /// The outputs `(3, outputs)` [SI].
    pub outputs: [Vec<f64>; 3],
}

impl FinerCycles {
    /// Changes of output `k` with twice and with four times the points [SI].
    pub(crate) fn changes(&self, k: usize) -> [f64; 2] {
        let [own, twice, four_times] = &self.outputs;
        [twice, four_times].map(|finer| finer[k] - own[k])
    }

    /// Estimated error of output `k` [SI], and whether it converges.
    pub(crate) fn error(&self, k: usize) -> (f64, bool) {
        estimate(self.changes(k))
    }
}

/// What more control points change in each output of the motion, at the one of the compared `lives` where that is most; empty without any.
pub(crate) fn points_errors(scene: &Scene, lives: &[FinerCycles]) -> Vec<PointsError> {
    let outputs = scene.outputs.iter().enumerate().filter(|(_, output)| output.kind.wear().is_none());
    let largest = |(k, output): (usize, &Output)| {
        let at = lives.iter().max_by(|a, b| a.error(k).0.total_cmp(&b.error(k).0))?;
        let (error, converges) = at.error(k);
        Some(PointsError {
            output: output.name.clone(),
            cycles: at.life,
            values: [0, 1, 2].map(|points: usize| at.outputs[points][k]),
            error,
            converges,
            stated: !scene.control_points_of_model,
        })
    };
    outputs.filter_map(largest).collect()
}

/// Error of a value that twice and four times the points change by these amounts, and whether it converges.
fn estimate([twice, four_times]: [f64; 2]) -> (f64, bool) {
    let (first, second) = (twice.abs(), (four_times - twice).abs());
    if second < CONVERGES * first {
        return (four_times.abs() + second * second / (first - second), true);
    }
    (SAFETY * first.max(second).max(four_times.abs()), second == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_that_halve_state_their_limit_and_others_twice_the_largest() {
        // 1, 1/2, 1/4 ... add up to 2.
        assert_eq!(estimate([1.0, 1.5]), (2.0, true));
        assert_eq!(estimate([-1.0, -1.25]), (1.25 + 1.0 / 12.0, true));
        // The drive at 66 000 cycles: 24.58, 26.37 and 34.39 r/min.
        let (error, converges) = estimate([1.79, 9.81]);
        assert!((error - 19.62).abs() < 1e-12 && !converges);
        assert_eq!(estimate([0.0, 0.0]), (0.0, true));
        assert_eq!(estimate([0.0, 1.0]), (2.0, false));
    }
}
