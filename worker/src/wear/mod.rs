//! How a bore wears: Archard's law over a cycle's contact history, and the wear step over a block of cycles.

mod arc_ends;
mod archard;
mod conformal;
mod history;
mod local_arcs;
#[cfg(test)]
mod local_arcs_tests;
mod rest;
#[cfg(test)]
mod rest_tests;
mod step;
#[cfg(test)]
mod step_tests;
#[cfg(test)]
mod volume_tests;

pub use archard::WearRate;
pub use conformal::Unbalanced;
pub use history::{ContactHistory, ContactSample};
pub use step::{WearStep, WearStepFailed, WearStepStats};
