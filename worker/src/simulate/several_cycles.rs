//! Means over several cycles of a motion that does not repeat itself, and how far the cycles spread.
//!
//! For the wear rate r_m,i [m per cycle] of control point i in cycle m = 1..M on the same bore the mean drives the block that follows,
//! and a block of T cycles adds T^2 v_i to the variance of the depth [m^2], with the variance v_i of the mean. For independent cycles
//! v_i = s_i^2 / M, with the variance s_i^2 of the single ones; `slider-crank` keeps to one kind of motion for longer than M cycles now and
//! then, so that the scatter of the means from life to life counts where it is larger (`error_estimate.rs`).
//!
//! An output of the motion is the mean over the M cycles too; stated is how far single cycles spread.
//!
//! # Source
//! Variance of a mean of independent values, and of a sum: Cochran, Sampling Techniques (1977), chapter 2.

use super::run::Run;
use crate::wear::ContactHistory;
use common::failure::SimulationFailure;

/// Cycles on each bore whose mean is taken. The wear rate of the deepest point of `slider-crank` differs by 14 to 17 % from cycle to
/// cycle; means of six states its depth within 10 % from the first checkpoint on, at less than twice the cost of single cycles with
/// their probes.
pub(crate) const CYCLES: usize = 6;

/// Cycles measured one after the other on the same bores.
pub struct SeveralCycles {
    /// Mean of every output of the motion `(outputs,)` [SI].
    pub motion: Vec<f64>,
    /// How far they spread.
    pub spread: CycleSpread,
}

/// Spread of the cycles on one bore.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleSpread {
    /// Life of the bore [cycles].
    pub life: u32,
    /// Variance of every output of the motion over single cycles `(outputs,)` [SI^2].
    pub motion: Vec<f64>,
    /// Mean wear rate [m per cycle] at every control point of every joint of the scene, and its variance [m^2 per cycle^2]
    /// `(joints, 2, points)`; empty for joints that do not wear.
    wear: Vec<(Vec<f64>, Vec<f64>)>,
}

impl CycleSpread {
    /// Mean wear rate of a control point [m per cycle], and its variance [m^2 per cycle^2]; zero if the joint does not wear.
    pub(crate) fn wear(&self, joint: usize, point: usize) -> (f64, f64) {
        let (rate, variance) = &self.wear[joint];
        let value = |of_points: &[f64]| of_points.get(point).copied().unwrap_or(0.0);
        (value(rate), value(variance))
    }
}

impl Run<'_> {
    /// Measures further cycles after the one just measured, on the bores of `life` [cycles], and puts the mean of all contact histories
    /// in the place of the last one.
    ///
    /// # Errors
    /// [`SimulationFailure`] if a cycle fails.
    pub(crate) async fn several_cycles(&mut self, life: u32) -> Result<SeveralCycles, SimulationFailure> {
        let mut histories: Vec<Vec<ContactHistory>> =
            self.islands.iter().map(|state| state.recorder.histories.clone()).collect();
        let (mut motion, mut wear) = (vec![self.motion_outputs()], vec![self.wear_rates(life)?]);
        for _ in 1..CYCLES {
            self.measure().await?;
            motion.push(self.motion_outputs());
            wear.push(self.wear_rates(life)?);
            for (all, state) in histories.iter_mut().zip(&self.islands) {
                all.iter_mut().zip(&state.recorder.histories).for_each(|(all, one)| all.append(one));
            }
        }
        for (mut all, state) in histories.into_iter().zip(&mut self.islands) {
            all.iter_mut().for_each(|history| history.divide_work(CYCLES));
            state.recorder.histories = all;
        }
        let (mean, of_single_cycles) = mean_and_variance(&motion);
        let joints = 0..self.scene.joints.len();
        let wear = joints.map(|joint| {
            let rates: Vec<Vec<f64>> = wear.iter().map(|joints| joints[joint].clone()).collect();
            let (rate, mut variance) = mean_and_variance(&rates);
            variance.iter_mut().for_each(|variance| *variance /= CYCLES as f64);
            (rate, variance)
        });
        Ok(SeveralCycles {
            motion: mean,
            spread: CycleSpread { life, motion: of_single_cycles, wear: wear.collect() },
        })
    }
}

/// Mean and variance over the rows `(m, n)`, m > 1, of every column `(n,)` each.
fn mean_and_variance(rows: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
    let m = rows.len() as f64;
    let column = |k: usize| {
        let mean = rows.iter().map(|row| row[k]).sum::<f64>() / m;
        let squares: f64 = rows.iter().map(|row| (row[k] - mean) * (row[k] - mean)).sum();
        (mean, squares / (m - 1.0))
    };
    (0..rows[0].len()).map(column).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_variance_are_those_of_the_columns() {
        let (mean, variance) = mean_and_variance(&[vec![1.0, 5.0], vec![2.0, 5.0], vec![6.0, 5.0]]);
        assert_eq!((mean, variance), (vec![3.0, 5.0], vec![7.0, 0.0]));
    }
}
