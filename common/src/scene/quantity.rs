//! Physical dimensions, the kinds of quantity in a scene, and the units in which they may be written.
//!
//! Three base dimensions suffice for planar mechanics: kg, m, s. An angle is dimensionless; whether a unit of angle was written is
//! kept beside the dimension, so that `900 1/min` is no angular velocity and `3 deg` no coefficient of friction.

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
        let Self { kg, m, s } = other;
        Self::new(self.kg.saturating_add(kg), self.m.saturating_add(m), self.s.saturating_add(s))
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
        let factors = |sign: i16| -> Vec<String> {
            let factor = |(symbol, n): &(&str, i16)| match n.saturating_abs() {
                1 => (*symbol).to_owned(),
                n => format!("{symbol}^{n}"),
            };
            let all = [("kg", self.kg), ("m", self.m), ("s", self.s)];
            all.iter().filter(|(_, n)| n.signum() == sign).map(factor).collect()
        };
        let (above, below) = (factors(1).join(" "), factors(-1).join("/"));
        match (above.is_empty(), below.is_empty()) {
            (_, true) => above,
            (true, false) => format!("1/{below}"),
            (false, false) => format!("{above}/{below}"),
        }
    }

    /// The usual SI unit, e.g. `N` for a force.
    pub fn si_unit(self) -> String {
        let kind = KINDS.iter().find(|kind| kind.dimension == self);
        kind.map_or_else(|| self.base_units(), |kind| kind.si.to_owned())
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

/// Whether a quantity was written with a unit of angle (`deg`, `rad`, `r`, ...).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AngleUnit {
    /// Written without one.
    Absent,
    /// Written with one.
    Present,
    /// The result of a calculation that may stand for either, such as `2 * pi` or a speed over a radius.
    #[default]
    Open,
}

impl AngleUnit {
    /// That of a sum.
    pub(super) fn plus(self, other: Self) -> Self {
        if self == other { self } else { AngleUnit::Open }
    }
}

/// A value in SI with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Value in SI units.
    pub value: f64,
    /// Dimension of the value.
    pub dimension: Dimension,
    /// Whether a unit of angle is part of it.
    pub angle: AngleUnit,
}

impl Quantity {
    /// A number without any unit.
    pub fn plain(value: f64) -> Self {
        Quantity { value, dimension: Dimension::NONE, angle: AngleUnit::Absent }
    }

    /// True if no unit at all is part of it.
    pub(super) fn is_plain_number(&self) -> bool {
        self.dimension == Dimension::NONE && self.angle == AngleUnit::Absent
    }

    /// The kind of quantities that can stand in the place of this one; a dimension without a kind gets one without units.
    pub fn kind(&self) -> Kind {
        match (self.dimension, self.angle) {
            (Dimension::NONE, AngleUnit::Present) => ANGLE,
            (Dimension::NONE, AngleUnit::Absent) => NUMBER,
            (dimension, AngleUnit::Present) if dimension == ANGULAR_VELOCITY.dimension => ANGULAR_VELOCITY,
            (dimension, _) => Kind::from_dimension(dimension),
        }
    }
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
    /// Whether its units have one of angle; open where both occur.
    pub angle: AngleUnit,
}

impl Kind {
    /// True if a quantity with or without a unit of angle is of this kind.
    pub fn takes(&self, angle: AngleUnit) -> bool {
        let open = self.angle == AngleUnit::Open || angle == AngleUnit::Open;
        open || self.angle == angle
    }

    /// True if a number without a unit is of this kind.
    pub(super) fn takes_bare_numbers(&self) -> bool {
        self.dimension == Dimension::NONE && self.angle != AngleUnit::Present
    }

    /// The name, and in parentheses the units suggested.
    pub fn in_words(&self) -> String {
        let name = self.name;
        if self.units.is_empty() { name.to_owned() } else { format!("{name} ({}, ...)", self.units) }
    }

    /// The first kind of a dimension, with or without a unit of angle; a dimension without a kind gets one without units.
    pub fn from_dimension(dimension: Dimension) -> Kind {
        let angle = AngleUnit::Open;
        let unnamed = Kind { name: "the quantity that is changed", dimension, units: "", si: "", angle };
        let found = KINDS.iter().find(|kind| kind.dimension == dimension);
        found.map_or(unnamed, |kind| Kind { angle, ..*kind })
    }
}

