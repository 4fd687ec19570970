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

use common::scene::ErrorMeasure;

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
