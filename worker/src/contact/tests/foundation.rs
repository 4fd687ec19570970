//! The law on an unworn bore against Hertz.

use crate::contact::{Foundation, Surface};
use crate::plane::length;
use std::f64::consts::TAU;

#[test]
fn equals_hertz_on_an_unworn_bore() {
    // The modulus is fitted within 4e-5 below a tenth of the clearance and 4e-4 beyond; the ends of an
    // arc whose half angle spans m intervals add 0.025 / m^3 at most.
    let mut worst: f64 = 0.0;
    for clearance in [1e-6, 3e-6, 1e-5, 23.5e-6, 1e-4, 5e-4] {
        let stiffness = 3.264e10 * libm::sqrt(23.5e-6 / clearance);
        let law = Foundation::new(
            Surface {
                journal_radius: 1.5e-3,
                clearance,
                stiffness,
                damping: 0.0,
                restitution: None,
                friction: 0.0,
                per_friction_speed: 1.0 / 1e-3,
                film: 0.0,
            },
            36,
        );
        for delta in [1e-8, 1.7e-8, 3e-8, 1e-7, 3.2e-7, 1e-6, 2e-6] {
            for k in 0..40 {
                let (angle, e) = (0.7 + 2.3e-4 * f64::from(k), clearance + delta);
                let load = law.load([e * libm::cos(angle), e * libm::sin(angle)]);
                let hertz = stiffness * libm::pow(delta, 1.5);
                let off = (length(load.force) / hertz - 1.0).abs();
                let half_angle = libm::acos(clearance / e);
                let spanned = half_angle / TAU * law.arc.intervals() as f64;
                let fitted = if delta < 0.1 * clearance { 4e-5 } else { 4e-4 };
                let bound = fitted + 0.025 / (spanned * spanned * spanned);
                assert!(off < bound, "clearance {clearance}, delta {delta}, angle {angle}: {off}");
                worst = worst.max(off);
            }
        }
    }
    println!("unworn foundation within {worst:e} of K_n delta^1.5");
    assert!(worst < 1e-3, "{worst}");
}
