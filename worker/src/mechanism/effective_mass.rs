//! Mass with which an island resists an impulse between journal and bushing of a joint with clearance.
//!
//! An impulse of size 1 along the unit vector n on the journal's centre, and its opposite on the bushing's, changes the velocities by
//! M^-1 (W + reactions), with the generalised impulse W = (n, a x n) of either body, its arm a [m] from the reference point to the
//! centre, and the reactions of the island's ideal joints. The speed of the journal against the bushing along n changes by
//!
//!   1 / m_eff = W . M^-1 (W + reactions)                                    [1/kg].
//!
//! Without ideal joints 1/m_eff is the sum of 1/m + (a x n)^2 / I over the two bodies. Prescribed bodies do not move. Other contacts,
//! which yield, do not react.
//!
//! # Source
//! Effective mass of a collision: Gilardi, Sharf (2002), Literature survey of contact dynamics modelling, Mechanism and Machine Theory
//! 37, 1213-1239, section 3.
//!
//! # Corners of sliders
//! Corners of a slider in its guide: where impacts of the slider are counted, and the mass behind them.
//!
//! A slider whose faces are flat touches with a corner before anything else. With the overlap g [m] of a corner and its gradient G `(6,)` to the coordinates of
//! both bodies (`guide.rs`), the corner approaches at dg/dt = G dq/dt [m/s], and the mass that resists an impulse along G is that
//! above with W = G. On worn faces the overlap is less by both depths; their slopes, small against one, are left out of G.
//!
//! Source:
//! As `guide.rs`.
//!
//! # Guide onset
//! Contacts of guides that begin within a time step: the part of its error that the estimate of the scheme cannot see.
//!
//! The scheme evaluates the force at the shares 0, 0.462 and 0.880 of a step (`integrate/rosenbrock.rs`). A pad that begins to touch after the
//! last of them, or shortly before it, is within the step without a force that anything measures: the step has the error estimate of free flight,
//! and the pad enters elastic energy for which no work was done. The velocity that the bodies miss is estimated by the impulse of the pad since it began
//! to touch. With the overlap g [m] and its rate at the end of the step of length h [s], the force P [N] there and its gradient G_k to a
//! coordinate of the mass m_k,
//!
//!   dv_k = P |G_k| min(h, g / (dg/dt)) / (2 m_k) [m/s, rad/s],
//!
//! summed over the pads that touch at the end and did not at the start. It counts as an error of the step. Under a force that grows evenly this is the
//! impulse itself; it is 3/4 of it for a pad that begins from rest under a constant acceleration. What ideal joints couple is left out.

use super::frame::Placed;
use super::guide::{Guiding, gradient};
use super::joint::PairMotion;
use super::piecewise_cubic::Jet;
use super::{Constraint, Frame, Guide, Island, TimedState, WearingGuide};
use crate::contact::{GuideReaction, PADS};
use crate::lanes::Real;
use crate::plane::{dot, fused_cross as cross};

impl Island {
    /// Velocity of the journal's centre of a joint with clearance against the bushing's, in the bushing's frame, in the state `at` `(2,)` [m/s].
    pub(crate) fn relative_velocity(&self, joint: usize, at: TimedState) -> [f64; 2] {
        let [i, j] = self.joints[joint].ends;
        let frame = |index: usize| self.frame_at(index, at);
        PairMotion::new([i, j], &frame(i.frame), &frame(j.frame)).motion.w
    }

    /// Effective mass of a joint with clearance along `direction`, a unit vector in the bushing's frame `(2,)`, in the state `at` [kg]; zero if neither body can move, or if the constraints of the ideal joints are dependent there.
    pub(crate) fn effective_mass(&self, joint: usize, direction: [f64; 2], at: TimedState) -> f64 {
        let ends = self.joints[joint].ends;
        let bushing = self.frame_at(ends[1].frame, at);
        let normal = bushing.turn(direction);
        let mut impulse = vec![0.0; self.coordinates()];
        for (end, sign) in ends.into_iter().zip([1.0, -1.0]) {
            if end.frame < self.bodies.len() {
                let arm = self.frame_at(end.frame, at).turn(end.arm);
                let k = 3 * end.frame;
                impulse[k] += sign * normal[0];
                impulse[k + 1] += sign * normal[1];
                impulse[k + 2] += sign * cross(arm, normal);
            }
        }
        self.mass_against(&impulse, at)
    }

