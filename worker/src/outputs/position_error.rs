//! Distance of a point of a body from its path on the mechanism with ideal joints, or from wanted coordinates, over a cycle.
//!
//! With a point at x(t), y(t) [m] and the reference X(t), Y(t) [m], the ideal path or wanted functions of time or of an angle, the
//! deviation is sqrt((x - X)^2 + (y - Y)^2); of one wanted coordinate alone it is the difference in that coordinate.

use super::deviation::Deviation;
use super::trace::interval_at;
use super::wanted::Wanted;
use super::{PointTrack, RecordedCycle};
use common::scene::{Attachment, Curve};

/// The deviation of the output `position-error` [m] for a point of a body of the scene; without any `wanted` coordinates x, y the
/// ideal mechanism is the reference.
pub(super) fn position_error(
    at: &Attachment,
    wanted: &[Option<Curve>; 2],
    cycle: &RecordedCycle,
) -> Deviation {
    let Some(path) = cycle.path(at) else { return Deviation::default() };
    if wanted.iter().all(Option::is_none) {
        return cycle.ideal_path(at).map(|ideal| from_ideal(path, ideal)).unwrap_or_default();
    }
    let [mut x, mut y] = wanted.each_ref().map(|c| c.as_ref().map(|curve| Wanted::new(curve, cycle)));
    Deviation::over(&path.time, |k, t| {
        let at = path.position_in(k, t);
        let off = |wanted: &mut Option<Wanted>, is: f64| wanted.as_mut().map_or(0.0, |w| is - w.at(t));
        libm::hypot(off(&mut x, at[0]), off(&mut y, at[1]))
    })
}

/// Deviation of a path from an ideal one, whose track covers the same span of time.
fn from_ideal(path: &PointTrack, ideal: &PointTrack) -> Deviation {
    let mut j = 0;
    Deviation::over(&path.time, |k, t| {
        let (a, b) = (path.position_in(k, t), ideal.position_in(interval_at(&ideal.time, &mut j, t), t));
        libm::hypot(a[0] - b[0], a[1] - b[1])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::scene::ErrorMeasure;

    #[test]
    fn the_distance_between_a_circle_and_a_shifted_one_is_the_shift() {
        let circle = |n: usize, shift: f64, wobble: f64| {
            let mut track = PointTrack::default();
            for k in 0..=n {
                let t = k as f64 / n as f64;
                let ((s, c), tau) = ((std::f64::consts::TAU * t).sin_cos(), std::f64::consts::TAU);
                let bump = wobble * (tau * t).sin();
                track.push(t, [c + shift + bump, s, -tau * s + wobble * tau * c, tau * c]);
            }
            track
        };
        let (a, b) = (circle(300, 0.0, 0.0), circle(170, 0.01, 0.0));
        let of = |other: &PointTrack, measure| from_ideal(&a, other).measure(measure);
        assert!((of(&b, ErrorMeasure::Largest) - 0.01).abs() < 1e-8);
        let wobbling = circle(170, 0.01, 0.005);
        assert!((of(&wobbling, ErrorMeasure::Largest) - 0.015).abs() < 1e-6);
        // 0.01^2 + 0.005^2 / 2.
        let rms = of(&wobbling, ErrorMeasure::RootMeanSquare);
        assert!((rms - (1e-4_f64 + 1.25e-5).sqrt()).abs() < 1e-8, "{rms}");
    }
}
