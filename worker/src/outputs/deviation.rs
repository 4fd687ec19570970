//! Largest size and root mean square of a deviation e(t) over a cycle [m or rad].
//!
//!   largest = max |e|,      r.m.s. = sqrt((1/T) int e^2 dt)
//!
//! Within every time step the deviation, which is smooth there, is evaluated at five equidistant times: the largest size is that of these
//! values, the integral follows from Boole's rule, which is exact for polynomials of degree five in e^2; its error is
//! h^7 / 1 935 360 times the sixth derivative of e^2, with the step h [s].
//!
//! # Source
//! Boole's rule: Abramowitz, Stegun, Handbook of Mathematical Functions (1964), 25.4.14.
//!
//! # Errors of angles
//! Difference of the angle of a body from that on the mechanism with ideal joints, or from a wanted angle, over a cycle.
//!
//! With the angle theta(t) [rad] and the reference Theta(t) [rad], the ideal angle or a wanted function of time or of another angle,
//! the deviation is theta - Theta - 2 pi n, where the whole number n makes it smallest at the start of the cycle.
//!
//! # Errors of positions
//! Distance of a point of a body from its path on the mechanism with ideal joints, or from wanted coordinates, over a cycle.
//!
//! With a point at x(t), y(t) [m] and the reference X(t), Y(t) [m], the ideal path or wanted functions of time or of an angle, the
//! deviation is sqrt((x - X)^2 + (y - Y)^2); of one wanted coordinate alone it is the difference in that coordinate.
//!
//! # Wanted
//! What a function generator should do: a quantity as a function of time or of the angle of a body.
//!
//! Between the points of its table the function is the cubic spline; where the table does not repeat, its slope at either end is that
//! of the cubic through the four points nearest to the end. The error is of fourth order in the distance of the points.
//!
//! Source:
//! De Boor, A Practical Guide to Splines (1978), chapter IV: complete spline with slopes by interpolation at the ends.

use super::trace::interval_at;
use super::{BodyTrack, PointTrack, RecordedCycle};
use crate::mechanism::{PiecewiseCubic, Prescribed};
use common::scene::{Attachment, Curve, ErrorMeasure, Over};
use std::f64::consts::TAU;

/// Places within a time step at which a deviation is evaluated, besides its ends [1].
const WITHIN: [f64; 3] = [0.25, 0.5, 0.75];
/// Weights of Boole's rule at all five places [1].
const WEIGHTS: [f64; 5] = [7.0 / 90.0, 32.0 / 90.0, 12.0 / 90.0, 32.0 / 90.0, 7.0 / 90.0];

/// A deviation over a span of time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deviation {
    largest: f64,
    /// Integral of the square, with the time.
    square: f64,
    /// Length of the span [s].
    length: f64,
}

impl Deviation {
    /// The deviation `at(k, t)` in every interval k between neighbouring times `(n,)` [s], increasing.
    pub(crate) fn over(times: &[f64], mut at: impl FnMut(usize, f64) -> f64) -> Self {
        let mut found = Deviation::default();
        for (k, ends) in times.windows(2).enumerate() {
            let (from, to) = (ends[0], ends[1]);
            let inside = WITHIN.map(|share| from + share * (to - from));
            let mut mean = 0.0;
            for (t, weight) in [from, inside[0], inside[1], inside[2], to].into_iter().zip(WEIGHTS) {
                let deviation = at(k, t);
                found.largest = found.largest.max(deviation.abs());
                mean += weight * deviation * deviation;
            }
            found.square += (to - from) * mean;
            found.length += to - from;
        }
        found
    }

    /// The deviation in this measure; zero over an empty span.
    pub(crate) fn measure(&self, measure: ErrorMeasure) -> f64 {
        match measure {
            ErrorMeasure::Largest => self.largest,
            ErrorMeasure::RootMeanSquare if self.length > 0.0 => (self.square / self.length).sqrt(),
            ErrorMeasure::RootMeanSquare => 0.0,
        }
    }
}

/// The deviation of the output `angle-error` [rad] for a body of the scene; without a `wanted` angle the ideal mechanism is the
/// reference.
pub(super) fn angle_error(body: usize, wanted: Option<&Curve>, cycle: &RecordedCycle) -> Deviation {
    let track = cycle.body(body);
    match wanted {
        Some(curve) => from_reference(&track, wanted_over(curve, cycle)),
        None => cycle.ideal_angle(body).map(|ideal| angle_from_ideal(&track, ideal)).unwrap_or_default(),
    }
}

