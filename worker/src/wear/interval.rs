//! The interval of a contact history that has not ended yet, of one joint or of one joint per lane.
//!
//! An interval is averaged with the work density of Archard's law F_N |v_t| [W] as weight. It ends after a given duration, and where the
//! contact has turned by more than [`LARGEST_TURN`]: a cycle of many turns, or of impacts, is cut into as many intervals as it needs.
//! The same holds for a journal that wears and turns in its bushing.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is proportional to the work F S. The averaging is chosen here.
//!
//! # Contact histories
//! Contact history of one joint over a simulated cycle, averaged over short intervals.
//!
//! Each interval is a [`ContactSample`]: eccentricity, penetration and normal force averaged with the weight
//! F_N |v_t|, the work density of Archard's law [W], and the work F S = integral of F_N |v_t| dt [N m].
//! Instants without sliding contact have no weight.
//!
//! Source:
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is proportional to the work F S. The averaging is chosen
//! here.

use crate::contact::JointForce;
use crate::lanes::{Real, lanewise};
use crate::plane::fused_dot as dot;

/// Cosine of the largest angle by which the contact may turn within an interval, 1.25 deg: an eighth of the spacing of 36 control points.
const LARGEST_TURN: f64 = 0.999_762;
/// Largest angle by which a journal that wears may turn in its bushing over an interval, 1.25 deg as well [rad].
const LARGEST_ANGLE: f64 = 0.021_817;

/// A short interval of the cycle, averaged with the work density F_N |v_t| as weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSample {
    /// Eccentricity in the bushing's frame `(2,)` [m].
    pub e: [f64; 2],
    /// Penetration delta [m].
    pub penetration: f64,
    /// Normal force, pointing from the journal into the bushing `(2,)` [N].
    pub force: [f64; 2],
    /// Integral of F_N |v_t| dt over the interval [N m].
    pub work: f64,
    /// Angle of the journal's body minus that of the bushing's [rad].
    pub turn: f64,
}

/// A contact at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactInstant<R = f64> {
    /// Work density F_N |v_t| [W].
    density: R,
    /// Eccentricity in the bushing's frame `(2,)` [m].
    pub(crate) e: [R; 2],
    /// Penetration delta [m].
    penetration: R,
    /// Normal force F_N [N].
    normal: R,
    /// Direction in which the journal presses on the bushing `(2,)` [1].
    direction: [R; 2],
    /// Angle of the journal's body minus that of the bushing's [rad].
    pub(crate) turn: R,
}

lanewise!(numbers ContactInstant { density, e, penetration, normal, direction, turn });

impl<R: Real> ContactInstant<R> {
    /// The contact of a joint with eccentricity `e` `(2,)` [m].
    #[inline(always)]
    pub(crate) fn new(e: [R; 2], contact: &JointForce<R>) -> Self {
        let JointForce { penetration, normal, direction, sliding, .. } = *contact;
        let turn = normal.zero();
        ContactInstant { density: normal * sliding.abs(), e, penetration, normal, direction, turn }
    }

    /// The instant with the journal's body turned by `turn` from the bushing's [rad].
    #[inline(always)]
    pub(crate) fn turned(self, turn: R) -> Self {
        ContactInstant { turn, ..self }
    }
}

impl ContactInstant {
    /// Normal force on the bushing, in its frame `(2,)` [N].
    pub(crate) fn force(&self) -> [f64; 2] {
        self.direction.map(|u| self.normal * u)
    }

    /// Size of the sliding speed, zero in free flight [m/s].
    pub(crate) fn sliding(&self) -> f64 {
        if self.normal > 0.0 { self.density / self.normal } else { 0.0 }
    }
}

/// Sums over the instants of an interval so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval<R = f64> {
    /// Duration after which it ends [s].
    longest: R,
    /// Duration so far [s].
    elapsed: R,
    /// Work so far [N m].
    work: R,
    /// Integrals of eccentricity, penetration and normal force over the work.
    e: [R; 2],
    penetration: R,
    force: [R; 2],
    /// Direction of the contact where the first work was done `(2,)` [1].
    first_direction: [R; 2],
    /// Angle by which the journal may turn in the bushing [rad], and that angle where the first work was done.
    largest_turn: R,
    first_turn: R,
    /// Integral over the work of the angle since then.
    turn: R,
}

