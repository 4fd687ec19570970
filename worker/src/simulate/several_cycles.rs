//! Means over several motions of a mechanism that does not repeat itself, and how far they spread.
//!
//! On the unworn bores c = 1..M motions are started, each from a cycle with a narrower clearance that makes its impacts fall elsewhere.
//! After every block each of them is continued by one cycle on the bores as worn by all: the mean of the M contact histories drives
//! the wear. With the wear rate r_c,b [m per cycle] of a control point in motion c before block b of T_b cycles, motion c alone has
//! worn
//!
//!   D_c = sum over b of T_b r_c,b                                        [m],
//!
//! and the variance of their mean is s^2 / M, with the variance s^2 of the D_c (independent replications). The cycles of one motion need
//! not be independent, as those of `slider-crank` are not: on the worn bore it keeps to one of two kinds of motion.
//!
//! An output of the motion is the mean over the M cycles too; stated is how far single cycles spread.
//!
//! # Source
//! Method of independent replications: Law, Simulation Modeling and Analysis (2015), section 9.5.

use super::island_state::IslandState;
use super::{Run, Simulated, join};
use common::scene::JointKind;

/// Motions whose mean is taken.
pub(crate) const MOTIONS: usize = 6;

/// Share of the clearance by which that of the cycle before a motion starts is smaller, from motion to motion [1].
const NARROWER: f64 = 0.03;

/// Motions of a mechanism on the same bores.
#[derive(Clone, Default)]
pub struct SeveralMotions<'a> {
    /// The further motions, one less than [`MOTIONS`], each after its last cycle; empty before they have been started.
    further: Vec<Run<'a>>,
}

/// Spread of the cycles on one bore.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleSpread {
    /// Life of the bore [cycles].
    pub life: u32,
    /// Variance of every output of the motion over single cycles `(outputs,)` [SI^2].
    pub motion: Vec<f64>,
    /// Wear rate in each motion at every control point of every surface of every joint of the scene `(motions, surfaces, points)` [m per
    /// cycle], as [`Run::wear_rates`] has them; empty for surfaces that do not wear.
    pub wear: Vec<Vec<Vec<f64>>>,
}

impl<'a> SeveralMotions<'a> {
    /// Continues all motions by a cycle on the bores of `life` [cycles], side by side; that of the first has just been measured. Puts
    /// the mean of all contact histories in the place of the last one. Returns the mean of every output of the motion `(outputs,)` [SI], and how
    /// far the cycles spread.
    ///
    /// # Errors
    /// [`SimulationFailure`] if a cycle fails.
    pub(crate) async fn measure(
        &mut self,
        run: &mut Run<'a>,
        life: u32,
    ) -> Simulated<(Vec<f64>, CycleSpread)> {
        let start = self.further.is_empty();
        if start {
            self.further = vec![run.clone(); MOTIONS - 1];
        }
        let first = &*run;
        let cycles = self.further.iter_mut().enumerate().map(|(k, motion)| async move {
            motion.begin_count();
            if start {
                return motion.start_motion(NARROWER * (k + 1) as f64).await;
            }
            motion.take_bores(first);
            motion.next_cycle().await
        });
        for ended in join(cycles).await {
            ended?;
        }
        let (mut motion, mut wear) = (vec![run.measured.clone()], vec![run.wear_rates(life)?]);
        for further in &mut self.further {
            motion.push(further.measured.clone());
            wear.push(further.wear_rates(life)?);
            run.add_counts(further);
            for (all, one) in run.islands.iter_mut().zip(&further.islands) {
                let histories = all.recorder.histories.iter_mut().zip(&one.recorder.histories);
                histories.for_each(|(all, one)| all.append(one));
            }
        }
        let histories = run.islands.iter_mut().flat_map(|state| &mut state.recorder.histories);
        histories.for_each(|history| history.divide_work(MOTIONS));
        let (mean, of_single_cycles) = mean_and_variance(&motion);
        Ok((mean, CycleSpread { life, motion: of_single_cycles, wear }))
    }
}

impl Run<'_> {
    /// Starts a motion from where the ideal mechanism has the bodies, with a cycle in bores whose clearance is smaller by the share
    /// `narrower` [1], which no contact outlasts, and measures the cycle after it.
    async fn start_motion(&mut self, narrower: f64) -> Simulated<()> {
        let scene = self.scene;
        let less = |joint: usize| match &scene.joints[joint].kind {
            JointKind::Clearance(clearance) => narrower * clearance.radial_clearance(),
            JointKind::Guide(guide) => narrower * guide.clearance,
            _ => 0.0,
        };
        for (state, start) in self.islands.iter_mut().zip(&self.starts) {
            state.restore(start.clone());
            for pair in state.island.pairs_mut() {
                let mut depth = vec![0.0; pair.depths()];
                depth[..pair.first_depths()].fill(-less(pair.scene_joint()));
                pair.set_depth(&depth);
            }
        }
        self.settling_cycle().await?;
        for IslandState { island, depth, .. } in &mut self.islands {
            island.pairs_mut().zip(depth).for_each(|(pair, depth)| pair.set_depth(depth));
        }
        self.measure().await
    }
}

/// Mean and variance over the rows `(m, n)`, m > 1, of every column `(n,)` each.
pub(crate) fn mean_and_variance(rows: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
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