/// Deviation of an angle from an ideal one, whose track covers the same span of time.
fn angle_from_ideal(track: &BodyTrack, ideal: &BodyTrack) -> Deviation {
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

/// The deviation of the output `position-error` [m] for a point of a body of the scene; without any `wanted` coordinates x, y the
/// ideal mechanism is the reference.
pub(super) fn position_error(
    at: &Attachment,
    wanted: &[Option<Curve>; 2],
    cycle: &RecordedCycle,
) -> Deviation {
    let Some(path) = cycle.path(at) else { return Deviation::default() };
    if wanted.iter().all(Option::is_none) {
        return cycle.ideal_path(at).map(|ideal| path_from_ideal(path, ideal)).unwrap_or_default();
    }
    let [mut x, mut y] = wanted.each_ref().map(|c| c.as_ref().map(|curve| wanted_over(curve, cycle)));
    Deviation::over(&path.time, |k, t| {
        let at = path.position_in(k, t);
        let [x, y] = [(&mut x, at[0]), (&mut y, at[1])].map(|(w, is)| w.as_mut().map_or(0.0, |w| is - w(t)));
        libm::hypot(x, y)
    })
}

/// Deviation of a path from an ideal one, whose track covers the same span of time.
fn path_from_ideal(path: &PointTrack, ideal: &PointTrack) -> Deviation {
    let mut j = 0;
    Deviation::over(&path.time, |k, t| {
        let (a, b) = (path.position_in(k, t), ideal.position_in(interval_at(&ideal.time, &mut j, t), t));
        libm::hypot(a[0] - b[0], a[1] - b[1])
    })
}

/// A wanted function of a scene over the recorded cycle: its value at a time [s], in the unit of the function; times must not decrease from call to
/// call.
fn wanted_over<'a>(curve: &Curve, cycle: &RecordedCycle<'a>) -> Box<dyn FnMut(f64) -> f64 + 'a> {
    let function = PiecewiseCubic::interpolating(&curve.table);
    let Over::Angle(body) = curve.over else { return Box::new(move |t| function.jet(t)[0]) };
    if let Some(motion) = Prescribed::from_body(&cycle.scene.bodies[body]) {
        return Box::new(move |t| function.jet(motion.angle(t))[0]);
    }
    let (track, mut last) = (cycle.body(body), 0);
    Box::new(move |t| {
        let k = interval_at(&track.time, &mut last, t);
        function.jet(track.angle_in(k).at(t).0)[0]
    })
}

/// The body whose angle is the argument of a curve, if that angle has to be recorded or is prescribed.
pub(crate) fn argument_body(curve: &Curve) -> Option<usize> {
    match curve.over {
        Over::Time => None,
        Over::Angle(body) => Some(body),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_has_its_amplitude_and_its_root_mean_square() {
        let times: Vec<f64> = (0..=24).map(|k| f64::from(k) / 24.0).collect();
        let sine = Deviation::over(&times, |_, t| 3.0 * (std::f64::consts::TAU * t).sin());
        assert!((sine.measure(ErrorMeasure::Largest) - 3.0).abs() < 1e-12);
        // (2 pi / 24)^6 2^6 / 1 935 360 of the square is 1e-8.
        let rms = sine.measure(ErrorMeasure::RootMeanSquare);
        assert!((rms - 3.0 / 2.0_f64.sqrt()).abs() < 1e-7, "{rms}");
        // Unequal steps: the mean is over time. A straight line from -1 to 2 has the mean square 1.
        let line = Deviation::over(&[0.0, 0.1, 1.0], |_, t| 3.0 * t - 1.0);
        assert!((line.measure(ErrorMeasure::RootMeanSquare) - 1.0).abs() < 1e-14);
        assert_eq!(Deviation::over(&[], |_, _| 1.0).measure(ErrorMeasure::RootMeanSquare), 0.0);
    }
}

#[cfg(test)]
mod angle_error_tests {
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

#[cfg(test)]
mod position_error_tests {
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
        let of = |other: &PointTrack, measure| path_from_ideal(&a, other).measure(measure);
        assert!((of(&b, ErrorMeasure::Largest) - 0.01).abs() < 1e-8);
        let wobbling = circle(170, 0.01, 0.005);
        assert!((of(&wobbling, ErrorMeasure::Largest) - 0.015).abs() < 1e-6);
        // 0.01^2 + 0.005^2 / 2.
        let rms = of(&wobbling, ErrorMeasure::RootMeanSquare);
        assert!((rms - (1e-4_f64 + 1.25e-5).sqrt()).abs() < 1e-8, "{rms}");
    }
}
