//! A backlash for which the influence of the joints is needed.

use crate::mechanism::Coordinate;
use common::scene::HeldInput;

/// A backlash that an output asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoughtBacklash {
    /// Coordinate that is moved.
    pub coordinate: Coordinate,
    /// Where the drives are held; `None` for all positions of a cycle.
    pub held: Option<HeldInput>,
}
