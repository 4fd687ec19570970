//! Contact history of one joint over a simulated cycle, averaged over short intervals.
//!
//! Each interval is a [`ContactSample`]: eccentricity, penetration and normal force averaged with the weight
//! F_N |v_t|, the work density of Archard's law [W], and the work F S = integral of F_N |v_t| dt [N m].
//! Instants without sliding contact have no weight. An interval also ends where the contact has turned by more than [`LARGEST_TURN`]: a cycle
//! of many turns, or of impacts, is cut into as many intervals as it needs.
//!
//! # Source
//! Archard (1953), J. Appl. Phys. 24, 981-988: wear is proportional to the work F S. The averaging is chosen
//! here.

use crate::contact::JointForce;
use crate::plane::dot;

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
}

/// Cosine of the largest angle by which the contact may turn within an interval, 1.25 deg: an eighth of the spacing of 36 control points.
const LARGEST_TURN: f64 = 0.999_762;

/// Contact history of one joint over one cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactHistory {
    samples: Vec<ContactSample>,
    /// Duration of an interval [s].
    interval: f64,
    elapsed: f64,
    sum: ContactSample,
    /// Direction of the contact where the interval's first work was done `(2,)` [1].
    first_direction: [f64; 2],
}

const NOTHING: ContactSample = ContactSample { e: [0.0; 2], penetration: 0.0, force: [0.0; 2], work: 0.0 };

impl ContactHistory {
    /// An empty history that cuts a cycle of `period` [s] into about `samples` intervals.
    pub(crate) fn new(period: f64, samples: usize) -> Self {
        ContactHistory {
            samples: Vec::with_capacity(2 * samples),
            interval: period / samples as f64,
            elapsed: 0.0,
            sum: NOTHING,
            first_direction: [0.0; 2],
        }
    }

    /// Removes all samples, for a new cycle.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
        self.elapsed = 0.0;
        self.sum = NOTHING;
    }

    /// Adds an instant with eccentricity `e` `(2,)` [m] and weight `duration` [s].
    pub(crate) fn push(&mut self, duration: f64, e: [f64; 2], contact: &JointForce) {
        let JointForce { penetration, normal, direction, sliding, .. } = *contact;
        let work = normal * sliding.abs() * duration;
        if work > 0.0 {
            if self.sum.work > 0.0 && dot(direction, self.first_direction) < LARGEST_TURN {
                self.close_stretch();
            }
            if self.sum.work <= 0.0 {
                self.first_direction = direction;
            }
            self.sum.e[0] += work * e[0];
            self.sum.e[1] += work * e[1];
            self.sum.penetration += work * penetration;
            self.sum.force[0] += work * normal * direction[0];
            self.sum.force[1] += work * normal * direction[1];
            self.sum.work += work;
        }
        self.elapsed += duration;
        if self.elapsed >= self.interval {
            self.close_stretch();
        }
    }

    /// Ends the current interval; to be called at the end of the cycle.
    pub(crate) fn close_stretch(&mut self) {
        let s = self.sum;
        if s.work > 0.0 {
            self.samples.push(ContactSample {
                e: [s.e[0] / s.work, s.e[1] / s.work],
                penetration: s.penetration / s.work,
                force: [s.force[0] / s.work, s.force[1] / s.work],
                work: s.work,
            });
        }
        self.elapsed = 0.0;
        self.sum = NOTHING;
    }

    /// Appends the samples of a further cycle.
    pub(crate) fn append(&mut self, further: &ContactHistory) {
        self.samples.extend_from_slice(&further.samples);
    }

    /// Turns the history of several cycles into that of their mean: the same contacts, each with its share of the work.
    pub(crate) fn divide_work(&mut self, cycles: usize) {
        self.samples.iter_mut().for_each(|sample| sample.work /= cycles as f64);
    }

    /// Samples of the intervals with contact, in order of time.
    pub(crate) fn samples(&self) -> &[ContactSample] {
        &self.samples
    }
}
