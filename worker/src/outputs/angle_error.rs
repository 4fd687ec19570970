//! Difference of the angle of a body from that on the mechanism with ideal joints, or from a wanted angle, over a cycle.
//!
//! With the angle theta(t) [rad] and the reference Theta(t) [rad], the ideal angle or a wanted function of time or of another angle,
//! the deviation is theta - Theta - 2 pi n, where the whole number n makes it smallest at the start of the cycle.

use super::deviation::Deviation;
use super::wanted::{Wanted, argument_body};
use super::{BodyTrack, MotionOutput, RecordedCycle, RecordingRequest};
use common::scene::{Curve, ErrorMeasure};
use std::f64::consts::TAU;

/// The output `angle-error` [rad].
pub struct AngleError<'a> {
    /// Body of the scene.
    pub body: usize,
    /// Wanted angle; without it the ideal mechanism is the reference.
    pub wanted: Option<&'a Curve>,
    /// Measure of the error over the cycle.
    pub measure: ErrorMeasure,
}

impl MotionOutput for AngleError<'_> {
    fn request(&self, request: &mut RecordingRequest) {
        request.bodies.push(self.body);
        match self.wanted {
            None => request.ideal_bodies.push(self.body),
            Some(curve) => request.bodies.extend(argument_body(curve)),
        }
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        let track = cycle.body(self.body);
        let deviation = match self.wanted {
            Some(curve) => {
                let mut wanted = Wanted::new(curve, cycle);
                from_reference(&track, |t| wanted.at(t))
            }
            None => cycle.ideal_angle(self.body).map(|ideal| from_ideal(&track, ideal)).unwrap_or_default(),
        };
        deviation.measure(self.measure)
    }

    fn is_extreme(&self) -> bool {
        self.measure == ErrorMeasure::Largest
    }
}

/// Deviation of an angle from an ideal one, whose track covers the same span of time.
fn from_ideal(track: &BodyTrack, ideal: &BodyTrack) -> Deviation {
    let mut j = 0;
    from_reference(track, |t| {
        while j + 2 < ideal.time.len() && ideal.time[j + 1] < t {
            j += 1;
        }
        ideal.angle_in(j).at(t).0
    })
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

    #[test]
    fn whole_turns_do_not_count_and_a_wave_does() {
        let mut track = BodyTrack::default();
        for k in 0..=200 {
            let t = f64::from(k) / 200.0;
            track.push(t, 20.0 + 0.02 * (TAU * t).sin(), 0.02 * TAU * (TAU * t).cos(), 0.0);
        }
        let still = from_reference(&track, |_| 20.0 - 3.0 * TAU);
        assert!((still.measure(ErrorMeasure::Largest) - 0.02).abs() < 1e-9);
        let rms = still.measure(ErrorMeasure::RootMeanSquare);
        assert!((rms - 0.02 / 2.0_f64.sqrt()).abs() < 1e-9, "{rms}");
    }
}
