//! Simulation of mechanisms with wearing clearance joints, and the service that offers it to a coordinator.
//!
//! [`simulate::simulate`] computes the whole life of one sample of a scene: the planar motion of rigid bodies with contact in
//! the clearance of their joints, Archard wear of the bushings under the contact of each simulated cycle, and the outputs of the
//! scene at every checkpoint of the life, each with an estimate of its numerical error.
//!
//! ```
//! use common::accuracy::Accuracy;
//! use common::scene::SceneSource;
//! use worker::simulate::{SimulateOptions, simulate};
//!
//! // A pendulum of 1 kg, released from the horizontal, loads its hinge with at most 3 m g.
//! let source = SceneSource::builtin("pendulum")?;
//! let life = simulate(source.nominal(), &Accuracy::balanced(), SimulateOptions::default())?;
//! let (force, error) = (life.histories[0][0], life.errors[0][0]);
//! assert!((force - 3.0 * 9.81).abs() < error + 1e-3, "{force} N, stated error {error} N");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Modules from the lowest layer to the highest; a module uses only those above it in this table.
//!
//! | module | contents |
//! |---|---|
//! | [`log`] | log files and the explanation of refused connections |
//! | `extremum`, `interpolate`, `plane` | largest values, cubic interpolation, plane geometry |
//! | `lanes` | numbers in SIMD lanes with the same bits at every width |
//! | [`bore`] | worn profile of a bushing |
//! | `rail` | worn faces of a guide and its slider |
//! | [`contact`] | contact laws: stiffness, damping, friction, film |
//! | [`integrate`] | time integration with error control |
//! | `wear` | Archard wear over a cycle's contact history and over a block of cycles |
//! | [`mechanism`] | assembly, topology, constraints and forces |
//! | `quasi_static` | motion without vibrations, for the wear alone |
//! | `outputs` | from the recorded motion to the outputs of a scene |
//! | [`simulate`] | one evaluation, or several in the lanes of one core |
//! | [`service`] | offers a simulator to coordinators |
//! | [`evaluation_slots`] | slots of external simulators, lives around programs that give cycles among them |
//! | [`own_simulators`] | external simulators that the worker has itself |
//! | [`simulator`] | the simulator that the worker offers |
//! | [`serve_cycle`] | a scene as a program that gives cycles |
//! | [`umbridge`] | a scene as a model for UM-Bridge clients |

pub mod bore;
pub mod build;
pub mod contact;
pub mod evaluation_slots;
mod extremum;
pub mod integrate;
mod interpolate;
mod lanes;
pub mod log;
pub mod mechanism;
mod outputs;
pub mod own_simulators;
mod plane;
mod quasi_static;
mod rail;
pub mod serve_cycle;
pub mod service;
pub mod simulate;
pub mod simulator;
pub mod umbridge;
mod wear;

pub use build::BUILD;
