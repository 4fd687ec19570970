//! Requests for one cycle on worn surfaces, as they are asked for and as a program or a model receives them.

use super::program::SampleByName;
use crate::scene::{Condition, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The surfaces of a joint as worn so far, at equal distances.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum WornSurfaces {
    /// Of a bore and its journal.
    Bore {
        /// Radii of the bore at the control points, from angle zero on in the bushing's frame `(points,)` [m].
        bushing: Vec<f64>,
        /// Radii of the journal, in its body's frame `(points,)` [m].
        journal: Vec<f64>,
    },
    /// Of a guide and its slider.
    Guide {
        /// Depths of the left face of the guide and then the right one, from its start to its end `(2 points,)` [m].
        guide: Vec<f64>,
        /// Depths of the left face of the slider and then the right one, from its rear to its front; empty if it does not wear [m].
        slider: Vec<f64>,
    },
}

impl WornSurfaces {
    /// Both surfaces, in the order of the vectors of a model.
    pub(super) fn both(&self) -> [&[f64]; 2] {
        let (WornSurfaces::Bore { bushing: first, journal: second }
        | WornSurfaces::Guide { guide: first, slider: second }) = self;
        [first, second]
    }
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
    pub joints: &'a BTreeMap<String, WornSurfaces>,
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
    pub(super) joints: &'a BTreeMap<String, WornSurfaces>,
    pub(super) outputs: &'a [&'a str],
}
