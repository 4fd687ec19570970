//! Motion of the mechanism with ideal joints over one cycle, tabulated once an evaluation: the gaps are measured from it.
//!
//! Between two tabulated times a distance h [s] apart, position q [m, rad], velocity v and acceleration a at both ends define
//! the quintic q(s) = q0 + s (h v0 + s (h^2 a0 / 2 + s (c3 + s (c4 + s c5)))), s = 0..1; velocity and acceleration are its
//! derivatives. Error of the acceleration: O(h^4), for a motion with continuous sixth derivative.
//!
//! # Source
//! Two-point Hermite interpolation of second order: Stoer, Bulirsch, Introduction to Numerical Analysis (2002), section 2.1.5.

use super::Unsuitable;
use crate::mechanism::{Island, Pose, ideal_accelerations};
use common::scene::{JointKind, Scene};
use std::f64::consts::TAU;

/// Relative differences between the ends of the cycle below this value count as rounding [1].
const REPEATS: f64 = 1e-6;

/// Position, velocity and acceleration of an island's ideal motion: quintic between equal times, so that the
/// velocity is exactly the rate of the position. The acceleration has an error of fourth order (1e-5 of it at 180
/// intervals).
#[derive(Debug, Clone, PartialEq)]
pub struct IdealMotion {
    period: f64,
    /// Degrees of freedom.
    pub(crate) n: usize,
    /// (q, v, a) at equal times from 0 to the period `(intervals + 1, 3, n)`.
    node: Vec<f64>,
    /// Whole turns of every coordinate per cycle, zero for lengths `(n,)` [rad].
    turns: Vec<f64>,
}

impl IdealMotion {
    /// The motion through (q, v, a) at equal times of a cycle of `period` [s], both ends included `(intervals + 1, 3, n)`.
    pub(crate) fn new(period: f64, n: usize, node: Vec<f64>) -> Self {
        let advance = |i: usize| node[node.len() - 3 * n + i] - node[i];
        let turns = (0..n).map(|i| if i % 3 == 2 { TAU * (advance(i) / TAU).round() } else { 0.0 }).collect();
        IdealMotion { period, n, node, turns }
    }

