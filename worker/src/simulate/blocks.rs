//! A life as blocks of cycles: the cycles that are simulated, and the outputs at the checkpoints between them.
//!
//! The contact history of one simulated cycle stands for all cycles of the block that follows it (block extrapolation): with the wear
//! rate dh/dN [m per cycle] of control point i at cycle n, the depth grows over a block of T cycles by
//!
//!   h_i(n + T) = h_i(n) + integral of dh_i/dN over the block, the contact history held fixed.
//!
//! Wear is fastest on a new bore, so the first block is split into T/16, T/16, T/8, T/4, T/2, unless the wear model of the scene has explicit
//! steps of one length T. Valid while the contact history
//! changes little over a block; the evaluation estimates the error of holding it fixed (`error_estimate.rs`).
//!
//! # Source
//! Cui et al., China Mechanical Engineering 37(6), 2026, 1472-1485, doi 10.3969/j.issn.1004-132X.2026.06.020. Interpolation between
//! simulated cycles: Fritsch, Butland, SIAM Journal on Scientific and Statistical Computing 5 (1984).
//!
//! # Outputs over a life
//! The outputs over a life, and the worst of those under several operating conditions.
//!
//! An output of the motion is the worst of the conditions: the largest, or the smallest where its limit states fail below. With the values
//! y_c and their stated errors e_c it is y = max y_c, and its error the larger distance of y from max (y_c + e_c) and max (y_c - e_c), the
//! bounds of the worst.
//!
//! Source:
//! Bounds of a maximum: Moore (1966), Interval Analysis.

use crate::interpolate::Cubic;
use common::accuracy::Accuracy;
use common::scene::monotone::fritsch_butland;
use common::scene::{BlockStep, Fails, Scene};

/// Lives at which a cycle of a scene is simulated [cycles], by its wear model and this accuracy.
pub(crate) fn simulated_lives(scene: &Scene, accuracy: &Accuracy) -> Vec<u32> {
    let life = &scene.life;
    match scene.wear.explicit_step {
        BlockStep::Controlled => block_ends(life.cycles, accuracy.cycle_jump, life.checkpoint_every),
        BlockStep::Explicit(step) => equal_blocks(life.cycles, step),
    }
}

/// Ends of blocks of `step` cycles up to the end of life at `cycles`, all as long as each other but the last one.
fn equal_blocks(cycles: u32, step: u32) -> Vec<u32> {
    let mut ends: Vec<u32> = (0..cycles).step_by(step.max(1) as usize).collect();
    ends.push(cycles);
    ends
}

/// Lives at which a cycle is simulated [cycles]: 0, the ends of the graded first block, then every `jump` cycles, rounded to the
/// checkpoints, which are `every` cycles apart, to the end of life at `cycles`. Where no block of half of `jump` or more divides the distance of the
/// checkpoints, the last block before each of them is shorter than the others.
fn block_ends(cycles: u32, jump: u32, every: u32) -> Vec<u32> {
    let jump = jump.clamp(1, cycles);
    let (block, met) = match (jump.div_ceil(2)..=jump).rev().find(|j| every.is_multiple_of(*j)) {
        _ if jump >= every => (jump / every * every, cycles),
        Some(divisor) => (divisor, cycles),
        None => (every.div_ceil(every.div_ceil(jump)), every),
    };
    let mut ends = vec![0];
    ends.extend([16, 8, 4, 2].iter().map(|d| block / d).filter(|&c| c > 0));
    let mut end = block;
    while end < cycles {
        ends.push(end);
        end = (end + block).min((end / met + 1) * met);
    }
    ends.push(cycles);
    ends.dedup();
    ends
}

/// Values at the `checkpoints` from `values` at the simulated `lives` [cycles], at least two: monotone cubic interpolation (Fritsch
/// and Butland), which adds no extremum between two simulated cycles.
pub(crate) fn at_checkpoints(lives: &[u32], values: &[f64], checkpoints: &[u32]) -> Vec<f64> {
    let x: Vec<f64> = lives.iter().map(|&l| f64::from(l)).collect();
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let secant: Vec<f64> = values.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    let slope = |k: usize| -> f64 {
        if n == 2 {
            return secant[0];
        }
        if k == 0 || k == n - 1 {
            // One-sided three-point slope, limited to the same sign and three times the secant.
            let (s0, s1, h0, h1) = if k == 0 {
                (secant[0], secant[1], h[0], h[1])
            } else {
                (secant[n - 2], secant[n - 3], h[n - 2], h[n - 3])
            };
            let d = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
            return if d * s0 <= 0.0 { 0.0 } else { d.abs().min(3.0 * s0.abs()).copysign(s0) };
        }
        fritsch_butland([h[k - 1], h[k]], [secant[k - 1], secant[k]])
    };
    checkpoints
        .iter()
        .map(|&c| {
            let c = f64::from(c);
            let k = x.partition_point(|&l| l < c).clamp(1, n - 1) - 1;
            let s = (c - x[k]) / h[k];
            if s == 1.0 {
                return values[k + 1];
            }
            Cubic::hermite([values[k], values[k + 1]], [slope(k) * h[k], slope(k + 1) * h[k]]).value(s)
        })
        .collect()
}

/// Every output of the scene at every checkpoint `(outputs, m)` [SI].
#[derive(Debug, Clone, PartialEq)]
pub struct LifeHistory {
    /// Values of the outputs.
    pub histories: Vec<Vec<f64>>,
    /// Estimates of their errors.
    pub errors: Vec<Vec<f64>>,
    /// Values in the first cycle, before any wear `(outputs,)` [SI].
    pub start: Vec<f64>,
}

