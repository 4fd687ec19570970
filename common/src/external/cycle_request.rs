//! Requests for one cycle on worn surfaces, as they are asked for and as a program or a model receives them.

use super::program::SampleByName;
use crate::scene::{Condition, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Radii of the surfaces of a joint at their control points, from angle zero on, at equal angles `(points,)` each [m].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WornRadii {
    /// The bore, in the bushing's frame.
    pub bushing: Vec<f64>,
    /// The journal, in its body's frame.
    pub journal: Vec<f64>,
}

/// A cycle as it is asked of a program.
#[derive(Debug, Clone, Copy)]
pub struct CycleRequest<'a> {
    /// The scene of the sample, under the condition if it has any.
    pub scene: &'a Scene,
    /// The operating condition of the cycle.
    pub condition: Option<&'a Condition>,
    /// Cycles worn so far.
    pub cycle: u32,
    /// Name of the accuracy.
    pub accuracy: &'a str,
    /// Surfaces of every joint, by its name.
    pub joints: &'a BTreeMap<String, WornRadii>,
}

/// The line of a request.
#[derive(Clone, Copy, Serialize)]
pub(super) struct CycleLine<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) id: Option<u64>,
    pub(super) cycle: u32,
    pub(super) sample: SampleByName<'a>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) condition: Option<&'a str>,
    pub(super) accuracy: &'a str,
    pub(super) period: f64,
    pub(super) joints: &'a BTreeMap<String, WornRadii>,
    pub(super) outputs: &'a [&'a str],
}
