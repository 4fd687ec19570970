//! Difference of the angle of a body from that on the mechanism with ideal joints, or from a wanted angle, over a cycle.
//!
//! With the angle theta(t) [rad] and the reference Theta(t) [rad], the ideal angle or a wanted function of time or of another angle,
//! the deviation is theta - Theta - 2 pi n, where the whole number n makes it smallest at the start of the cycle.

use super::deviation::Deviation;
use super::trace::interval_at;
use super::wanted::Wanted;
use super::{BodyTrack, RecordedCycle};
use common::scene::Curve;
use std::f64::consts::TAU;

/// The deviation of the output `angle-error` [rad] for a body of the scene; without a `wanted` angle the ideal mechanism is the
/// reference.
pub(super) fn angle_error(body: usize, wanted: Option<&Curve>, cycle: &RecordedCycle) -> Deviation {
    let track = cycle.body(body);
    match wanted {
        Some(curve) => {
            let mut wanted = Wanted::new(curve, cycle);
            from_reference(&track, |t| wanted.at(t))
        }
        None => cycle.ideal_angle(body).map(|ideal| from_ideal(&track, ideal)).unwrap_or_default(),
    }
}

/// Deviation of an angle from an ideal one, whose track covers the same span of time.
fn from_ideal(track: &BodyTrack, ideal: &BodyTrack) -> Deviation {
    let mut j = 0;
    from_reference(track, |t| ideal.angle_in(interval_at(&ideal.time, &mut j, t)).at(t).0)
}

/// Deviation of an angle from a reference [rad] over time [s], which is read at times that do not decrease.
fn from_reference(track: &BodyTrack, mut reference: impl FnMut(f64) -> f64) -> Deviation {
    let mut turns = None;
    Deviation::over(&track.time, |k, t| {
        let off = track.angle_in(k).at(t).0 - reference(t);
        off - TAU * *turns.get_or_insert((off / TAU).round())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::ErrorMeasure;

    #[test]
    fn whole_turns_do_not_count_and_a_wave_does() {
        let mut track = BodyTrack::default();
        for k in 0..=200 {
            let t = f64::from(k) / 200.0;
            track.push(t, [20.0 + 0.02 * (TAU * t).sin(), 0.02 * TAU * (TAU * t).cos(), 0.0]);
        }
        let still = from_reference(&track, |_| 20.0 - 3.0 * TAU);
        assert!((still.measure(ErrorMeasure::Largest) - 0.02).abs() < 1e-9);
        let rms = still.measure(ErrorMeasure::RootMeanSquare);
        assert!((rms - 0.02 / 2.0_f64.sqrt()).abs() < 1e-9, "{rms}");
    }
}
