//! Change points of a mechanism whose drives determine its motion: positions in which its ideal joints are dependent although the joints can
//! be closed beyond, as in a parallelogram whose bars are in line.
//!
//! The share of a row of dphi/dq normal to the rows before it vanishes there, linearly in time on every branch. The smallest share is observed
//! at the times of the continuation; where it is small and has a minimum in between, the minimum is sought by sections.
//!
//! # Source
//! Change points of four-bar linkages: Norton (2020), Design of Machinery, section 2.12. Golden sections: Kiefer (1953), Proc. Amer. Math.
//! Soc. 4, 502-506.

use super::closure::Closure;
use nalgebra::DVector;

/// Smallest share at a time of the continuation below which a minimum is sought: two degrees of a crank beside a change point leave some 0.03 [1].
const SOUGHT: f64 = 0.3;
/// Share that counts as zero: lengths right to ten digits leave 1e-5 [1].
const ZERO: f64 = 1e-5;
/// Sections of an interval, down to rounding.
const SECTIONS: usize = 60;
/// Time beyond a position at which the motion ends, over the cycle, at which the joints can be closed if it is a change point [1].
const BEYOND: f64 = 1e-4;
/// Largest motion over that time, over the size of the mechanism [1].
const NEARBY: f64 = 0.05;

/// Time at which the motion ends, and index of the joint that could not be closed, or that depends on others.
pub(super) struct Stop {
    pub(super) time: f64,
    pub(super) joint: usize,
}

/// A position of the continuation with its smallest share.
struct Position {
    time: f64,
    q: DVector<f64>,
    share: f64,
}

/// Looks for change points between the times of the continuation.
pub(super) struct ChangePoints<'c> {
    closure: &'c Closure<'c>,
    /// The last two positions.
    before: Option<Position>,
    last: Position,
}

impl<'c> ChangePoints<'c> {
    /// From the start `q` on.
    pub(super) fn new(closure: &'c Closure<'c>, q: &DVector<f64>) -> Self {
        let last = Position { time: 0.0, q: q.clone(), share: closure.independence(0.0, q).1 };
        ChangePoints { closure, before: None, last }
    }

    /// A change point before the next position `q` of the continuation, at `time` [s].
    pub(super) fn passed(&mut self, time: f64, q: &DVector<f64>) -> Option<Stop> {
        let next = Position { time, q: q.clone(), share: self.closure.independence(time, q).1 };
        let last = std::mem::replace(&mut self.last, next);
        let rises = last.share < self.last.share && last.share < SOUGHT;
        let falls = |before: &Position| last.share <= before.share;
        let found = match &self.before {
            Some(before) if rises && falls(before) => self.minimum(before, time),
            _ => None,
        };
        self.before = Some(last);
        found
    }

    /// Whether the position `q` at which the motion ends, at `time` [s], is a change point: the joints can be closed beyond it.
    pub(super) fn ahead(&self, time: f64, q: &DVector<f64>) -> Option<Stop> {
        let (joint, share) = self.closure.independence(time, q);
        let mut beyond = q.clone();
        let closes =
            self.closure.close(time + BEYOND * self.closure.scene.life.period, &mut beyond, &mut 0).is_ok();
        let is_near = self.closure.largest(&(&beyond - q)) < NEARBY * self.closure.size;
        (share < SOUGHT && closes && is_near).then_some(Stop { time, joint })
    }

    /// The smallest share between a position and a later time, if it is zero.
    fn minimum(&self, from: &Position, to: f64) -> Option<Stop> {
        let share = |t: f64| {
            let mut q = &from.q + self.closure.velocity(from.time, &from.q) * (t - from.time);
            match self.closure.close(t, &mut q, &mut 0) {
                Ok(()) => self.closure.independence(t, &q),
                Err(_) => (0, f64::INFINITY),
            }
        };
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let (mut low, mut high) = (from.time, to);
        let within = |low: f64, high: f64, part: f64| low + part * (high - low);
        for _ in 0..SECTIONS {
            let (a, b) = (within(low, high, 1.0 - GOLDEN), within(low, high, GOLDEN));
            if share(a).1 < share(b).1 { high = b } else { low = a }
        }
        let time = 0.5 * (low + high);
        let (joint, least) = share(time);
        (least < ZERO).then_some(Stop { time, joint })
    }
}
