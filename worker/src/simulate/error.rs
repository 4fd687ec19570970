//! The evaluation's own estimate of its numerical error, for every output at every checkpoint.
//!
//! Four shares: the time steps and what had not settled (from [`Probe`]s), the wear step and the contact frozen over a
//! block (as the wear steps keep account of them), what a wrong wear does to the motion, and the interpolation
//! between simulated cycles.

use super::probe::Probe;
use super::run::Run;
use common::scene::{OutputKind, Scene};
use std::f64::consts::TAU;

/// Error of the motion outputs over their change in a probe: both cycles start from a state computed with the coarser
/// steps, and a vibration shows another cycle every time. With these two factors 659 of 662 wear depths and all
/// 662 values of the motion lie within their estimate of what `reference` gives, the worst at 1.14 and 0.67 of it:
/// three samples each of `flapping-wing` and `four-bar` and one of `flapping-wing-tolerances`, `draft` and
/// `balanced`, and the nominal `flapping-wing` under `foundation` to 24 000 cycles, `balanced`.
const MOTION_SAFETY: f64 = 2.5;
/// The same of the wear.
const WEAR_SAFETY: f64 = 2.0;
/// Further factor of both for a motion that does not repeat itself: with friction 0.5 the flapping wing's asymmetry
/// was off by up to 3 times the estimate without it.
const RESTLESS: f64 = 3.0;
/// A peak of the motion between two steps is found on a cubic, which misses a harmonic k of the cycle by at most
/// (2 pi k h)^4 / 384, h the largest step as a fraction of the cycle (de Boor 1978): so many harmonics count. How
/// much of it is seen depends on where the steps happen to fall, so a probe can miss it. Forces and torques are looked
/// at between no two steps: their peaks are missed by at most (2 pi k h)^2 / 8.
const HARMONICS: f64 = 15.0;
/// Relative error of the motion on worn bores below which nothing is claimed. Other time steps cut the history of the
/// contact elsewhere, and the bore worn by it differs by a little that no probe sees, since it stays on the same bore: with a
/// wear coefficient ten times that of `flapping-wing`, half the step changes its asymmetry by 5e-5.
const WORN_MOTION: f64 = 1e-4;
/// Relative error of any value that took part in the integration: rounding of some million steps.
const ROUNDING: f64 = 1e-10;

/// Depth of one joint and the estimated error of its wear steps `(points,)` each [m].
struct Worn {
    depth: Vec<f64>,
    error: Vec<f64>,
}

/// Account of an evaluation's numerical error.
#[derive(Default)]
pub struct Doubt {
    probes: Vec<Probe>,
    /// Lives at the ends of the blocks.
    lives: Vec<u32>,
    /// Per life, per joint of the scene; joints that do not wear are empty.
    worn: Vec<Vec<Worn>>,
}

impl Doubt {
    /// Takes notice of a probe.
    pub fn probed(&mut self, probe: Probe) {
        self.probes.push(probe);
    }

    /// Takes notice of the wear at `life`, the end of a block whose error is known by now. Of the error the largest
    /// so far counts: parts that cancel later are parts that nobody knows.
    pub fn worn(&mut self, run: &Run, life: u32, depth: Vec<Vec<f64>>) {
        let mut error = vec![Vec::new(); depth.len()];
        for m in &run.islands {
            for (joint, step) in m.island.joints.iter().zip(&m.steps) {
                error[joint.scene_joint] = step.error_behind().iter().map(|e| e.abs()).collect();
            }
        }
        if let Some(before) = self.worn.last() {
            for (error, before) in error.iter_mut().zip(before) {
                error.iter_mut().zip(&before.error).for_each(|(e, b)| *e = e.max(*b));
            }
        }
        self.lives.push(life);
        self.worn.push(depth.into_iter().zip(error).map(|(depth, error)| Worn { depth, error }).collect());
    }

