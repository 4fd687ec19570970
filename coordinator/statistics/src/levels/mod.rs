//! Difference between the results of two levels of numerical accuracy, learned from pairs of simulations at the same points, and
//! what the finer level itself leaves.
//!
//! With the value y of the coarser level at a checkpoint, that of the exact solution is estimated by
//!
//!   y + d(y) + r,   d(y) = a + b (y - c),
//!
//! where d is the difference to the finer level, a constant (b = 0) or a line over the value of the coarser level, which is a
//! factor on it, or a function of the variables by Kriging, and r is what remains of the finer level, by a third one. Its error has two parts: that of d and r, common to
//! all points, shifts all responses together; the spread of the pairs around d, the roughness, differs from point to point and
//! acts as noise.
//!
//! # Source
//! Kennedy, O'Hagan (2000), Predicting the output from a complex computer code when fast approximations are available, Biometrika
//! 87(1), with polynomials in the place of the processes where these do; the remainder: Richardson (1911), as in Roache (1994), Perspective: a method
//! for uniform reporting of grid refinement studies, Journal of Fluids Engineering 116(3).

mod difference;
mod history;

pub use difference::{Difference, DifferenceForm, Remainder};
pub use history::{HistoryDifference, HistoryPair};
