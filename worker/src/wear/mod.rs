//! The worn bore and how it wears: profile, Archard's law over a cycle's contact history, the wear step.

mod archard;
mod conformal;
mod history;
mod profile;
mod step;
#[cfg(test)]
mod volume_tests;

pub use archard::WearRate;
pub use conformal::Unbalanced;
pub use history::{ContactHistory, ContactSample};
pub use profile::{Profile, Radius};
pub use step::{WearStep, WearStepStats};
