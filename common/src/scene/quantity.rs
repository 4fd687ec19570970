//! Physical dimensions, the kinds of quantity in a scene, and the units in which they may be written.
//!
//! Three base dimensions suffice for planar mechanics: kg, m, s. An angle is dimensionless.

use std::fmt;

/// Exponents of kg, m and s.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dimension {
    /// Exponent of the kilogram.
    pub kg: i16,
    /// Exponent of the metre.
    pub m: i16,
    /// Exponent of the second.
    pub s: i16,
}

impl Dimension {
    /// No dimension: plain numbers and angles.
    pub const NONE: Self = Self::new(0, 0, 0);

    const fn new(kg: i16, m: i16, s: i16) -> Self {
        Self { kg, m, s }
    }

    /// Dimension of a product.
    pub fn times(self, other: Self) -> Self {
        Self::new(
            self.kg.saturating_add(other.kg),
            self.m.saturating_add(other.m),
            self.s.saturating_add(other.s),
        )
    }

    /// Dimension of an integer power.
    pub fn power(self, n: i16) -> Self {
        Self::new(self.kg.saturating_mul(n), self.m.saturating_mul(n), self.s.saturating_mul(n))
    }

    /// Dimension of a square root, if every exponent is even.
    pub fn square_root(self) -> Option<Self> {
        (self.kg % 2 == 0 && self.m % 2 == 0 && self.s % 2 == 0)
            .then(|| Self::new(self.kg / 2, self.m / 2, self.s / 2))
    }

    /// The unit in SI base units, e.g. `kg m/s^2`; empty if there is no dimension.
    pub fn base_units(self) -> String {
        let factor = |symbol: &str, n: i16| match n {
            0 => None,
            1 => Some(symbol.to_owned()),
            n => Some(format!("{symbol}^{n}")),
        };
        let all = [("kg", self.kg), ("m", self.m), ("s", self.s)];
        let above: Vec<_> = all.iter().filter(|(_, n)| *n > 0).filter_map(|(u, n)| factor(u, *n)).collect();
        let below: Vec<_> =
            all.iter().filter(|(_, n)| *n < 0).filter_map(|(u, n)| factor(u, n.saturating_neg())).collect();
        match (above.is_empty(), below.is_empty()) {
            (true, true) => String::new(),
            (false, true) => above.join(" "),
            (true, false) => format!("1/{}", below.join("/")),
            (false, false) => format!("{}/{}", above.join(" "), below.join("/")),
        }
    }

    /// The usual SI unit, e.g. `N` for a force.
    pub fn si_unit(self) -> String {
        KINDS
            .iter()
            .find(|kind| kind.dimension == self)
            .map(|kind| kind.si.to_owned())
            .unwrap_or_else(|| self.base_units())
    }
}

/// The kind in words, e.g. `a force`.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match KINDS.iter().find(|kind| kind.dimension == *self) {
            Some(kind) => f.write_str(kind.name),
            None => write!(f, "a quantity in {}", self.base_units()),
        }
    }
}

/// A value in SI with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Value in SI units.
    pub value: f64,
    /// Dimension of the value.
    pub dimension: Dimension,
}

/// A kind of quantity that a field expects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    /// Name with its article, e.g. `a length`.
    pub name: &'static str,
    /// Dimension of the kind.
    pub dimension: Dimension,
    /// Units suggested in messages, separated by commas.
    pub units: &'static str,
    /// SI unit of the kind.
    pub si: &'static str,
}

impl Kind {
    /// The name, and in parentheses the units suggested.
    pub fn in_words(&self) -> String {
        let name = self.name;
        if self.units.is_empty() { name.to_owned() } else { format!("{name} ({}, ...)", self.units) }
    }

    /// The first kind of a dimension; a dimension without a kind gets one without units.
    pub fn from_dimension(dimension: Dimension) -> Kind {
        let unnamed = Kind { name: "the quantity that is changed", dimension, units: "", si: "" };
        KINDS.iter().copied().find(|kind| kind.dimension == dimension).unwrap_or(unnamed)
    }
}

macro_rules! kinds {
    ($($constant:ident $name:literal ($kg:literal $m:literal $s:literal) $units:literal $si:literal;)*) => {
        $(#[doc = concat!("Expects ", $name, ".")]
        pub const $constant: Kind =
            Kind { name: $name, dimension: Dimension::new($kg, $m, $s), units: $units, si: $si };)*
        /// Every kind; of two with the same dimension the first one names it.
        const KINDS: &[Kind] = &[$($constant),*];
    };
}

