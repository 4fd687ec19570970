//! Largest difference of two bodies' angles or angular velocities over a cycle.

use super::trace::Piece;
use super::{BodyTrack, MotionOutput, RecordedCycle, RecordingRequest};
use common::scene::SignedBody;

/// A quantity of a track in an interval of its times.
type Quantity = fn(&BodyTrack, usize) -> Piece;

/// The outputs `angle-difference` [rad] and `angular-velocity-difference` [rad/s].
pub struct AngleDifference<'a> {
    quantity: Quantity,
    a: &'a SignedBody,
    b: &'a SignedBody,
}

impl<'a> AngleDifference<'a> {
    /// Difference of the angles of two bodies.
    pub(crate) fn of_angles(a: &'a SignedBody, b: &'a SignedBody) -> Self {
        AngleDifference { quantity: BodyTrack::angle_in, a, b }
    }

    /// Difference of the angular velocities of two bodies.
    pub(crate) fn of_speeds(a: &'a SignedBody, b: &'a SignedBody) -> Self {
        AngleDifference { quantity: BodyTrack::omega_in, a, b }
    }
}

impl MotionOutput for AngleDifference<'_> {
    fn request(&self, request: &mut RecordingRequest) {
        request.bodies.extend([self.a.body, self.b.body]);
    }

    fn value(&self, cycle: &RecordedCycle) -> f64 {
        let signed = [self.a, self.b].map(|body| (cycle.body(body.body), body.sign));
        let [(a, sign_a), (b, sign_b)] = &signed;
        largest_difference(self.quantity, (a, *sign_a), (b, *sign_b))
    }
}

/// max over t of |s_a x_a(t) - s_b x_b(t)| for a quantity x of two tracks over the same span of time, each given with its sign.
///
/// The two tracks have times of their own; between two neighbouring times of either, both are cubics. Their difference is a
/// cubic too, and its extremum is found exactly: a vibration sampled a few times a period keeps its peak.
fn largest_difference(
    quantity: Quantity,
    (a, sign_a): (&BodyTrack, f64),
    (b, sign_b): (&BodyTrack, f64),
) -> f64 {
    let (mut i, mut j) = (0, 0);
    let (mut on_a, mut on_b) = (quantity(a, 0), quantity(b, 0));
    let mut t0 = on_a.span[0].max(on_b.span[0]);
    let (mut at_a, mut at_b) = (on_a.at(t0), on_b.at(t0));
    let difference =
        |(x, dx): (f64, f64), (y, dy): (f64, f64)| (sign_a * x - sign_b * y, sign_a * dx - sign_b * dy);
    let mut largest: f64 = 0.0;
    loop {
        let t1 = on_a.span[1].min(on_b.span[1]);
        if t1 > t0 {
            let (y0, d0) = difference(at_a, at_b);
            (at_a, at_b) = (on_a.at(t1), on_b.at(t1));
            let (y1, d1) = difference(at_a, at_b);
            largest = largest.max(y0.abs()).max(y1.abs());
            if d0 * d1 < 0.0 {
                largest = largest.max(extremum(y0, d0 * (t1 - t0), y1, d1 * (t1 - t0)).abs());
            }
            t0 = t1;
        }
        if on_a.span[1] <= t1 {
            i += 1;
            if i + 1 == a.time.len() {
                return largest;
            }
            on_a = quantity(a, i);
            at_a = on_a.at(t0);
        }
        if on_b.span[1] <= t1 {
            j += 1;
            if j + 1 == b.time.len() {
                return largest;
            }
            on_b = quantity(b, j);
            at_b = on_b.at(t0);
        }
    }
}

/// Value at the interior extremum of the cubic on [0, 1] with end values y and end slopes d of opposite sign.
fn extremum(y0: f64, d0: f64, y1: f64, d1: f64) -> f64 {
    let c = 3.0 * (y1 - y0) - 2.0 * d0 - d1;
    let d = d0 + d1 - 2.0 * (y1 - y0);
    // 3 d s^2 + 2 c s + d0 = 0, in the form that does not cancel; one root lies in (0, 1).
    let root = (c * c - 3.0 * d * d0).max(0.0).sqrt();
    let q = -(c + root.copysign(c));
    let candidates = [if q != 0.0 { d0 / q } else { 0.5 }, if d != 0.0 { q / (3.0 * d) } else { 0.5 }];
    let s = candidates.into_iter().find(|s| (0.0..=1.0).contains(s)).unwrap_or(0.5);
    y0 + s * (d0 + s * (c + s * d))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(times: &[f64], f: impl Fn(f64) -> (f64, f64)) -> BodyTrack {
        let mut track = BodyTrack::default();
        for &t in times {
            track.push(t, 0.0, f(t).0, f(t).1);
        }
        track
    }

    #[test]
    fn finds_the_peak_between_coarse_samples() {
        // Nine samples a period, shifted so that none lies on the peak of 1.
        let times: Vec<f64> = (0..=90).map(|k| k as f64 / 90.0 * 10.0).collect();
        let wave = track(&times, |t| {
            let x = std::f64::consts::TAU * t + 0.2;
            (x.sin(), std::f64::consts::TAU * x.cos())
        });
        let still = track(&[0.0, 3.3, 10.0], |_| (0.25, 0.0));
        let peak = largest_difference(BodyTrack::omega_in, (&wave, 1.0), (&still, 1.0));
        assert!((peak - 1.25).abs() < 2e-3, "{peak}");
        let peak = largest_difference(BodyTrack::omega_in, (&wave, 1.0), (&still, -1.0));
        assert!((peak - 1.25).abs() < 2e-3, "{peak}");
    }
}
