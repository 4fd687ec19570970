//! Gear pairs, racks and belts: ideal joints of one condition on two turning bodies.
//!
//! phi = u . d + rho_a theta_a + rho_b theta_b is constant, d the vector from the place of b to that of a [m], u the fixed direction of the line
//! of action [1], rho the lever arms of its force [m]. The force along u and its moments are those of teeth on one flank, or of the taut strand
//! of a belt, so that the bearings carry them. Valid while the distance between the centres changes little, as in bearings with clearance.
//!
//! # Source
//! Norton (2011), Design of Machinery, section 9.

use serde::{Deserialize, Serialize};

/// Kinds of meshing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum MeshForm {
    /// Two wheels that turn in opposite directions.
    Gear,
    /// A wheel inside another one.
    InternalGear,
    /// Two pulleys and the strand on the left of the line from a to b.
    Belt,
    /// A straight rack, of which the place a is on the pitch line, and a wheel about the place b.
    Rack,
}

/// A gear pair, a rack or a belt.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Wheels, a rack or a belt.
    pub form: MeshForm,
    /// Pitch radii of a and b; of a rack zero `(2,)` [m].
    pub radii: [f64; 2],
    /// Angle of the line of action to the common tangent of the pitch circles [rad].
    pub pressure_angle: f64,
    /// Direction u of the line of action in the global frame `(2,)` [1].
    pub direction: [f64; 2],
    /// Lever arms rho of the force on a and on b, counter-clockwise positive `(2,)` [m].
    pub arms: [f64; 2],
    /// Value of phi that the joint keeps [m].
    pub value: f64,
}