macro_rules! kinds {
    ($($constant:ident $name:literal ($kg:literal $m:literal $s:literal) $units:literal $si:literal $angle:ident;)*) => {
        $(#[doc = concat!("Expects ", $name, ".")]
        pub const $constant: Kind = Kind {
            name: $name,
            dimension: Dimension::new($kg, $m, $s),
            units: $units,
            si: $si,
            angle: AngleUnit::$angle,
        };)*
        /// Every kind; of two with the same dimension the first one names it.
        pub const KINDS: &[Kind] = &[$($constant),*];
    };
}

kinds! {
    NUMBER "a plain number" (0 0 0) "" "1" Absent;
    ANGLE "an angle" (0 0 0) "deg, rad" "rad" Present;
    LENGTH "a length" (0 1 0) "mm, um, m" "m" Open;
    MASS "a mass" (1 0 0) "g, kg" "kg" Open;
    TIME "a time" (0 0 1) "s, ms" "s" Open;
    INERTIA "a moment of inertia" (1 2 0) "kg m^2, g mm^2" "kg m^2" Open;
    ANGULAR_VELOCITY "an angular velocity" (0 0 -1) "r/min, rad/s" "rad/s" Present;
    SPEED "a speed" (0 1 -1) "mm/s, m/s" "m/s" Open;
    ACCELERATION "an acceleration" (0 1 -2) "m/s^2" "m/s^2" Open;
    ANGULAR_ACCELERATION "an angular acceleration" (0 0 -2) "rad/s^2" "rad/s^2" Present;
    FORCE "a force" (1 1 -2) "N, mN, kN" "N" Open;
    TORQUE "a torque" (1 2 -2) "N m, N mm" "N m" Open;
    ENERGY "an energy" (1 2 -2) "J, mJ" "J" Open;
    STIFFNESS "a stiffness" (1 0 -2) "N/m, N/mm" "N/m" Open;
    DAMPING "a damping" (1 0 -1) "N s/m" "N s/m" Open;
    TORSIONAL_STIFFNESS "a torsional stiffness" (1 2 -2) "N m/rad, N m/deg" "N m/rad" Open;
    TORSIONAL_DAMPING "a torsional damping" (1 2 -1) "N m s/rad" "N m s/rad" Open;
    DRAG "a quadratic drag" (1 -1 0) "N s^2/m^2, kg/m" "N s^2/m^2" Open;
    TORSIONAL_DRAG "a quadratic torsional drag" (1 2 0) "N m s^2/rad^2" "N m s^2/rad^2" Open;
    PRESSURE "a pressure" (1 -1 -2) "GPa, MPa, Pa" "Pa" Open;
    INVERSE_PRESSURE "an inverse pressure" (-1 1 2) "1/Pa, mm^2/N" "1/Pa" Open;
    INVERSE_SPEED "an inverse speed" (0 -1 1) "s/m" "s/m" Open;
    AREA "an area" (0 2 0) "mm^2, m^2" "m^2" Open;
    DENSITY "a density" (1 -3 0) "kg/m^3, g/cm^3" "kg/m^3" Open;
    VOLUME "a volume" (0 3 0) "mm^3, m^3" "m^3" Open;
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
    /// Whether it is a unit of angle or contains one.
    pub angle: AngleUnit,
}

/// 1e13 lbf [N], exactly: 0.45359237 kg times 9.80665 m/s^2.
const POUND_FORCE: f64 = 44_482_216_152_605.0;

const TURN: f64 = 2.0 * std::f64::consts::PI;

/// A factor, a divisor and a dimension.
const fn unit_of(multiply: f64, divide: f64, dimension: Dimension) -> Unit {
    Unit { multiply, divide, dimension, angle: AngleUnit::Absent }
}

/// A unit of angle, or one that contains it.
const fn angular(multiply: f64, divide: f64, dimension: Dimension) -> Unit {
    Unit { multiply, divide, dimension, angle: AngleUnit::Present }
}

