//! Scenes: a mechanism or an external simulator with its random variables, limit states and life, as read from TOML.
//!
//! [`SceneSource`] reads a scene, checks it as a whole and resolves it for any sample of its random variables. A
//! [`Scene`] comes out of that validation, all values in SI, so a simulation need not check again what it reads there.
//! The language is described in `common/scenes/README.md`.
//!
//! | layer | modules | content |
//! |---|---|---|
//! | values | [`quantity`], [`expression`], `expression_error` | dimensions and units; evaluation of `"2 * arm + 1 mm"`, and why a text has no value |
//! | model | [`model`], `choice`, `joint`, `values`, `key_table`, `load`, `output`, `wear_model`, `explained` | the types of a checked scene, all exported here |
//! | faults | [`faults`], `location`, `layers`, `unit_advice` | what is wrong, with file, line, column, key, value and allowed range |
//! | reading | `document`, `extends`, `csv_file`, `csv_import`, `samples_file`, `context`, `section`, `section_tables`, `input` | one pass over the file that records every fault |
//! | readers | `bodies`, `joints`, `clearance`, `key_reading`, `elements`, `tables`, `life`, `simulator`, `variables`, `variable_law`, `conditions` | one part of a file each |
//! | whole | `resolve`, `conditioned`, `edit`, `warnings`, `builtin`, [`source`], `setting` | all parts together; warnings; `extends`; changed texts; the built-in scenes and their published results; samples; values set by name |

mod bodies;
mod body_row;
mod builtin;
mod choice;
mod clearance;
mod conditioned;
mod conditions;
mod context;
mod csv_file;
mod csv_import;
mod document;
mod edit;
mod elements;
mod explained;
pub mod expression;
mod expression_error;
mod extends;
pub mod faults;
mod input;
mod joint;
mod joints;
mod key_reading;
mod key_table;
mod layers;
mod life;
mod load;
mod location;
mod meshes;
pub mod model;
#[cfg(test)]
mod model_tests;
pub mod monotone;
mod output;
mod output_unit;
pub mod quantity;
mod resolve;
mod samples_file;
mod section;
mod section_tables;
mod setting;
mod simulator;
pub mod source;
mod tables;
mod unit_advice;
mod units;
mod values;
mod variable_law;
mod variables;
mod warnings;
mod wear_model;

pub use context::{Range, number_and_unit, read_quantity};
pub use csv_file::{Cell, CsvRow, csv_rows};
pub use explained::filled;
pub use extends::read_input as read_text;
pub use faults::{Fault, FaultKind, Faults, nearest};
pub use input::{InputFile, read_rows};
pub use joint::{
    Clearance, ContactDamping, ContactLaw, ControlPoints, GuideClearance, GuideWear, IdealFriction, Joint,
    JointKind, Material, Mesh, MeshForm, RestitutionLaw, WearingSurfaces,
};
pub use key_table::{ElementKind, Form, Key, Value};
pub use load::Load;
pub use location::Location;
pub use model::{
    Body, Condition, CycleProgram, CycleTier, ExternalSimulator, FileExchange, Life, MassProperties, Motion,
    Point, Program, Scene, SimulatorKind, StudySettings, UmBridgeModel,
};
pub use output::{Fails, LimitState, Output, OutputKind};
pub use output_unit::OutputUnit;
pub use samples_file::samples_of;
pub use section::{Section, VALUE_LIMIT};
pub use simulator::REQUEST_FILE;
pub use source::{SceneSource, published_results};
pub use units::Units;
pub use values::{
    Attachment, Curve, Drive, ErrorMeasure, HeldInput, ImpactMeasure, Over, SignedBody, Table, WearQuantity,
};
pub use variable_law::{DEFAULT_LAW, LAWS};
pub use variables::MeasuredVariable;
pub use warnings::Warning;
pub use wear_model::{BlockStep, BoreSpline, WearDistribution, WearModel};