impl LifeHistory {
    /// The worst of the lives under all conditions, at least one, for every output at every checkpoint; a single one as it is.
    pub(crate) fn worst(mut lives: Vec<LifeHistory>, scene: &Scene) -> LifeHistory {
        if lives.len() == 1 {
            return lives.remove(0);
        }
        let mut worst = lives[0].clone();
        for k in 0..scene.outputs.len() {
            let sign = if fails_below(scene, k) { -1.0 } else { 1.0 };
            let largest = |value: &dyn Fn(&LifeHistory) -> f64| {
                lives.iter().fold(f64::NEG_INFINITY, |a, life| larger(a, sign * value(life)))
            };
            worst.start[k] = sign * largest(&|life| life.start[k]);
            for m in 0..worst.histories[k].len() {
                let value = largest(&|life| life.histories[k][m]);
                let upper = largest(&|life| life.histories[k][m] + sign * life.errors[k][m]);
                let lower = largest(&|life| life.histories[k][m] - sign * life.errors[k][m]);
                worst.histories[k][m] = sign * value;
                worst.errors[k][m] = (upper - value).max(value - lower);
            }
        }
        worst
    }
}

/// The larger number; NaN if one of them is.
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// True if small values of an output fail, and none of its limit states has large ones fail.
fn fails_below(scene: &Scene, output: usize) -> bool {
    let mut limits = scene.limit_states.iter().filter(|limit| limit.output == output).peekable();
    limits.peek().is_some() && limits.all(|limit| limit.fails == Fails::Below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_meet_every_checkpoint_they_can() {
        assert_eq!(block_ends(6000, 2000, 1000), [0, 125, 250, 500, 1000, 2000, 4000, 6000]);
        assert_eq!(block_ends(1000, 300, 1000)[..6], [0, 15, 31, 62, 125, 250]);
        assert_eq!(block_ends(5000, 2000, 1000).last(), Some(&5000));
        assert_eq!(block_ends(3, 2000, 1), [0, 1, 3]);
    }

    #[test]
    fn issue_a_prime_number_of_cycles_between_checkpoints_had_blocks_of_one_cycle() {
        let ends = block_ends(2018, 300, 1009);
        assert_eq!(ends, [0, 15, 31, 63, 126, 253, 506, 759, 1009, 1262, 1515, 1768, 2018]);
        assert_eq!(block_ends(300_000_007, 1_000_000, 300_000_007).len(), 1 + 4 + 301);
        // 250 divides; of 14 only 2 and 1 do up to 6.
        assert_eq!(block_ends(2000, 300, 1000)[5..], [250, 500, 750, 1000, 1250, 1500, 1750, 2000]);
        assert_eq!(block_ends(14, 6, 14), [0, 1, 2, 5, 10, 14]);
    }

    #[test]
    fn explicit_steps_have_one_length() {
        assert_eq!(equal_blocks(6000, 2000), [0, 2000, 4000, 6000]);
        assert_eq!(equal_blocks(5000, 2000), [0, 2000, 4000, 5000]);
        assert_eq!(equal_blocks(1, 1000), [0, 1]);
    }

    #[test]
    fn interpolation_keeps_simulated_values_and_straight_lines() {
        let lives = [0, 125, 500, 2000, 4000];
        let line: Vec<f64> = lives.iter().map(|&l| 3.0 + 0.5 * f64::from(l)).collect();
        for (c, v) in [(125, 65.5), (1000, 503.0), (3000, 1503.0), (4000, 2003.0)] {
            assert!((at_checkpoints(&lives, &line, &[c])[0] - v).abs() < 1e-9);
        }
        let bumpy = [1.0, 4.0, 2.0, 2.5, 9.0];
        assert_eq!(at_checkpoints(&lives, &bumpy, &lives), bumpy);
    }
}

#[cfg(test)]
mod life_history_tests {
    use super::*;
    use common::scene::{LimitState, SceneSource};

    fn life(value: f64, error: f64) -> LifeHistory {
        LifeHistory { histories: vec![vec![value]], errors: vec![vec![error]], start: vec![value] }
    }

    #[test]
    fn the_worst_condition_and_the_bounds_of_it_count() {
        let mut scene = SceneSource::builtin("pendulum").expect("built in").nominal().clone();
        scene.outputs.truncate(1);
        scene.limit_states.clear();
        let worst = |scene: &Scene, lives: &[(f64, f64)]| {
            let found = LifeHistory::worst(lives.iter().map(|&(y, e)| life(y, e)).collect(), scene);
            (found.histories[0][0], found.errors[0][0], found.start[0])
        };
        // The second condition may be the worst by 0.5; it cannot be below 2.9, nor can the worst.
        assert_eq!(worst(&scene, &[(3.0, 0.25), (2.75, 0.75)]), (3.0, 0.5, 3.0));
        assert_eq!(worst(&scene, &[(3.0, 0.25), (1.0, 0.5)]), (3.0, 0.25, 3.0));
        assert_eq!(worst(&scene, &[(3.0, 0.25)]), (3.0, 0.25, 3.0));
        assert!(worst(&scene, &[(1.0, 0.0), (f64::NAN, 0.0)]).0.is_nan());
        let limit = |fails| LimitState { name: "low".into(), output: 0, threshold: 1.0, fails };
        scene.limit_states = vec![limit(Fails::Below)];
        assert_eq!(worst(&scene, &[(3.0, 0.25), (2.0, 0.5)]), (2.0, 0.5, 2.0));
        scene.limit_states.push(limit(Fails::Above));
        assert_eq!(worst(&scene, &[(3.0, 0.25), (2.0, 0.5)]), (3.0, 0.25, 3.0));
    }
}
