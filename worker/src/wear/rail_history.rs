//! Contact history of a slider in its guide over a simulated cycle, averaged over short intervals.
//!
//! An interval is averaged with the power of sliding, the sum of P |ds/dt| over both faces [W], as weight. It holds the load that the two faces carry together: with
//! the normal forces N_l and N_r on the left and the right face, and their distances x from the slider's middle along the slider,
//!
//!   F = N_l - N_r [N],   M = sum of P x on the left face - sum of P x on the right one [N m],
//!
//! the sum N of all normal forces, the position s of the slider's middle along the guide [m] and the work = integral of sum of P |ds/dt| dt [N m]. Whatever wears, the motion
//! demands F and M; how the faces share them follows from their shape (`rail_equilibrium.rs`).
//!
//! An interval ends after a given duration, where another half of a face begins or ceases to touch, where the slider has moved by a quarter
//! of the distance of the control points, and where F / N or M / (N l / 2) has changed by more than [`LARGEST_CHANGE`], N = N_l + N_r.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is proportional to the work. The averaging is chosen here.

use crate::contact::{GuideReaction, PADS};
use crate::rail::RailLayout;

/// Largest change of F / N and of M / (N l / 2) within an interval [1].
const LARGEST_CHANGE: f64 = 1.0 / 32.0;
/// Largest movement of the slider within an interval, over the distance of the control points [1].
const LARGEST_MOVE: f64 = 0.25;

/// A short interval of the cycle, averaged with the power of sliding as weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RailSample {
    /// Force F on the guide's left face less that on its right face [N].
    pub force: f64,
    /// Moment M of these forces about the slider's middle [N m].
    pub moment: f64,
    /// Position of that middle along the guide [m].
    pub position: f64,
    /// Sum N of the normal forces on both faces [N].
    pub normal: f64,
    /// Integral of the sum of P |ds/dt| [N m].
    pub work: f64,
    /// Halves of faces that touch, one bit each.
    pub touching: u8,
}

/// A slider in its guide at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct RailInstant {
    /// Sum of P |ds/dt| [W], of P [N], F [N], M [N m] and s [m].
    power: f64,
    normal: f64,
    force: f64,
    moment: f64,
    position: f64,
    touching: u8,
}

impl RailInstant {
    /// What a guide that wears does.
    pub(crate) fn new(now: &GuideReaction) -> Self {
        let touches = |pad: usize| u8::from(now.penetration[pad] > 0.0) << pad;
        RailInstant {
            power: now.rubbing[0] + now.rubbing[1],
            normal: now.normal[0] + now.normal[1],
            force: now.normal[0] - now.normal[1],
            moment: now.moment[0] - now.moment[1],
            position: now.position,
            touching: (0..PADS).map(touches).sum(),
        }
    }

    /// A slider of this half length [m] that carries the force F and the moment M `(2,)` [N, N m] with a sum N of the normal forces [N], at the position s
    /// [m], with the sliding `speed` [m/s]: its corners touch as those of an ideal one, F +- M / (l / 2) over two.
    pub(crate) fn of_load(
        [force, moment]: [f64; 2],
        normal: f64,
        half_length: f64,
        [position, speed]: [f64; 2],
    ) -> Self {
        let corner = |half: usize, load: f64| {
            let face = usize::from(load < 0.0);
            u8::from(load != 0.0) << (2 * face + half)
        };
        let couple = moment / half_length;
        let touching = corner(0, force - couple) | corner(1, force + couple);
        RailInstant { power: normal * speed.abs(), normal, force, moment, position, touching }
    }

    /// F / N and M / N [1, m]; zero in free flight.
    fn place(&self) -> [f64; 2] {
        if self.normal > 0.0 { [self.force / self.normal, self.moment / self.normal] } else { [0.0; 2] }
    }
}

/// Sums over the instants of an interval so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct RailInterval {
    /// Duration [s], work [N m], and the integrals of N, F, M and s over the work.
    elapsed: f64,
    work: f64,
    normal: f64,
    force: f64,
    moment: f64,
    position: f64,
    /// The instant at which the first work was done.
    first: RailInstant,
}

impl RailInterval {
    /// Its averages, unless it is without work; the interval begins anew.
    fn end(&mut self) -> Option<RailSample> {
        let RailInterval { work, normal, force, moment, position, first, .. } = std::mem::take(self);
        (work > 0.0).then(|| RailSample {
            force: force / work,
            moment: moment / work,
            position: position / work,
            normal: normal / work,
            work,
            touching: first.touching,
        })
    }
}

