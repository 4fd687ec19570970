//! The coordinator: reliability studies of mechanisms with wearing hinges, with any simulator.
//!
//! A study estimates the time-dependent reliability R(n): the probability that after n cycles no limit state has been
//! reached. It simulates an initial design, fits Kriging surrogates, and adds the simulations that reduce the
//! classification error most (active learning Kriging with Monte Carlo simulation, AK-MCS).
//!
//! ```text
//! scene + settings -> design -> evaluations -> surrogates -> learning -> reliability, sensitivities -> report
//! ```
//!
//! | layer | content | uses |
//! |---|---|---|
//! | [`statistics`] | design, surrogates, learning, reliability, sensitivity | - |
//! | [`farm`] | evaluators, and the dispatch of tasks to workers | - |
//! | [`results`] | summary, journal, campaign file, result files | `farm` |
//! | [`study`] | a study from its settings to its result | the three above |
//! | [`presentation`] | report, view of a running study, terminal | `farm`, `results`, `study` |
//! | [`analyses`] | accuracy trade-off, error budget, calibration, what-if, optimisation | all above |
//!
//! The evaluator is an argument of [`study::run`]: a closure ([`farm::evaluate::local`]), workers on many machines
//! ([`farm::dispatch`]) or an external program ([`farm::evaluate::external`]). So is the journal: SQLite
//! ([`results::store`]) or memory ([`results::journal::InMemoryJournal`]).
//!
//! # Example
//! The reliability of a bar whose section wears, simulated by a closure:
//! ```
//! use common::outputs::Evaluation;
//! use common::scene::SceneSource;
//! use coordinator::farm::evaluate::{Request, local::LocalEvaluator};
//! use coordinator::results::{journal::InMemoryJournal, progress::Silent};
//! use coordinator::study::{Settings, run};
//!
//! let source = SceneSource::parse(
//!     r#"
//!     scene = { name = "bar" }
//!     simulator = { program = ["closure"] }
//!     life = { cycles = 300, checkpoint_every = 100 }
//!     outputs = [{ name = "stress", unit = "MPa" }]
//!     limit_states = [{ name = "yield", output = "stress", threshold = 250 }]
//!     variables = [{ name = "force", mean = "20 kN", std = "2 kN" }]
//!     "#,
//!     "bar",
//! )?;
//! let scene = source.nominal();
//! // The section shrinks from 100 mm^2 by 5 mm^2 per 100 cycles.
//! let stress = |request: &Request| {
//!     let cycles = scene.life.checkpoints();
//!     let history = cycles.iter().map(|n| request.sample[0] / (100.0 - 0.05 * f64::from(*n))).collect();
//!     Ok(Evaluation::from_histories(cycles, vec![history]))
//! };
//! let settings = Settings { samples: 20_000, initial: 6, max_evaluations: 40, ..Settings::from(scene) };
//! let mut evaluator = LocalEvaluator::new(1, stress);
//! let result = run(scene, &settings, &mut evaluator, &mut InMemoryJournal::default(), &mut Silent)?;
//! // P(force < 250 MPa * 85 mm^2 = 21.25 kN) = Phi(0.625) = 0.734
//! let last = &result.summary.reliability[2];
//! assert!((last.reliability["total"] - 0.734).abs() < 4.0 * last.standard_error["total"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! More examples, run by `cargo run --release -p coordinator --example NAME`: `reliability_of_a_closure`, `scene_in_code`,
//! `published_problems`; and `own_simulator` of the package `tests`, a simulator on the farm.

pub mod analyses;
pub mod farm;
pub mod presentation;
pub mod results;
pub use statistics;
pub mod study;
#[cfg(test)]
mod tests;
