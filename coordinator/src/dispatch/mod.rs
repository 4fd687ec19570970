//! Evaluations by workers over Zenoh.
//!
//! ```text
//! study --evaluate--> ZenohEvaluator --Submit--> desk (thread: scheduler) --replies, notices--> transport
//!       <--record---                <--Deliver--                          <--claims, liveness---
//! ```
//!
//! [`scheduler`] decides, without clock or messages; `transport` is the only place of the coordinator that
//! knows Zenoh; `desk` is the thread between them.

pub mod scheduler;