lanewise!(numbers Interval {
    longest,
    elapsed,
    work,
    e,
    penetration,
    force,
    first_direction,
    largest_turn,
    first_turn,
    turn
});

impl Interval {
    /// An empty interval that ends after `longest` [s], and if the journal `wears` also where that has turned.
    pub(crate) fn new(longest: f64, wears: bool) -> Self {
        Interval {
            longest,
            elapsed: 0.0,
            work: 0.0,
            e: [0.0; 2],
            penetration: 0.0,
            force: [0.0; 2],
            first_direction: [0.0; 2],
            largest_turn: if wears { LARGEST_ANGLE } else { f64::INFINITY },
            first_turn: 0.0,
            turn: 0.0,
        }
    }
}

impl<R: Real> Interval<R> {
    /// Adds an instant with weight `duration` [s]; `ended` receives the intervals that end, with their lanes.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        duration: R,
        at: &ContactInstant<R>,
        ended: &mut dyn FnMut(usize, ContactSample),
    ) {
        let zero = duration.zero();
        let one = zero.like(1.0);
        let ContactInstant { density, e, penetration, normal, direction, turn } = *at;
        let work = density * duration;
        let works = zero.below(work);
        let swept = self.largest_turn.below((turn - self.first_turn).abs());
        let cosine = R::select(swept, zero, dot(direction, self.first_direction));
        let turned = cosine.below(zero.like(LARGEST_TURN));
        let turned = R::both(works, R::both(zero.below(self.work), turned));
        if R::any(turned) {
            self.end_lanes(R::select(turned, one, zero), ended);
        }
        let begun = zero.below(self.work);
        let weight = R::select(works, work, zero);
        let pressed = weight * normal;
        for k in 0..2 {
            let first = R::select(begun, self.first_direction[k], direction[k]);
            self.first_direction[k] = R::select(works, first, self.first_direction[k]);
            // In lanes without work nothing is added, even where a factor is not a number.
            self.e[k] = R::select(works, self.e[k].plus_product(weight, e[k]), self.e[k]);
            self.force[k] =
                R::select(works, self.force[k].plus_product(pressed, direction[k]), self.force[k]);
        }
        self.penetration =
            R::select(works, self.penetration.plus_product(weight, penetration), self.penetration);
        self.first_turn = R::select(works, R::select(begun, self.first_turn, turn), self.first_turn);
        self.turn = R::select(works, self.turn.plus_product(weight, turn - self.first_turn), self.turn);
        self.work += weight;
        self.elapsed += duration;
        let over = R::select(self.elapsed.below(self.longest), zero, one);
        if R::any(zero.below(over)) {
            self.end_lanes(over, ended);
        }
    }

    /// Ends the interval in the lanes where `which` is one.
    #[inline(never)]
    fn end_lanes(&mut self, which: R, ended: &mut dyn FnMut(usize, ContactSample)) {
        for lane in (0..R::LANES).filter(|lane| which.lane(*lane) > 0.0) {
            if let Some(sample) = self.end(lane) {
                ended(lane, sample);
            }
        }
    }

    /// Ends the interval in one lane; its averages, unless it is without work.
    pub(crate) fn end(&mut self, lane: usize) -> Option<ContactSample> {
        let work = self.work.lane(lane);
        let average = |sum: &mut R| {
            let average = sum.lane(lane) / work;
            sum.set_lane(lane, 0.0);
            average
        };
        let sample = ContactSample {
            e: self.e.each_mut().map(average),
            penetration: average(&mut self.penetration),
            force: self.force.each_mut().map(average),
            work,
            turn: average(&mut self.turn) + self.first_turn.lane(lane),
        };
        self.work.set_lane(lane, 0.0);
        self.elapsed.set_lane(lane, 0.0);
        (work > 0.0).then_some(sample)
    }
}

/// Contact history of one joint over one cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactHistory {
    /// Samples of the intervals with contact, in order of time.
    pub samples: Vec<ContactSample>,
    /// The interval that has not ended yet.
    pub interval: Interval,
    empty: Interval,
}

