//! One-sided contacts between two points or two angles: end stops and ropes.
//!
//! With the depth delta beyond the stop [m or rad], the force or torque
//!
//!   F = k delta max(0, 1 + D d delta/dt)     where delta > 0, else 0,
//!
//! k [N/m or N m/rad], D [s/m or s/rad]: continuous, and never of the other sign. The stored energy is k delta^2 / 2, the rest of its power
//! dissipated.
//!
//! # Source
//! Hunt, Crossley (1975), J. Appl. Mech. 42, 440-445, with the exponent 1.

use super::force::LoadForce;
use super::springs::on_line;
use crate::lanes::{Real, lanewise};
use crate::mechanism::frame::{End, Frame};

/// Force of a stop at this depth and its rate, with its derivatives to both.
#[inline(always)]
fn contact<R: Real>(stiffness: R, dissipation: R, depth: R, rate: R) -> [R; 3] {
    let nothing = depth.zero();
    let factor = depth.like(1.0) + dissipation * rate;
    let elastic = stiffness * depth;
    let acts = R::both(nothing.below(depth), nothing.below(factor));
    [elastic * factor, stiffness * factor, elastic * dissipation].map(|x| R::select(acts, x, nothing))
}

/// Energy in a stop at this depth, and the power that its `force` dissipates.
#[inline(always)]
fn energy<R: Real>(stiffness: R, depth: R, rate: R, force: R) -> [R; 2] {
    let depth = depth.larger(depth.zero());
    [stiffness * depth * depth * 0.5, (force - stiffness * depth) * rate]
}

/// End stop (side -1) or rope (side +1) between two points: the depth is side (l - length), l the distance of the points.
#[derive(Debug, Clone)]
pub struct LineStop<R = f64> {
    /// The two points.
    pub(super) ends: [End<R>; 2],
    /// Side of `length` on which it acts [1].
    pub(super) side: R,
    /// Distance at which contact begins [m].
    pub(super) length: R,
    /// Stiffness k [N/m].
    pub(super) stiffness: R,
    /// Dissipation D [s/m].
    pub(super) dissipation: R,
}

lanewise!(LineStop { ends, side, length, stiffness, dissipation });

impl<R: Real> LineStop<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, _t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let LineStop { ref ends, side, length, stiffness, dissipation } = *self;
        on_line(ends, frames, |l, rate| {
            let (depth, approach) = (side * (l - length), side * rate);
            let [force, per_length, per_rate] = contact(stiffness, dissipation, depth, approach);
            let [stored, lost] = energy(stiffness, depth, approach, force);
            [side * force, per_length, per_rate, stored, lost]
        })
    }
}

/// Stops of the angle phi of frame a against frame b: the depth is phi - upper, or lower - phi.
#[derive(Debug, Clone)]
pub struct AngleStop<R = f64> {
    /// Frames a and b.
    pub(super) frames: [usize; 2],
    /// Lower and upper angle `(2,)` [rad].
    pub(super) bounds: [R; 2],
    /// Stiffness k [N m/rad].
    pub(super) stiffness: R,
    /// Dissipation D [s/rad].
    pub(super) dissipation: R,
}

lanewise!(AngleStop { frames, bounds, stiffness, dissipation });

