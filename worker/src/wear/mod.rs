//! Wear of a bore and of the journal in it, or of a guide and of its slider: Archard's law over the contact history of a cycle, and the wear step
//! over a block of cycles.
//!
//! Order of use: `interval` records contact samples; `archard` turns them into a wear rate on the present
//! profile, for `local-hertz` by `local_arcs` and `arc_ends`, for `foundation` by `condense`, `conformal`,
//! `equilibrium` and `nodal_loads`, for guides by `rail_history`, `rail_rate` and `rail_equilibrium`. `WearLaw` (`amounts`) is what these rates have in common, `WearRate` (`archard`)
//! any of them; `step` integrates that rate over a block; `finer_bore`
//! shows what the spacing of the control points costs, `mean_contact_arc` (`condense`) what it has to resolve, `amounts` what the depths come to.

mod amounts;
mod arc_ends;
mod archard;
mod condense;
mod conformal;
mod crossing;
mod equilibrium;
mod finer_bore;
mod interval;
mod local_arcs;
mod nodal_loads;
mod rail_equilibrium;
mod rail_history;
mod rail_rate;
mod step;
#[cfg(test)]
mod tests;

pub(crate) use amounts::{WearLaw, WornAmounts, wear_output};
pub(crate) use archard::{BoreWearRate, WearHistory, WearRate};
pub(crate) use condense::mean_contact_arc;
pub(crate) use equilibrium::NoEquilibrium;
pub(crate) use finer_bore::FinerBore;
pub(crate) use interval::{ContactHistory, ContactInstant, ContactSample, Interval};
pub(crate) use rail_history::{RailHistory, RailInstant};
pub(crate) use rail_rate::RailWearRate;
pub(crate) use step::{StepTolerance, WearStep, WearStepFailed, WearStepStats, step_tolerance};
