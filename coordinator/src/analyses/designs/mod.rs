//! Designs: one study over random and design variables together (augmented space), which answers for every design.
//!
//! A design variable is a key of the scene with a range, e.g. a clearance from 18 to 30 um, a mean or a standard deviation of a
//! random variable, or a threshold. The study learns the response over the random variables and those design variables that
//! are quantities of the scene; each design is then the same response under other distributions. The simulations of all
//! designs serve each of them, so the whole costs a fraction of a study per design.
//!
//! 1. [`DesignSpace`]: the scene with the design variables, checked at the corners of their ranges.
//! 2. [`DesignSpace::augmented`]: the scene that is studied, with distributions that cover those of all designs.
//! 3. [`refine`]: simulations where the reliability of single designs is still uncertain.
//! 4. [`answers`]: reliability and lives of every design of a grid with their errors; the best one, and which designs
//!    cannot be told from it.
//!
//! # Source
//! Augmented space of random and design variables: Au (2005), Reliability-based design sensitivity by efficient simulation,
//! Computers and Structures 83(14); surrogates over it, refined where designs need them: Dubourg, Sudret, Bourinet (2011),
//! Reliability-based design optimization using kriging surrogates and subset simulation, Structural and Multidisciplinary
//! Optimization 44(5).

mod answer;
mod augmented;
mod figures;
mod present;
mod report;
mod space;
#[cfg(test)]
mod tests;

pub use answer::{Best, DesignStudy, Objective, Refined, answers, refine};
pub use present::Follower;
pub use report::{DesignReport, answer, json};
pub use space::{DESIGNS_DOCUMENT, DesignSpace, DesignVariable, StoredSpace};