kinds! {
    NUMBER "a plain number" (0 0 0) "" "1";
    ANGLE "an angle" (0 0 0) "deg, rad" "rad";
    LENGTH "a length" (0 1 0) "mm, um, m" "m";
    MASS "a mass" (1 0 0) "g, kg" "kg";
    TIME "a time" (0 0 1) "s, ms" "s";
    INERTIA "a moment of inertia" (1 2 0) "kg m^2, g mm^2" "kg m^2";
    ANGULAR_VELOCITY "an angular velocity" (0 0 -1) "r/min, rad/s" "rad/s";
    SPEED "a speed" (0 1 -1) "mm/s, m/s" "m/s";
    ACCELERATION "an acceleration" (0 1 -2) "m/s^2" "m/s^2";
    FORCE "a force" (1 1 -2) "N, mN, kN" "N";
    TORQUE "a torque" (1 2 -2) "N m, N mm" "N m";
    STIFFNESS "a stiffness" (1 0 -2) "N/m, N/mm" "N/m";
    DAMPING "a damping" (1 0 -1) "N s/m" "N s/m";
    TORSIONAL_STIFFNESS "a torsional stiffness" (1 2 -2) "N m/rad, N m/deg" "N m/rad";
    TORSIONAL_DAMPING "a torsional damping" (1 2 -1) "N m s/rad" "N m s/rad";
    PRESSURE "a pressure" (1 -1 -2) "GPa, MPa, Pa" "Pa";
    INVERSE_PRESSURE "an inverse pressure" (-1 1 2) "1/Pa, mm^2/N" "1/Pa";
    INVERSE_SPEED "an inverse speed" (0 -1 1) "s/m" "s/m";
    AREA "an area" (0 2 0) "mm^2, m^2" "m^2";
    VOLUME "a volume" (0 3 0) "mm^3, m^3" "m^3";
}

/// A unit: SI value = number * multiply / divide. Two numbers, so that decimal prefixes round once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// Factor from the unit to SI.
    pub multiply: f64,
    /// Divisor from the unit to SI.
    pub divide: f64,
    /// Dimension of the unit.
    pub dimension: Dimension,
}

const TURN: f64 = 2.0 * std::f64::consts::PI;

/// A factor, a divisor and a dimension.
const fn unit_of(multiply: f64, divide: f64, dimension: Dimension) -> Unit {
    Unit { multiply, divide, dimension }
}

/// Every unit by its symbol. `Hz` is left out on purpose: it could mean turns or radians.
pub const UNITS: &[(&str, Unit)] = &[
    ("m", unit_of(1.0, 1.0, LENGTH.dimension)),
    ("km", unit_of(1e3, 1.0, LENGTH.dimension)),
    ("cm", unit_of(1.0, 1e2, LENGTH.dimension)),
    ("mm", unit_of(1.0, 1e3, LENGTH.dimension)),
    ("um", unit_of(1.0, 1e6, LENGTH.dimension)),
    ("\u{b5}m", unit_of(1.0, 1e6, LENGTH.dimension)),
    ("\u{3bc}m", unit_of(1.0, 1e6, LENGTH.dimension)),
    ("nm", unit_of(1.0, 1e9, LENGTH.dimension)),
    ("kg", unit_of(1.0, 1.0, MASS.dimension)),
    ("g", unit_of(1.0, 1e3, MASS.dimension)),
    ("mg", unit_of(1.0, 1e6, MASS.dimension)),
    ("s", unit_of(1.0, 1.0, TIME.dimension)),
    ("ms", unit_of(1.0, 1e3, TIME.dimension)),
    ("us", unit_of(1.0, 1e6, TIME.dimension)),
    ("min", unit_of(60.0, 1.0, TIME.dimension)),
    ("h", unit_of(3600.0, 1.0, TIME.dimension)),
    ("N", unit_of(1.0, 1.0, FORCE.dimension)),
    ("mN", unit_of(1.0, 1e3, FORCE.dimension)),
    ("kN", unit_of(1e3, 1.0, FORCE.dimension)),
    ("J", unit_of(1.0, 1.0, TORQUE.dimension)),
    ("Pa", unit_of(1.0, 1.0, PRESSURE.dimension)),
    ("kPa", unit_of(1e3, 1.0, PRESSURE.dimension)),
    ("MPa", unit_of(1e6, 1.0, PRESSURE.dimension)),
    ("GPa", unit_of(1e9, 1.0, PRESSURE.dimension)),
    ("rad", unit_of(1.0, 1.0, Dimension::NONE)),
    ("mrad", unit_of(1.0, 1e3, Dimension::NONE)),
    ("deg", unit_of(std::f64::consts::PI, 180.0, Dimension::NONE)),
    ("r", unit_of(TURN, 1.0, Dimension::NONE)),
    ("rev", unit_of(TURN, 1.0, Dimension::NONE)),
    ("rpm", unit_of(TURN, 60.0, ANGULAR_VELOCITY.dimension)),
    ("%", unit_of(1.0, 1e2, Dimension::NONE)),
];

/// The unit with a symbol, e.g. `mm`; none if the symbol is unknown.
pub fn unit(symbol: &str) -> Option<Unit> {
    UNITS.iter().find(|(known, _)| *known == symbol).map(|(_, unit)| *unit)
}
