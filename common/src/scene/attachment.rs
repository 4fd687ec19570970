//! Points on bodies, where joints, loads and outputs act.

use serde::{Deserialize, Serialize};

/// A point of a body, by position in the body's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Attachment {
    /// Index into [`super::Scene::bodies`].
    pub body: usize,
    /// Position in that body's frame `(2,)` [m].
    pub position: [f64; 2],
}