/// Contact history of one guide over one cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct RailHistory {
    /// Samples of the intervals with contact, in order of time.
    pub samples: Vec<RailSample>,
    /// The interval that has not ended yet.
    interval: RailInterval,
    /// Duration after which an interval ends [s], largest movement [m] and largest change of M / N [m] within one.
    longest: f64,
    largest_move: f64,
    largest_arm: f64,
}

impl RailHistory {
    /// An empty history that cuts a cycle of `period` [s] into about `samples` intervals.
    pub(crate) fn new(period: f64, samples: usize, layout: &RailLayout) -> Self {
        RailHistory {
            samples: Vec::with_capacity(2 * samples),
            interval: RailInterval::default(),
            longest: period / samples as f64,
            largest_move: LARGEST_MOVE * layout.spacing(),
            largest_arm: LARGEST_CHANGE * layout.half_length,
        }
    }

    /// Removes all samples, for a new cycle.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
        self.interval = RailInterval::default();
    }

    /// Adds an instant with weight `duration` [s].
    pub(crate) fn push(&mut self, duration: f64, at: &RailInstant) {
        let work = at.power * duration;
        if work > 0.0 {
            if self.interval.work > 0.0 && self.is_another_contact(at) {
                self.samples.extend(self.interval.end());
            }
            let interval = &mut self.interval;
            if interval.work == 0.0 {
                interval.first = *at;
            }
            interval.work += work;
            interval.normal += work * at.normal;
            interval.force += work * at.force;
            interval.moment += work * at.moment;
            interval.position += work * at.position;
        }
        self.interval.elapsed += duration;
        if self.interval.elapsed >= self.longest {
            self.samples.extend(self.interval.end());
        }
    }

    /// True if a contact is not that with which the present interval began.
    fn is_another_contact(&self, at: &RailInstant) -> bool {
        let first = &self.interval.first;
        let ([share, arm], [first_share, first_arm]) = (at.place(), first.place());
        at.touching != first.touching
            || (at.position - first.position).abs() > self.largest_move
            || (share - first_share).abs() > LARGEST_CHANGE
            || (arm - first_arm).abs() > self.largest_arm
    }

    /// Ends the current interval; to be called at the end of the cycle.
    pub(crate) fn close_interval(&mut self) {
        self.samples.extend(self.interval.end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout() -> RailLayout {
        let reach = [-0.1, 0.1];
        let (elements, half_length) = (4, 0.03);
        RailLayout {
            points: 21,
            reach,
            elements,
            half_length,
            width: 0.02,
            guide_wears: true,
            slider_wears: false,
        }
    }

    fn pressed(force: f64, arm: f64, position: f64, speed: f64) -> RailInstant {
        let normal: f64 = force.abs();
        let touching = if force > 0.0 { 1 } else { 4 };
        RailInstant { power: normal * speed, normal, force, moment: force * arm, position, touching }
    }

    #[test]
    fn an_interval_is_averaged_by_its_work_and_ends_with_its_contact() {
        let mut history = RailHistory::new(1.0, 1, &layout());
        let instants = [
            (0.1, pressed(2.0, 0.01, 0.0, 3.0)),
            (0.1, RailInstant::default()),
            (0.1, pressed(4.0, 0.01, 1e-3, 3.0)),
            // The other face, then a place further on, then another arm.
            (0.1, pressed(-4.0, 0.01, 1e-3, 1.0)),
            (0.1, pressed(-4.0, 0.01, 4e-3, 1.0)),
            (0.1, pressed(-4.0, 0.015, 4e-3, 1.0)),
        ];
        instants.iter().for_each(|(duration, at)| history.push(*duration, at));
        history.close_interval();
        let works: Vec<f64> = history.samples.iter().map(|sample| sample.work).collect();
        assert_eq!(works.len(), 4);
        for (work, expected) in works.iter().zip([1.8, 0.4, 0.4, 0.4]) {
            assert!((work - expected).abs() < 1e-14, "{works:?}");
        }
        let first = history.samples[0];
        assert!((first.force - 10.0 / 3.0).abs() < 1e-14 && (first.moment - 0.1 / 3.0).abs() < 1e-15);
        assert!(
            (first.position - 2e-3 / 3.0).abs() < 1e-18 && (works.iter().sum::<f64>() - 3.0).abs() < 1e-14
        );
    }
}
