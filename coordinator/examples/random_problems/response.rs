//! Responses of random problems: sums of simple terms over the standardised variables, and the largest or least of
//! several sums.

use common::random::standard_normal_quantile;

/// One term of a sum, over the standardised variables z `(d,)` [1].
#[derive(Debug, Clone, PartialEq)]
pub enum Term {
    /// w . z
    Plane(Vec<f64>),
    /// amplitude cos(w . z + phase)
    Wave {
        /// Amplitude [1].
        amplitude: f64,
        /// Frequency w `(d,)` [rad].
        frequency: Vec<f64>,
        /// Phase [rad].
        phase: f64,
    },
    /// Product over the factors (w, phase) of sin(w . z + phase)
    Product(Vec<(Vec<f64>, f64)>),
    /// slope max(0, w . z - kink)
    Hinge {
        /// Slope beyond the kink [1].
        slope: f64,
        /// Direction w `(d,)` [1].
        direction: Vec<f64>,
        /// Place of the kink along the direction [1].
        kink: f64,
    },
    /// curvature (w . z)^2
    Parabola {
        /// Curvature [1].
        curvature: f64,
        /// Direction w `(d,)` [1].
        direction: Vec<f64>,
    },
    /// height beyond w . z = edge, zero before
    Jump {
        /// Height [1].
        height: f64,
        /// Direction w `(d,)` [1].
        direction: Vec<f64>,
        /// Place of the jump along the direction [1].
        edge: f64,
    },
    /// height exp(-|z - centre|^2 / (2 width^2)); a valley with a height below zero
    Bump {
        /// Height [1].
        height: f64,
        /// Centre `(d,)` [1].
        centre: Vec<f64>,
        /// Width [1].
        width: f64,
    },
    /// height (1 + tanh((w . z - edge) / width)) / 2
    Step {
        /// Height [1].
        height: f64,
        /// Direction w `(d,)` [1].
        direction: Vec<f64>,
        /// Place of the step along the direction [1].
        edge: f64,
        /// Width [1].
        width: f64,
    },
    /// Product of a [`Term::Step`] and a [`Term::Wave`]
    Ridge(Box<Term>, Box<Term>),
    /// exponent ln(mean (1 + cov z_k)): the logarithm of a power of a positive variable
    Logarithm {
        /// Exponent [1].
        exponent: f64,
        /// Index k of the variable.
        variable: usize,
        /// Mean of the variable in the unit of the response.
        mean: f64,
        /// Its coefficient of variation [1].
        cov: f64,
    },
}

/// Scalar product.
pub fn dot(w: &[f64], z: &[f64]) -> f64 {
    w.iter().zip(z).map(|(w, z)| w * z).sum()
}

impl Term {
    /// Value of the term at z `(d,)` [1].
    fn value(&self, z: &[f64]) -> f64 {
        match self {
            Self::Plane(w) => dot(w, z),
            Self::Wave { amplitude, frequency, phase } => amplitude * (dot(frequency, z) + phase).cos(),
            Self::Product(factors) => factors.iter().map(|(w, phase)| (dot(w, z) + phase).sin()).product(),
            Self::Hinge { slope, direction, kink } => slope * (dot(direction, z) - kink).max(0.0),
            Self::Parabola { curvature, direction } => curvature * dot(direction, z).powi(2),
            Self::Jump { height, direction, edge } => {
                if dot(direction, z) > *edge {
                    *height
                } else {
                    0.0
                }
            }
            Self::Bump { height, centre, width } => {
                let square: f64 = z.iter().zip(centre).map(|(z, c)| (z - c).powi(2)).sum();
                height * (-0.5 * square / width.powi(2)).exp()
            }
            Self::Step { height, direction, edge, width } => {
                0.5 * height * (1.0 + ((dot(direction, z) - edge) / width).tanh())
            }
            Self::Ridge(step, wave) => step.value(z) * wave.value(z),
            Self::Logarithm { exponent, variable, mean, cov } => {
                // Rounding leaves no value at or below zero.
                exponent * (mean * (1.0 + cov * z[*variable]).max(f64::EPSILON)).ln()
            }
        }
    }
}

/// A response over the standardised variables; larger is worse.
#[derive(Debug, Clone, PartialEq)]
pub enum Response {
    /// Sum of terms.
    Sum(Vec<Term>),
    /// The largest of several: any of them fails.
    Largest(Vec<Response>),
    /// The least of several: all of them fail.
    Least(Vec<Response>),
}

impl Response {
    /// Value of the response at z `(d,)` [1].
    pub fn value(&self, z: &[f64]) -> f64 {
        match self {
            Self::Sum(terms) => terms.iter().map(|term| term.value(z)).sum(),
            Self::Largest(parts) => parts.iter().map(|part| part.value(z)).fold(f64::NEG_INFINITY, f64::max),
            Self::Least(parts) => parts.iter().map(|part| part.value(z)).fold(f64::INFINITY, f64::min),
        }
    }
}

/// A number in (0, 1) that jumps from point to point: a hash of the bits of x `(d,)`.
pub fn hash_to_unit(x: &[f64], salt: u64) -> f64 {
    let mix = |mut h: u64| {
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        h ^ (h >> 31)
    };
    let hash = x.iter().fold(mix(salt.wrapping_add(0x9e37_79b9_7f4a_7c15)), |h, x| {
        mix(h.wrapping_add(0x9e37_79b9_7f4a_7c15) ^ x.to_bits())
    });
    ((hash >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// Standard normal noise [1] that jumps from point to point.
pub fn hash_to_normal(x: &[f64], salt: u64) -> f64 {
    standard_normal_quantile(hash_to_unit(x, salt))
}