    /// Effective mass against the generalised impulse W = `impulse` `(n,)` in the state `at` [kg], zero as above.
    pub(super) fn mass_against(&self, impulse: &[f64], at: TimedState) -> f64 {
        let Some(change) = self.with_reactions(impulse, at) else { return 0.0 };
        let flexibility: f64 = impulse.iter().zip(&change).zip(&self.mass).map(|((w, c), m)| w * c / m).sum();
        if flexibility > 0.0 { 1.0 / flexibility } else { 0.0 }
    }

    /// A generalised impulse with the reactions of the ideal joints to it `(n,)`; `None` if their constraints are dependent.
    fn with_reactions(&self, impulse: &[f64], at: TimedState) -> Option<Vec<f64>> {
        if self.ideal.rows == 0 {
            return Some(impulse.to_vec());
        }
        // At rest, reactions to anything but the impulse vanish.
        let (t, q, v) = at;
        let still = vec![0.0; v.len()];
        let count = self.bodies.len() + self.touched.len();
        let mut frames: Vec<Frame> = (0..count).map(|index| self.frame_at(index, (t, q, &still))).collect();
        frames.iter_mut().for_each(|frame| frame.omega = 0.0);
        let jets: Vec<Jet> = self.prescribed.iter().map(|motion| [motion.angle(t), 0.0, 0.0, 0.0]).collect();
        let mut change = impulse.to_vec();
        let placed = Placed { frames: &frames, jets: &jets };
        let mut ideal = self.ideal.clone();
        ideal.update_inputs(t, &frames);
        ideal.constraints.iter_mut().for_each(Constraint::stop);
        let [independent, _] = ideal.add_reactions(placed, &mut change);
        (independent > 0.0).then_some(change)
    }

    /// Frame of a body of the island in a state.
    pub(super) fn frame_at(&self, index: usize, (t, q, v): TimedState) -> Frame {
        match index.checked_sub(self.bodies.len()) {
            None => Frame::free(&q[3 * index..3 * index + 3], &v[3 * index..3 * index + 3]),
            Some(prescribed) => self.prescribed[prescribed].frame(t),
        }
    }
}

/// A corner of a slider at one instant: overlap with the face of the guide, negative in free flight [m], its rate [m/s], and the gradient of the overlap
/// to the coordinates of the slider's body, then of the guide's `(6,)` [1, m].
type Corner = (f64, f64, [f64; 6]);

impl Island {
    /// Corners of the slider of guide number `guide` in the state `at`: the two of the left face, then those of the right `(4,)`.
    pub(crate) fn guide_corners(&self, guide: usize, at: TimedState) -> [Corner; PADS] {
        let guide = &self.guides[guide];
        let [slider, rail] = guide.flat.ends.map(|end| self.frame_at(end.frame, at));
        guide.corners([&slider, &rail])
    }

    /// Effective mass of guide number `guide` against an impulse along `gradient` `(6,)` in the state `at` [kg]; zero if neither
    /// body can move, or if the constraints of the ideal joints are dependent there.
    pub(crate) fn guide_mass(&self, guide: usize, gradient: [f64; 6], at: TimedState) -> f64 {
        let mut impulse = vec![0.0; self.coordinates()];
        for (end, part) in self.guides[guide].flat.ends.iter().zip(gradient.chunks(3)) {
            if end.frame < self.bodies.len() {
                impulse[3 * end.frame..].iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
            }
        }
        self.mass_against(&impulse, at)
    }
}

impl WearingGuide {
    /// Corners of the slider with the bodies of slider and guide in `frames`.
    fn corners(&self, frames: [&Frame; 2]) -> [Corner; PADS] {
        let Guide { axis, ends, .. } = &self.flat;
        let t = frames[1].turn(*axis);
        let base = dot(*axis, ends[1].arm);
        std::array::from_fn(|corner| {
            let (face, last) = (corner / 2, corner % 2 == 1);
            let (n, points) = self.flat.face(face, t, frames);
            let at = &points[if last { 2 } else { 0 }];
            let (depth, slope) = self.corner_depth(face, last, dot(t, at.d) - base);
            (at.overlap - depth, at.rate - slope * at.sliding, gradient(n, at.a, at.d))
        })
    }
}