    /// Error of every output at every checkpoint `(outputs, m)`, given the histories there and the motion
    /// outputs `measured` at the simulated lives `lives`; `largest_step` as a fraction of the cycle.
    pub fn errors(
        &self,
        scene: &Scene,
        histories: &[Vec<f64>],
        lives: &[u32],
        measured: &[Vec<f64>],
        largest_step: f64,
    ) -> Vec<Vec<f64>> {
        let phase = TAU * HARMONICS * largest_step;
        let peak = |kind: &OutputKind| match kind {
            OutputKind::PeakJointForce { .. } | OutputKind::DrivingTorque { .. } => phase * phase / 8.0,
            _ => phase * phase * phase * phase / 384.0,
        };
        let checkpoints = scene.life.checkpoints();
        let wear = |joints: &[usize]| -> Vec<(f64, f64)> {
            let at = |&life: &u32| self.wear_error(joints, life);
            checkpoints.iter().map(at).collect()
        };
        // How far a wrong wear displaces the life: the largest relative error of any joint's depth.
        let relative = |life: &u32, joint: usize| match self.wear_error(&[joint], *life) {
            (error, depth) if depth > 0.0 => error / depth,
            _ => 0.0,
        };
        let largest = |life: &u32| (0..scene.joints.len()).map(|j| relative(life, j)).fold(0.0, f64::max);
        let behind: Vec<f64> = checkpoints.iter().map(|life| largest(life) * f64::from(*life)).collect();
        let of = |(k, kind): (usize, &OutputKind)| -> Vec<f64> {
            let error: Vec<f64> = match kind {
                OutputKind::LargestWear { joints } => wear(joints).iter().map(|(error, _)| *error).collect(),
                _ => {
                    let values: Vec<f64> = measured.iter().map(|m| m[k]).collect();
                    let irregular =
                        if self.restless_by_nature() { irregularity(lives, &values) } else { 0.0 };
                    let shares = checkpoints.iter().zip(&histories[k]).zip(&behind);
                    shares
                        .map(|((&life, value), behind)| {
                            let (secant, slope) = neighbours(lives, &values, life);
                            MOTION_SAFETY * self.near(life, |p| p.motion[k])
                                + (peak(kind) + WORN_MOTION) * value.abs()
                                + (value - secant).abs()
                                + irregular
                                + slope * behind
                        })
                        .collect()
                }
            };
            error.iter().zip(&histories[k]).map(|(e, value)| e.max(ROUNDING * value.abs())).collect()
        };
        scene.outputs.iter().map(|output| &output.kind).enumerate().map(of).collect()
    }

    /// Error of the largest depth of these joints at `life`, and that depth [m].
    ///
    /// The error of the wear steps is how much deeper the deepest point would be if every point were off by its
    /// own estimate; that of the time steps is the probes' relative one of the depth. The two have nothing to do
    /// with each other: their squares add.
    fn wear_error(&self, joints: &[usize], life: u32) -> (f64, f64) {
        let at = self.lives.partition_point(|&end| end < life).min(self.lives.len().saturating_sub(1));
        let Some(worn) = self.worn.get(at) else { return (0.0, 0.0) };
        let largest = |of: &dyn Fn(&Worn, usize) -> f64| {
            let points = joints.iter().flat_map(|&j| (0..worn[j].depth.len()).map(move |i| (j, i)));
            points.fold(0.0_f64, |a, (j, i)| a.max(of(&worn[j], i)))
        };
        let depth = largest(&|w, i| w.depth[i]);
        let steps = largest(&|w, i| w.depth[i] + w.error[i]) - depth;
        let time = joints.iter().fold(0.0_f64, |a, &j| {
            let deepest = worn[j].depth.iter().fold(0.0_f64, |a, &b| a.max(b));
            a.max(WEAR_SAFETY * deepest * self.near(life, |p| p.wear[j]))
        });
        (libm::hypot(steps, time), depth)
    }