    /// Writes position, velocity and acceleration at time `t` [s] to `q`, `v`, `a` `(n,)`. Outside the cycle the motion repeats
    /// itself; angles that turn fully go on.
    #[inline]
    pub(crate) fn evaluate(&self, t: f64, q: &mut [f64], v: &mut [f64], a: &mut [f64]) {
        let n = self.n;
        let intervals = self.node.len() / (3 * n) - 1;
        let h = self.period / intervals as f64;
        let (within, cycles) = if (0.0..=self.period).contains(&t) {
            (t, 0.0)
        } else {
            (t.rem_euclid(self.period), (t / self.period).floor())
        };
        let k = ((within / h) as usize).min(intervals - 1);
        let s = within / h - k as f64;
        let (start, end) = self.node[3 * n * k..3 * n * (k + 2)].split_at(3 * n);
        for i in 0..n {
            let (q0, v0, a0) = (start[i], h * start[n + i], h * h * start[2 * n + i]);
            // Differences at the end to the parabola through the start.
            let d = end[i] - q0 - v0 - 0.5 * a0;
            let dv = h * end[n + i] - v0 - a0;
            let da = h * h * end[2 * n + i] - a0;
            let c3 = 10.0 * d - 4.0 * dv + 0.5 * da;
            let c4 = -15.0 * d + 7.0 * dv - da;
            let c5 = 6.0 * d - 3.0 * dv + 0.5 * da;
            q[i] = q0 + s * (v0 + s * (0.5 * a0 + s * (c3 + s * (c4 + s * c5)))) + cycles * self.turns[i];
            v[i] = (v0 + s * (a0 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h;
            a[i] = (a0 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h);
        }
    }

    /// Largest difference between the ends of the cycle, relative to the largest position (for angles: or one radian, if that is
    /// more), times the cycle's angular frequency for every derivative; whole turns of an angle do not count [1].
    fn mismatch_at_the_ends(&self) -> f64 {
        let n = self.n;
        let last = self.node.len() - 3 * n;
        let mut largest = [0.0_f64, 1.0];
        for (index, x) in self.node.iter().enumerate().filter(|(index, _)| index % (3 * n) < n) {
            let unit = usize::from(index % n % 3 == 2);
            largest[unit] = largest[unit].max(x.abs());
        }
        let mut worst: f64 = 0.0;
        let mut per_time = 1.0;
        for kind in 0..3 {
            for i in 0..n {
                let mut off = self.node[last + kind * n + i] - self.node[kind * n + i];
                if kind == 0 && i % 3 == 2 {
                    off -= TAU * (off / TAU).round();
                }
                if off != 0.0 {
                    worst = worst.max(off.abs() / (largest[usize::from(i % 3 == 2)] * per_time));
                }
            }
            per_time *= TAU / self.period;
        }
        worst
    }
}

/// The ideal motion of every island, from the poses of one cycle at equal times.
///
/// # Errors
/// [`Unsuitable`] if the scene has ideal joints, or if its motion is not determined or does not repeat itself.
pub(crate) fn ideal_motions(
    scene: &Scene,
    islands: &[&Island],
    poses: &[Pose],
) -> Result<Vec<IdealMotion>, Unsuitable> {
    if let Some(joint) = scene.joints.iter().find(|j| !matches!(j.kind, JointKind::Clearance(_))) {
        let (is_guide, joint) = (matches!(joint.kind, JointKind::Guide(_)), joint.name.clone());
        return Err(if is_guide { Unsuitable::Guide(joint) } else { Unsuitable::IdealJoint(joint) });
    }
    let accelerations = ideal_accelerations(scene, poses).ok_or(Unsuitable::Undetermined)?;
    islands
        .iter()
        .map(|island| {
            let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
                island.bodies.iter().flat_map(|&b| from[b].unwrap_or_default()).collect()
            };
            let node = poses.iter().zip(&accelerations).flat_map(|(p, a)| [pick(&p.q), pick(&p.v), pick(a)]);
            let motion = IdealMotion::new(scene.life.period, island.coordinates(), node.flatten().collect());
            let share = motion.mismatch_at_the_ends();
            if share > REPEATS { Err(Unsuitable::NotPeriodic(share)) } else { Ok(motion) }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{ideal_cycle, islands};
    use common::scene::SceneSource;

    /// sin(omega t) + 2 turns per cycle in three coordinates of one body.
    fn wave(intervals: usize) -> IdealMotion {
        let w = TAU / 0.25;
        let node = (0..=intervals).flat_map(|k| {
            let t = 0.25 * k as f64 / intervals as f64;
            let (s, c) = (w * t).sin_cos();
            [s, 2.0 * c, w * t, w * c, -2.0 * w * s, w, -w * w * s, -2.0 * w * w * c, 0.0]
        });
        IdealMotion::new(0.25, 3, node.collect())
    }

    #[test]
    fn acceleration_converges_with_fourth_order() {
        let error = |intervals: usize| {
            let (motion, w) = (wave(intervals), TAU / 0.25);
            let (mut q, mut v, mut a) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            (0..200)
                .map(|k| {
                    let t = -0.1 + 0.35 * (f64::from(k) + 0.3) / 200.0;
                    motion.evaluate(t, &mut q, &mut v, &mut a);
                    (a[0] / (w * w) + (w * t).sin()).abs()
                })
                .fold(0.0, f64::max)
        };
        let order = (error(24) / error(48)).log2();
        assert!((order - 4.0).abs() < 0.2, "order {order}");
        assert!(error(180) < 1e-6);
    }

    #[test]
    fn velocity_is_the_rate_of_the_position_across_intervals_and_cycles() {
        let motion = wave(12);
        let position_and_velocity = |t: f64| {
            let (mut q, mut v, mut a) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            motion.evaluate(t, &mut q, &mut v, &mut a);
            (q, v)
        };
        for k in 0..45 {
            let (t, h) = (-0.2 + 0.0107 * f64::from(k), 1e-7);
            let ((low, _), (_, v), (high, _)) =
                (position_and_velocity(t - h), position_and_velocity(t), position_and_velocity(t + h));
            for i in 0..3 {
                assert!(((high[i] - low[i]) / (2.0 * h) - v[i]).abs() < 1e-5 * 50.0, "{t}");
            }
        }
        assert!(motion.mismatch_at_the_ends() < 1e-12, "a whole turn is no gap");
        for seam in [0.0, 0.25] {
            let [(before, _), (after, _)] = [-1e-9, 1e-9].map(|h| position_and_velocity(seam + h));
            assert!(
                (before[2] - after[2]).abs() < 1e-6,
                "issue: angles fell back by a turn where a cycle ends"
            );
        }
    }

    #[test]
    fn a_motion_repeats_itself_unless_it_ends_elsewhere() {
        // A body that stands still but for rounding, and one that ends with another speed.
        let mut still = vec![0.02, -0.01, 0.0, 1e-17, 0.0, 0.0, 0.0, 1e-14, 1e-15];
        still.extend([0.02, -0.01, 0.0, 0.0, 1e-17, 1e-17, 1e-14, 0.0, 0.0]);
        let mut faster = still.clone();
        faster[9 + 4] = 1e-5;
        assert!(IdealMotion::new(0.25, 3, still).mismatch_at_the_ends() < 1e-12);
        let found = IdealMotion::new(0.25, 3, faster).mismatch_at_the_ends();
        assert!((found - 1e-5 / (0.02 * TAU / 0.25)).abs() < 1e-9, "{found}");
        assert!(found > REPEATS);
    }

    #[test]
    fn scenes_that_cannot_be_followed_are_named() {
        let four_bar = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let motions = |scene: &Scene, poses_of: &Scene| {
            let poses = ideal_cycle(poses_of, 37, &mut 0).expect("the linkage closes");
            let all = islands(&four_bar).expect("clearance joints only");
            ideal_motions(scene, &all.iter().collect::<Vec<_>>(), &poses)
        };
        assert!(motions(&four_bar, &four_bar).is_ok_and(|m| m.len() == 1 && m[0].n == 6));
        let mut ideal = four_bar.clone();
        ideal.joints[1].kind = JointKind::Revolute;
        assert_eq!(motions(&ideal, &four_bar), Err(Unsuitable::IdealJoint("coupler".into())));
        let mut open = four_bar.clone();
        open.joints.pop();
        assert_eq!(motions(&open, &four_bar), Err(Unsuitable::Undetermined));
        let mut cut = four_bar.clone();
        cut.life.period *= 0.9;
        assert!(matches!(motions(&cut, &cut), Err(Unsuitable::NotPeriodic(share)) if share > 0.1));
    }
}
