//! Modulus of the elastic foundation for which an unworn bore gives Hertz's force.
//!
//! With a constant modulus kappa = K_n 3 sqrt(c) / (4 sqrt 2) [N/(m rad)] the foundation's force on a round
//! bore is kappa e (theta - sin(theta) cos(theta)), cos(theta) = c / e, with the Hertz stiffness K_n
//! [N/m^1.5], the radial clearance c and the eccentricity e [m]. That is K_n delta^1.5 (1 - 0.65 x + ...)
//! with x = delta / c: too small by 5.1 % at x = 0.085 and by half at x = 2. Here the potential is U = kappa
//! V H instead, V = integral of g^2 / 2 over the arc: a function of V alone, so that the law stays
//! conservative on any bore, and all of the arc has the same modulus dU/dV, which grows with the load.
//!
//! The H for which U = (2/5) K_n delta^2.5 on a round bore has no closed form in V. With z^4 = 15 V / (8 sqrt
//! 2 c^2), which is x^2.5 to first order, it goes from 1 + (13/28) x at small x to a multiple of z at large
//! x: here a ratio of polynomials in z of degree four and three, whose coefficients are a minimax fit of the
//! force. The force is then K_n delta^1.5 within 3.5e-5 for x < 0.1 and within 3.5e-4 for x < 1000.
//!
//! # Source
//! Derived and fitted here, from Hertz's law (`surface.rs`) and the Winkler foundation (Johnson 1985,
//! Contact Mechanics, chapter 4).

use crate::lanes::{Real, lanewise};
use std::f64::consts::SQRT_2;

/// Coefficients of z to z^4 above the line, and of z to z^3 below; those of z^0 are one.
const OVER: [f64; 4] = [9.7995, 10.4899, 8.5050, 3.05787];
const UNDER: [f64; 3] = [9.78098, 8.82415, 3.22025];

/// Modulus of one joint's foundation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Modulus<R = f64> {
    /// Modulus of a light load, kappa = K_n 3 sqrt(c) / (4 sqrt 2) [N/(m rad)].
    light: R,
    /// 15 / (8 sqrt 2 c^2) [1/m^2].
    unit: R,
}

lanewise!(Modulus { light, unit });

impl Modulus {
    /// For Hertz stiffness `stiffness` [N/m^1.5] and radial clearance `clearance` [m].
    pub(crate) fn new(stiffness: f64, clearance: f64) -> Self {
        Modulus {
            light: stiffness * 3.0 * clearance.sqrt() / (4.0 * SQRT_2),
            unit: 15.0 / (8.0 * SQRT_2 * clearance * clearance),
        }
    }
}

impl<R: Real> Modulus<R> {
    /// U(V) [J], dU/dV, the modulus in effect [N/(m rad)], and d2U/dV2 [N/(m^3 rad^2)] for `v` = V [m^2 rad]; all zero without
    /// contact, V = 0.
    #[inline(always)]
    pub(crate) fn potential(&self, v: R) -> [R; 3] {
        let (nothing, one) = (v.zero(), v.like(1.0));
        let touches = nothing.below(v);
        let safe = R::select(touches, v, one);
        let z = (self.unit * safe).sqrt().sqrt();
        let [over, over_1, over_2] = polynomial(z, OVER);
        let [under, under_1, under_2] = polynomial(z, [UNDER[0], UNDER[1], UNDER[2], 0.0]);
        // H, dH/dz, d2H/dz2; dz/dV = z / (4 V).
        let inverse = one / under;
        let h = over * inverse;
        let h1 = (over_1 - h * under_1) * inverse;
        let h2 = (over_2 - h * under_2 - h1 * under_1 * 2.0) * inverse;
        let light = R::select(touches, self.light, nothing);
        let modulus = light * (h + z * h1 * 0.25);
        [light * safe * h, modulus, light * z / (safe * 16.0) * (h1 * 5.0 + z * h2)]
    }
}