/// Every unit by its symbol, with its exact definition. `Hz` is left out on purpose: it could mean turns or radians.
pub const UNITS: &[(&str, Unit)] = &[
    ("m", unit_of(1.0, 1.0, LENGTH.dimension)),
    ("km", unit_of(1e3, 1.0, LENGTH.dimension)),
    ("cm", unit_of(1.0, 1e2, LENGTH.dimension)),
    ("mm", unit_of(1.0, 1e3, LENGTH.dimension)),
    ("um", unit_of(1.0, 1e6, LENGTH.dimension)),
    ("\u{b5}m", unit_of(1.0, 1e6, LENGTH.dimension)),
    ("\u{3bc}m", unit_of(1.0, 1e6, LENGTH.dimension)),
    ("nm", unit_of(1.0, 1e9, LENGTH.dimension)),
    ("in", unit_of(254.0, 1e4, LENGTH.dimension)),
    ("ft", unit_of(3048.0, 1e4, LENGTH.dimension)),
    ("mil", unit_of(254.0, 1e7, LENGTH.dimension)),
    ("kg", unit_of(1.0, 1.0, MASS.dimension)),
    ("g", unit_of(1.0, 1e3, MASS.dimension)),
    ("mg", unit_of(1.0, 1e6, MASS.dimension)),
    ("lb", unit_of(45_359_237.0, 1e8, MASS.dimension)),
    ("oz", unit_of(45_359_237.0, 16e8, MASS.dimension)),
    ("slug", unit_of(POUND_FORCE, 3048e9, MASS.dimension)),
    ("s", unit_of(1.0, 1.0, TIME.dimension)),
    ("ms", unit_of(1.0, 1e3, TIME.dimension)),
    ("us", unit_of(1.0, 1e6, TIME.dimension)),
    ("min", unit_of(60.0, 1.0, TIME.dimension)),
    ("h", unit_of(3600.0, 1.0, TIME.dimension)),
    ("N", unit_of(1.0, 1.0, FORCE.dimension)),
    ("mN", unit_of(1.0, 1e3, FORCE.dimension)),
    ("kN", unit_of(1e3, 1.0, FORCE.dimension)),
    ("MN", unit_of(1e6, 1.0, FORCE.dimension)),
    ("kgf", unit_of(980_665.0, 1e5, FORCE.dimension)),
    ("lbf", unit_of(POUND_FORCE, 1e13, FORCE.dimension)),
    ("ozf", unit_of(POUND_FORCE, 16e13, FORCE.dimension)),
    ("kip", unit_of(POUND_FORCE, 1e10, FORCE.dimension)),
    ("mJ", unit_of(1.0, 1e3, TORQUE.dimension)),
    ("J", unit_of(1.0, 1.0, TORQUE.dimension)),
    ("Pa", unit_of(1.0, 1.0, PRESSURE.dimension)),
    ("kPa", unit_of(1e3, 1.0, PRESSURE.dimension)),
    ("MPa", unit_of(1e6, 1.0, PRESSURE.dimension)),
    ("GPa", unit_of(1e9, 1.0, PRESSURE.dimension)),
    ("bar", unit_of(1e5, 1.0, PRESSURE.dimension)),
    ("mbar", unit_of(1e2, 1.0, PRESSURE.dimension)),
    ("psi", unit_of(POUND_FORCE, 645_160e4, PRESSURE.dimension)),
    ("ksi", unit_of(POUND_FORCE, 645_160e1, PRESSURE.dimension)),
    ("Msi", unit_of(POUND_FORCE, 6451.6, PRESSURE.dimension)),
    ("rad", angular(1.0, 1.0, Dimension::NONE)),
    ("mrad", angular(1.0, 1e3, Dimension::NONE)),
    ("deg", angular(std::f64::consts::PI, 180.0, Dimension::NONE)),
    ("arcmin", angular(std::f64::consts::PI, 10_800.0, Dimension::NONE)),
    ("arcsec", angular(std::f64::consts::PI, 648_000.0, Dimension::NONE)),
    ("r", angular(TURN, 1.0, Dimension::NONE)),
    ("rev", angular(TURN, 1.0, Dimension::NONE)),
    ("rpm", angular(TURN, 60.0, ANGULAR_VELOCITY.dimension)),
    ("%", unit_of(1.0, 1e2, Dimension::NONE)),
];

/// The unit with a symbol, e.g. `mm`; none if the symbol is unknown.
pub fn unit(symbol: &str) -> Option<Unit> {
    UNITS.iter().find(|(known, _)| *known == symbol).map(|(_, unit)| *unit)
}
