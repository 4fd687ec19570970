//! The torque that a driven body needs, from the moments that joints and loads exert on it.
//!
//! With the moments M_k of the islands on the body and the moment M_e of the loads on it alone, a body of mass m [kg], inertia I
//! [kg m^2] about its centre of mass, and centre of mass c [m] from its axis needs the torque [N m]
//!
//!   T = (I + m |c|^2) alpha - m (c x g) - M_e - sum M_k,
//!
//! alpha [rad/s^2] being its angular acceleration and g [m/s^2] the gravity. The output is the largest |T| over the cycle.
//!
//! # Source
//! Balance of angular momentum about a fixed axis: Goldstein, Poole, Safko, Classical Mechanics (2002), chapter 5.

use super::{MomentTrack, RecordedCycle, sample_times};
use crate::mechanism::{Prescribed, external_moment};
use common::scene::{Motion, Scene};

/// The output `driving-torque` [N m] of a driven body of the scene.
pub(super) fn driving_torque(body: usize, cycle: &RecordedCycle) -> f64 {
    let own = own_torque(cycle.scene, body);
    own.map_or(0.0, |own| largest_torque(&cycle.moments(body), &sample_times(cycle.scene), own))
}

/// The torque [N m] over time that a driven body of the scene needs without the moments of the islands; `None` for another body.
pub(crate) fn own_torque(scene: &Scene, body: usize) -> Option<impl Fn(f64) -> f64> {
    let driven = &scene.bodies[body];
    let motion = Prescribed::from_body(driven)?;
    let outer = external_moment(scene, body);
    let Motion::Driven { inertia, .. } = &driven.motion else { return None };
    Some(move |t: f64| {
        let inertial = inertia.as_ref().map_or(0.0, |driven| {
            let [x, y] = driven.centre_of_mass;
            let inertial = (driven.inertia + driven.mass * (x * x + y * y)) * motion.jet(t)[2];
            if [x, y] == [0.0; 2] || scene.gravity == [0.0; 2] {
                return inertial;
            }
            let centre = motion.frame(t).turn([x, y]);
            let weight = driven.mass * (centre[0] * scene.gravity[1] - centre[1] * scene.gravity[0]);
            inertial - weight
        });
        inertial - outer(t)
    })
}

/// max over t of |own(t) - sum of the moments|, where `own` [N m] is the torque that the body needs without them. Evaluated at the
/// times of all moments and at `times` [s].
fn largest_torque(moments: &[&MomentTrack], times: &[f64], own: impl Fn(f64) -> f64) -> f64 {
    let known = moments.iter().flat_map(|m| &m.time);
    // A recording may begin after the start of the cycle.
    let start = moments.iter().filter_map(|m| m.time.first()).fold(f64::NEG_INFINITY, |a, &t| a.max(t));
    known.chain(times).filter(|&&t| t >= start).fold(0.0, |largest: f64, &t| {
        let moment: f64 = moments.iter().map(|m| m.moment_at(t)).sum();
        largest.max((own(t) - moment).abs())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_two_islands_add_up_at_the_times_of_both() {
        let track = |times: &[f64], f: fn(f64) -> f64| MomentTrack {
            time: times.to_vec(),
            values: [times.iter().map(|&t| f(t)).collect()],
        };
        let (a, b) = (track(&[0.0, 0.5, 1.0], |t| 2.0 * t), track(&[0.0, 0.3, 1.0], |t| 1.0 - t));
        // -(2 t + 1 - t) + 0.5 has its largest size at t = 1: 1.5.
        assert!((largest_torque(&[&a, &b], &[], |_| 0.5) - 1.5).abs() < 1e-15);
        assert_eq!(largest_torque(&[], &[0.0, 2.0], |t| -t), 2.0);
    }
}
