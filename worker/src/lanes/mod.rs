//! Numbers side by side: the kernels of the simulation are written once, for a [`Real`] that is one number or
//! as many as the processor works on at once (AVX2, AVX-512, NEON by the crate pulp, one number without
//! them).
//!
//! No lane knows of the others, and no operation is fused: each lane has, to the last bit, the value that the
//! same formula gives for one number alone. Results therefore depend neither on the processor nor on what ran
//! beside.

// What kernels call is inlined into code compiled for the lanes' instruction set, down to the last function:
// closures of the standard library's iterators are not, so that kernels use plain loops.

mod elementary;
mod real;

pub use elementary::{atan2, sincos, tanh};
pub use real::{Lanes, Real};