/// Largest velocity missing after a step of length `h` [s], over its scale [1]; the bodies are in `frames` at its end, and the guides did
/// `before` at its start. `mass` `(n,)` [kg, kg m^2] and `per_velocity` [s/m, s/rad] belong to the coordinates of the free bodies.
#[inline(always)]
pub(super) fn begun<R: Real>(
    guides: &[impl Guiding<R>],
    frames: &[Frame<R>],
    before: &[GuideReaction<R>],
    h: R,
    mass: &[R],
    per_velocity: impl Fn(usize) -> R,
) -> R {
    let mut worst = h.zero();
    for (guide, before) in guides.iter().zip(before) {
        let impulse = guide.begun(frames, before, h);
        for (side, end) in guide.ends().iter().enumerate().filter(|(_, end)| 3 * end.frame < mass.len()) {
            for k in 0..3 {
                let row = 3 * end.frame + k;
                worst = worst.larger(impulse[3 * side + k] / mass[row] * per_velocity(row));
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use crate::mechanism::{ideal_cycle, islands};
    use common::scene::SceneSource;

    #[test]
    fn the_piston_pin_resists_with_the_slider_along_and_the_rod_across() {
        // Stretched: the rod turns about the crank's pin, so that its end moves across alone; the guide holds the slider across.
        let scene = SceneSource::builtin("slider-crank").expect("built in").nominal().clone();
        let pose = ideal_cycle(&scene, 2, &mut 0).expect("it closes").swap_remove(0);
        let [island] = &islands(&scene).expect("one island")[..] else { panic!("one island") };
        let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
            island.bodies.iter().flat_map(|&b| from[b].expect("free")).collect()
        };
        let (q, v) = (pick(&pose.q), pick(&pose.v));
        let mass = |direction| island.effective_mass(0, direction, (0.0, &q, &v));
        assert!((mass([1.0, 0.0]) - 0.14).abs() < 1e-9, "{}", mass([1.0, 0.0]));
        let across = (2.5e-5 + 0.21 * 0.06 * 0.06) / (0.12 * 0.12);
        assert!((mass([0.0, 1.0]) - across).abs() < 1e-9, "{} {across}", mass([0.0, 1.0]));
        // At 5000 r/min the crank's pin moves across, and with it the rod; the slider stands.
        let w = island.relative_velocity(0, (0.0, &q, &v));
        assert!(w.iter().all(|w| w.abs() < 1e-9), "{w:?}");
    }

    #[test]
    fn bodies_without_ideal_joints_resist_with_mass_and_inertia() {
        let scene = SceneSource::builtin("four-bar").expect("built in").nominal().clone();
        let pose = ideal_cycle(&scene, 2, &mut 0).expect("it closes").swap_remove(0);
        let all = islands(&scene).expect("clearance joints only");
        for island in &all {
            let q: Vec<f64> = island.bodies.iter().flat_map(|&b| pose.q[b].expect("free")).collect();
            let v = vec![0.0; q.len()];
            for joint in 0..island.joints.len() {
                let [a, b] =
                    [0.3_f64, 0.3 + std::f64::consts::FRAC_PI_2].map(|angle| [angle.cos(), angle.sin()]);
                // The sum over two directions does not depend on them: sum of 2/m + |a|^2 / I.
                let found: f64 =
                    [a, b].map(|n| 1.0 / island.effective_mass(joint, n, (0.0, &q, &v))).iter().sum();
                let free =
                    island.joints[joint].ends.into_iter().filter(|end| end.frame < island.bodies.len());
                let expected: f64 = free
                    .map(|end| {
                        let [m, _, i] = [0, 1, 2].map(|k| island.mass[3 * end.frame + k]);
                        2.0 / m + (end.arm[0].powi(2) + end.arm[1].powi(2)) / i
                    })
                    .sum();
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
            }
        }
    }
}
