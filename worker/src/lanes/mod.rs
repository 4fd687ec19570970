//! Lanes of numbers: the kernels of the simulation are written once, for a [`Real`] that is one number or a
//! SIMD vector of the processor (AVX2, AVX-512, NEON by the crate pulp, one number without them).
//!
//! Lanes are independent, and what is fused in lanes is fused for one number: each lane has, to the last bit, the
//! value that the same formula gives for one number alone. Results therefore depend neither on the processor nor
//! on the other lanes. An x86 processor without AVX2 and FMA takes the same fused operations from the C
//! library, with the same bits and at a multiple of the time.

// What kernels call is inlined into code compiled for the lanes' instruction set, down to the last function:
// closures of the standard library's iterators are not, so that kernels use plain loops.

mod elementary;
mod lanewise;
mod real;
mod vectorised;

pub(crate) use elementary::{cube_root, direction_angle, sincos, tanh};
pub(crate) use lanewise::{InLane, Lanewise, read_lane};
pub(crate) use lanewise::{in_lane, lanewise, same_in_lanes};
pub(crate) use real::{Lanes, Real, Vectorised, run_in};
pub(crate) use vectorised::{InLanes, fused, in_widest_lanes};