    /// The larger value of the two probes around `life`; where one of them found motion that does not repeat itself,
    /// or the very first one did, [`RESTLESS`] times the largest of all such probes: a few cycles of it show no more than a part of its spread.
    fn near(&self, life: u32, value: impl Fn(&Probe) -> f64) -> f64 {
        let next = self.probes.partition_point(|p| p.life < life);
        let around = &self.probes[next.saturating_sub(1)..(next + 1).min(self.probes.len())];
        let largest = around.iter().map(&value).fold(0.0, f64::max);
        if self.restless_by_nature() || around.iter().any(|p| p.restless) {
            let restless = self.probes.iter().filter(|p| p.restless);
            return largest.max(RESTLESS * restless.map(value).fold(0.0, f64::max));
        }
        largest
    }

    /// Whether the motion does not repeat itself on the unworn bores either.
    fn restless_by_nature(&self) -> bool {
        self.probes.first().is_some_and(|p| p.life == 0 && p.restless)
    }
}

/// Largest distance of a value from the straight line through its two neighbours: what a motion that does not repeat itself
/// owes to details of the bore.
fn irregularity(lives: &[u32], values: &[f64]) -> f64 {
    let distance = |(life, value): (&[u32], &[f64])| {
        let share = f64::from(life[1] - life[0]) / f64::from(life[2] - life[0]);
        (value[0] + share * (value[2] - value[0]) - value[1]).abs()
    };
    lives.windows(3).zip(values.windows(3)).map(distance).fold(0.0, f64::max)
}

/// Straight line between the simulated lives around `life`, and the steepest slope there or beside.
fn neighbours(lives: &[u32], values: &[f64], life: u32) -> (f64, f64) {
    let slope = |k: usize| (values[k + 1] - values[k]) / f64::from(lives[k + 1] - lives[k]);
    let last = lives.len() - 2;
    let k = lives.partition_point(|&l| l < life).clamp(1, last + 1) - 1;
    let steepest = (k.saturating_sub(1)..=(k + 1).min(last)).fold(0.0_f64, |a, k| a.max(slope(k).abs()));
    (values[k] + slope(k) * f64::from(life - lives[k]), steepest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probe(life: u32, motion: f64, wear: f64) -> Probe {
        Probe { life, motion: vec![motion], wear: vec![wear], restless: false }
    }

    #[test]
    fn between_two_probes_the_larger_change_counts() {
        let probes = vec![probe(10, 1.0, 0.1), probe(30, 3.0, 0.3), probe(90, 2.0, 0.2)];
        let doubt = Doubt { probes, ..Doubt::default() };
        let motion = |life| doubt.near(life, |p| p.motion[0]);
        assert_eq!([5, 10, 20, 30, 31, 90].map(motion), [1.0, 1.0, 3.0, 3.0, 3.0, 3.0]);
    }

    #[test]
    fn wear_error_joins_the_steps_of_the_deepest_point_with_the_rate() {
        let worn = Worn { depth: vec![10.0, 9.0], error: vec![0.1, 1.3] };
        let doubt = Doubt {
            probes: vec![probe(100, 0.0, 0.02)],
            lives: vec![0, 100],
            worn: vec![vec![], vec![worn]],
        };
        // The second point might be the deepest, by 0.3; the rate is off by 2 %, counted WEAR_SAFETY times.
        let (error, depth) = doubt.wear_error(&[0], 70);
        assert_eq!(depth, 10.0);
        assert!((error - 0.3_f64.hypot(WEAR_SAFETY * 0.2)).abs() < 1e-12, "{error}");
    }

    #[test]
    fn a_straight_line_is_interpolated_without_doubt() {
        let (lives, values) = ([0, 10, 30, 70], [1.0, 2.0, 4.0, 8.0]);
        for (life, value) in [(10, 2.0), (15, 2.5), (70, 8.0)] {
            let (line, slope) = neighbours(&lives, &values, life);
            assert!((line - value).abs() < 1e-12 && (slope - 0.1).abs() < 1e-12);
        }
    }
}
