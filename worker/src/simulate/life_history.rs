//! The outputs over a life, and the worst of those under several operating conditions.
//!
//! An output of the motion is the worst of the conditions: the largest, or the smallest where its limit states fail below. With the values
//! y_c and their stated errors e_c it is y = max y_c, and its error the larger distance of y from max (y_c + e_c) and max (y_c - e_c), the
//! bounds of the worst.
//!
//! # Source
//! Bounds of a maximum: Moore (1966), Interval Analysis.

use common::scene::{Fails, Scene};

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