impl<R: Real> AngleStop<R> {
    /// The force at time `t` [s].
    #[inline(always)]
    pub(super) fn force(&self, t: R, frames: &[Frame<R>]) -> LoadForce<R> {
        let AngleStop { frames: [a, b], bounds: [lower, upper], stiffness, dissipation } = *self;
        let mut load = LoadForce::none([a, b], t);
        let phi = frames[a].angle - frames[b].angle;
        let rate = frames[a].omega - frames[b].omega;
        for (side, bound) in [(1.0, upper), (-1.0, lower)] {
            let (depth, approach) = ((phi - bound) * side, rate * side);
            let [torque, per_angle, per_rate] = contact(stiffness, dissipation, depth, approach);
            let [stored, lost] = energy(stiffness, depth, approach, torque);
            load.f[2] -= torque * side;
            load.f[5] += torque * side;
            for (r, c, sign) in [(2, 2, -1.0), (2, 5, 1.0), (5, 2, 1.0), (5, 5, -1.0)] {
                load.k[r][c] += per_angle * sign;
                load.d[r][c] += per_rate * sign;
            }
            load.stored += stored;
            load.lost += lost;
        }
        load
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const Q: [f64; 6] = [0.1, 0.2, 0.7, 0.02, -0.03, 2.0];
    const V: [f64; 6] = [1.0, -2.0, 30.0, 0.5, 0.7, -12.0];

    /// A load at coordinates and rates.
    type LoadAt = Box<dyn Fn(&[f64; 6], &[f64; 6]) -> LoadForce>;

    fn loads() -> Vec<LoadAt> {
        let frames =
            |q: &[f64; 6], v: &[f64; 6]| [Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])];
        let ends = [End { frame: 0, arm: [0.03, 0.02] }, End { frame: 1, arm: [-0.01, 0.05] }];
        let line = move |side, length| {
            let stop = LineStop { ends, side, length, stiffness: 300.0, dissipation: 0.2 };
            Box::new(move |q: &[f64; 6], v: &[f64; 6]| stop.force(0.0, &frames(q, v))) as LoadAt
        };
        let angle = move |bounds, dissipation| {
            let stop = AngleStop { frames: [0, 1], bounds, stiffness: 5.0, dissipation };
            Box::new(move |q: &[f64; 6], v: &[f64; 6]| stop.force(0.0, &frames(q, v))) as LoadAt
        };
        vec![line(1.0, 0.05), line(-1.0, 0.5), angle([-1.0, 1.0], 0.01), angle([-2.0, -1.5], 0.01)]
    }

    #[test]
    fn derivatives_and_power_agree_with_differences() {
        for load in loads() {
            let exact = load(&Q, &V);
            assert!(exact.stored > 0.0 && exact.f.iter().any(|f| *f != 0.0), "the stop acts");
            let h = 1e-6;
            for c in 0..6 {
                let shifted =
                    |x: &[f64; 6], h: f64| std::array::from_fn(|k| x[k] + if k == c { h } else { 0.0 });
                let (low, high) = (load(&shifted(&Q, -h), &V), load(&shifted(&Q, h), &V));
                let (slow, fast) = (load(&Q, &shifted(&V, -h)), load(&Q, &shifted(&V, h)));
                for r in 0..6 {
                    let (k, d) = ((high.f[r] - low.f[r]) / (2.0 * h), (fast.f[r] - slow.f[r]) / (2.0 * h));
                    assert!((exact.k[r][c] - k).abs() < 1e-3, "k {r} {c}: {} against {k}", exact.k[r][c]);
                    assert!((exact.d[r][c] - d).abs() < 1e-6, "d {r} {c}: {} against {d}", exact.d[r][c]);
                }
            }
            let power: f64 = exact.f.iter().zip(&V).map(|(f, v)| f * v).sum();
            let moved = |t: f64| load(&std::array::from_fn(|k| Q[k] + t * V[k]), &V).stored;
            let stored = (moved(h) - moved(-h)) / (2.0 * h);
            assert!(
                (power + stored + exact.lost).abs() < 1e-3,
                "{power} against {stored} and {}",
                exact.lost
            );
        }
    }

    #[test]
    fn a_stop_pushes_one_way_only() {
        let stop = AngleStop { frames: [0, 1], bounds: [-0.5, 0.5], stiffness: 5.0, dissipation: 0.1 };
        let torque = |angle: f64, speed: f64| {
            let frames = [Frame::free(&[0.0, 0.0, angle], &[0.0, 0.0, speed]), Frame::default()];
            stop.force(0.0, &frames).f[2]
        };
        assert_eq!([torque(0.4, 9.0), torque(-0.4, -9.0), torque(0.6, -20.0)], [0.0; 3]);
        assert!((torque(0.6, 2.0) + 0.6).abs() < 1e-12 && (torque(-0.6, -2.0) - 0.6).abs() < 1e-12);
    }
}