/// The polynomial 1 + a z + b z^2 + c z^3 + d z^4 with its first and second derivative.
#[inline(always)]
fn polynomial<R: Real>(z: R, [a, b, c, d]: [f64; 4]) -> [R; 3] {
    [
        z * (z * (z * (z * d + c) + b) + a) + 1.0,
        z * (z * (z * (4.0 * d) + 3.0 * c) + 2.0 * b) + a,
        z * (z * (12.0 * d) + 6.0 * c) + 2.0 * b,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// V of a round bore of clearance one at penetration x, by Simpson's rule over the arc.
    fn potential(x: f64) -> f64 {
        const STEPS: u32 = 2000;
        let e = 1.0 + x;
        // Half angle from its sine's half, which keeps its digits at small x: 1 - cos = x / e.
        let half = 2.0 * (0.5 * x / e).sqrt().asin();
        let gap = |k: u32| {
            let s = (0.5 * half * f64::from(k) / f64::from(STEPS)).sin();
            x - 2.0 * e * s * s
        };
        let sum: f64 = (0..=STEPS)
            .map(|k| {
                let weight = if k == 0 || k == STEPS { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
                weight * gap(k).powi(2)
            })
            .sum();
        sum * half / f64::from(STEPS) / 3.0
    }

    #[test]
    fn a_round_bore_gives_hertz_whatever_the_penetration() {
        let modulus = Modulus::new(1.0, 1.0);
        for k in 0..200 {
            // Penetrations from 1e-5 to 1000 clearances.
            let x = 1e-5 * 10f64.powf(0.04 * f64::from(k));
            let v = potential(x);
            let bound = if x < 0.1 { 4e-5 } else { 4e-4 };
            let energy = 0.4 * x.powf(2.5);
            let off = (modulus.potential(v)[0] / energy - 1.0).abs();
            assert!(off < bound, "energy at {x}: {off}");
            // dV/dx of the round bore is e (theta - sin(theta) cos(theta)); its differences lose nothing
            // here.
            let step = 1e-4 * x;
            let slope = (potential(x + step) - potential(x - step)) / (2.0 * step);
            let off = (modulus.potential(v)[1] * slope / x.powf(1.5) - 1.0).abs();
            assert!(off < bound, "force at {x}: {off}");
        }
    }

    #[test]
    fn a_constant_modulus_would_be_short_by_0_65_delta_over_c() {
        let modulus = Modulus::new(1.0, 1.0);
        for (x, short) in [(1e-3, 0.65e-3), (1e-2, 0.65e-2), (0.0851, 0.0514)] {
            let step = 1e-4 * x;
            let slope = (potential(x + step) - potential(x - step)) / (2.0 * step);
            let off = 1.0 - modulus.light * slope / x.powf(1.5);
            assert!((off / short - 1.0).abs() < 0.01, "{x}: {off}");
        }
    }

    #[test]
    fn derivatives_agree_with_differences_and_the_modulus_grows() {
        let modulus = Modulus::new(3.264e10, 23.5e-6);
        let mut before = 0.0;
        for k in 0..60 {
            let v = 1e-22 * 10f64.powf(0.25 * f64::from(k));
            let (minus, at, plus) = (
                modulus.potential(v * (1.0 - 1e-5)),
                modulus.potential(v),
                modulus.potential(v * (1.0 + 1e-5)),
            );
            let first = (plus[0] - minus[0]) / (2e-5 * v);
            assert!((first / at[1] - 1.0).abs() < 1e-8, "{first} against {}", at[1]);
            let second = (plus[1] - minus[1]) / (2e-5 * v);
            assert!((second - at[2]).abs() * v < 1e-9 * at[1], "{second} against {}", at[2]);
            assert!(at[1] > before);
            before = at[1];
        }
        assert_eq!(modulus.potential(0.0), [0.0; 3]);
    }

    #[test]
    fn the_energy_is_convex_in_v_from_the_lightest_contact_to_any_depth() {
        // z from 1e-4 to 1e4: penetrations of 1e-6.4 to 1e6.4 clearances, nearly.
        let modulus = Modulus::new(1.0, 1.0);
        for k in 0..=800 {
            let z = 1e-4 * 10f64.powf(0.01 * f64::from(k));
            let potential = modulus.potential(z.powi(4) / modulus.unit);
            assert!(potential[2] > 0.0, "z {z}: {potential:?}");
        }
    }
}