impl ContactHistory {
    /// An empty history that cuts a cycle of `period` [s] into about `samples` intervals, and also where the place on the journal has
    /// turned if the journal `wears`.
    pub(crate) fn new(period: f64, samples: usize, wears: bool) -> Self {
        let empty = Interval::new(period / samples as f64, wears);
        ContactHistory { samples: Vec::with_capacity(2 * samples), interval: empty, empty }
    }

    /// Removes all samples, for a new cycle.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
        self.interval = self.empty;
    }

    /// Adds an instant with weight `duration` [s].
    pub(crate) fn push(&mut self, duration: f64, at: &ContactInstant) {
        let samples = &mut self.samples;
        self.interval.push(duration, at, &mut |_, sample| samples.push(sample));
    }

    /// Ends the current interval; to be called at the end of the cycle.
    pub(crate) fn close_interval(&mut self) {
        self.samples.extend(self.interval.end(0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A contact pressed by 2 N in this direction [deg], sliding at 3 m/s.
    fn pressed(degrees: f64, penetration: f64) -> ContactInstant {
        let direction = [degrees.to_radians().cos(), degrees.to_radians().sin()];
        let contact =
            JointForce { normal: 2.0, sliding: -3.0, direction, penetration, ..JointForce::default() };
        ContactInstant::new([1e-5 * direction[0], 1e-5 * direction[1]], &contact)
    }

    fn ended(interval: &mut Interval, instants: &[(f64, ContactInstant)]) -> Vec<ContactSample> {
        let mut samples = vec![];
        for (duration, at) in instants {
            interval.push(*duration, at, &mut |_, sample| samples.push(sample));
        }
        samples
    }

    #[test]
    fn an_interval_is_averaged_by_its_work() {
        let mut interval = Interval::new(4.0, false);
        // Free flight counts for the duration only, also where the contact has no direction.
        let free = ContactInstant { e: [f64::NAN; 2], ..ContactInstant::default() };
        let found =
            ended(&mut interval, &[(1.0, pressed(0.0, 1e-6)), (1.0, free), (2.0, pressed(0.5, 4e-6))]);
        assert_eq!(found.len(), 1);
        let ContactSample { e, penetration, force, work, .. } = found[0];
        assert!((work - 18.0).abs() < 1e-12 && (penetration - 3e-6).abs() < 1e-18, "{found:?}");
        let (direction, middle) = (e[1].atan2(e[0]).to_degrees(), force[1].atan2(force[0]).to_degrees());
        assert!((direction - 1.0 / 3.0).abs() < 1e-4 && (middle - direction).abs() < 1e-12);
        assert!((force[0] - 2.0).abs() < 1e-4);
        assert_eq!(interval.end(0), None);
    }

    #[test]
    fn an_interval_ends_where_the_contact_has_turned() {
        let mut interval = Interval::new(100.0, false);
        let turning: Vec<_> = (0..10).map(|k| (1.0, pressed(0.5 * f64::from(k), 1e-6))).collect();
        // Each holds 0, 0.5 and 1 degree from its first contact; the last one has not ended yet.
        let found = ended(&mut interval, &turning);
        assert_eq!(found.iter().map(|sample| sample.work).collect::<Vec<_>>(), [18.0; 3]);
        assert_eq!(interval.end(0).map(|sample| sample.work), Some(6.0));
    }

    #[test]
    fn an_interval_ends_where_a_journal_that_wears_has_turned() {
        let turning = |k: u32| (1.0, pressed(0.0, 1e-6).turned(TAU + 0.5_f64.to_radians() * f64::from(k)));
        let turning: Vec<_> = (0..10).map(turning).collect();
        let mut round = Interval::new(100.0, false);
        assert!(ended(&mut round, &turning).is_empty());
        let mut wearing = Interval::new(100.0, true);
        let found = ended(&mut wearing, &turning);
        assert_eq!(found.iter().map(|sample| sample.work).collect::<Vec<_>>(), [18.0; 3]);
        for (k, sample) in found.iter().enumerate() {
            let middle = TAU + (1.5 * k as f64 + 0.5).to_radians();
            assert!((sample.turn - middle).abs() < 1e-12, "{sample:?}");
        }
    }
}
