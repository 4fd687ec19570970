//! Optimisation of a design: costs of its quantities, minimisation under constraints, and discrete choices.
//!
//! | file | computes |
//! |---|---|
//! | `cost` | cost of a tolerance, a spread or a mean |
//! | `program` | minimum of a smooth function under smooth constraints, with its multipliers |
//! | `choices` | the cheapest of many combinations of discrete choices |
//!
//! # Source
//! Each file names its own.

mod choices;
mod cost;
mod program;

pub use choices::{ChoiceSearch, cheapest_choice};
pub use cost::{CostModel, CostTable};
pub use program::{Minimum, Program, minimise, nearest};
