//! Data that the coordinator and its workers share: scenes, random variables, results of an evaluation, and the
//! messages between them; and the use of external simulators. No messaging, no linear algebra.
//!
//! | layer | module | content |
//! |---|---|---|
//! | input | [`random`] | distributions, the Gaussian copula, tolerances of ISO 286 |
//! | | [`accuracy`] | numerical settings of a simulation, by name |
//! | | [`scene`] | scenes: read from TOML, checked, resolved for a sample |
//! | result | [`failure`], [`outputs`] | results of an evaluation, or the reason why there is none |
//! | | [`evaluation_shape`] | whether a result fits its scene |
//! | | [`external`] | evaluations by a user's program or an UM-Bridge server |
//! | process | [`locks`] | locks whose poisoning is ignored |
//! | | [`build`] | the build of the program that determines the bits of results |
//! | | [`panics`] | panics of simulations, and of anything else |
//! | transport | [`umbridge`], [`wire`] | the UM-Bridge protocol; the messages between coordinator and worker |
//!
//! A built-in scene, read and changed:
//!
//! ```
//! use common::scene::{JointKind, SceneSource};
//!
//! let source = SceneSource::builtin("four-bar")?;
//! let setting = source.parse_setting("parameters.crank_length=25mm")?;
//! let scene = source.resolve_with(&[setting])?;
//! for joint in &scene.joints {
//!     if let JointKind::Clearance(clearance) = &joint.kind {
//!         println!("{}: radial clearance {} um", joint.name, 1e6 * clearance.radial_clearance());
//!     }
//! }
//! assert_eq!(scene.life.checkpoints().len(), 8);
//! # Ok::<(), common::scene::Faults>(())
//! ```
//!
//! A scene in code is a text that [`scene::SceneSource::parse`] reads; with `extends` it states only what differs. All
//! fields of the [`scene::Scene`] that comes out are public and may be changed, e.g. `scene.life.cycles`:
//!
//! ```
//! use common::scene::SceneSource;
//!
//! let text = r#"
//!     [scene]
//!     name = "slow-four-bar"
//!     extends = "four-bar"
//!     [[bodies]]
//!     name = "crank"
//!     speed = "30 r/min"
//! "#;
//! let source = SceneSource::parse(text, "slow-four-bar")?;
//! assert!((source.nominal().life.period - 2.0).abs() < 1e-12);
//! # Ok::<(), common::scene::Faults>(())
//! ```

pub mod accuracy;
pub mod build;
pub mod evaluation_shape;
pub mod external;
pub mod failure;
pub mod locks;
pub mod outputs;
pub mod panics;
pub mod random;
pub mod scene;
pub mod text_file;
pub mod umbridge;
pub mod wire;
