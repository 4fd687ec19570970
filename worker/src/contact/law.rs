//! What contact laws say of the elastic part of a contact and of its pressure.

/// Distribution of the contact pressure along the bore, for wear.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pressure {
    /// Uniform along the contact arc AB between journal circle and bore.
    UniformOverArc,
    /// That of an elastic foundation.
    Foundation,
}

/// The elastic part of a contact; all zero in free flight.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Elastic {
    /// Stored energy [J].
    pub stored: f64,
    /// Force F_el [N].
    pub force: f64,
    /// delta_dot: the rate of the stored energy is force times this [m/s].
    pub rate: f64,
}
