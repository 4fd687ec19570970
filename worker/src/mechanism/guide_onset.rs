//! Contacts of guides that begin within a time step: the part of its error that the estimate of the scheme cannot see.
//!
//! The scheme evaluates the force at the shares 0, 0.462 and 0.880 of a step (`integrate/rosenbrock.rs`). A pad that begins to touch after the
//! last of them, or shortly before it, is within the step without a force that anything measures: the step has the error estimate of free flight,
//! and the pad enters elastic energy for which no work was done. The velocity that the bodies miss is estimated by the impulse of the pad since it began
//! to touch. With the overlap g [m] and its rate at the end of the step of length h [s], the force P [N] there and its gradient G_k to a
//! coordinate of the mass m_k,
//!
//!   dv_k = P |G_k| min(h, g / (dg/dt)) / (2 m_k) [m/s, rad/s],
//!
//! summed over the pads that touch at the end and did not at the start. It counts as an error of the step. Under a force that grows evenly this is the
//! impulse itself; it is 3/4 of it for a pad that begins from rest under a constant acceleration. What ideal joints couple is left out.

use super::frame::Frame;
use super::guide::Guiding;
use crate::contact::GuideReaction;
use crate::lanes::Real;

/// Largest velocity missing after a step of length `h` [s], over its scale [1]; the bodies are in `frames` at its end, and the guides did
/// `before` at its start. `mass` `(n,)` [kg, kg m^2] and `per_velocity` [s/m, s/rad] belong to the coordinates of the free bodies.
#[inline(always)]
pub(super) fn begun<R: Real>(
    guides: &[impl Guiding<R>],
    frames: &[Frame<R>],
    before: &[GuideReaction<R>],
    h: R,
    mass: &[R],
    per_velocity: impl Fn(usize) -> R,
) -> R {
    let mut worst = h.zero();
    for (guide, before) in guides.iter().zip(before) {
        let impulse = guide.begun(frames, before, h);
        for (side, end) in guide.ends().iter().enumerate().filter(|(_, end)| 3 * end.frame < mass.len()) {
            for k in 0..3 {
                let row = 3 * end.frame + k;
                worst = worst.larger(impulse[3 * side + k] / mass[row] * per_velocity(row));
            }
        }
    }
    worst
}
