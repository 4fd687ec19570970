//! Several evaluations side by side on one thread: their islands share the SIMD lanes of a core.
//!
//! An evaluation is an `async` function, a page of stages. Where it needs motion it hands the spans of its islands to the
//! [`LaneQueue`] and waits; the executor polls every running evaluation and then integrates queued islands in lanes, islands of
//! the same topology together. No runtime and no other thread takes part. The result of an evaluation does not depend on
//! the evaluations next to it, nor on the width of the lanes.
//!
//! | file | contents |
//! |---|---|
//! | `queue.rs` | spans waiting for a lane, and their results |
//! | `lanes.rs` | integrates queued islands, one per lane |
//! | `executor.rs` | the groups of lanes of a thread |
//! | `executor.rs` | polls the evaluations and runs the lanes |
//! | `width.rs` | how many numbers a lane group holds |

mod executor;
mod lanes;
mod queue;
mod width;

pub(crate) use executor::{RunningEvaluation, join, run_alone, run_side_by_side};
pub(crate) use queue::LaneQueue;
pub use width::LaneWidth;
pub(crate) use width::widest_lanes;
