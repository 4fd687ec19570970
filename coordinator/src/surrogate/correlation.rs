//! Anisotropic Gaussian correlation: r(x, x') = exp(-sum_k theta_k (x_k - x'_k)^2).

use faer::linalg::matmul::matmul;
use faer::prelude::ReborrowMut;
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Parameters of the correlation of one surrogate.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// theta_k = 1 / (2 length_k^2), in standardised inputs `(d,)` [1].
    pub theta: Vec<f64>,
    /// Variance of the noise that is the same at every point over the process variance, added to the diagonal [1].
    pub nugget: f64,
    /// Mean variance of the noise that goes with the errors the simulations state over the process variance; added
    /// to the diagonal times each point's weight, see [`super::NoiseShape`] [1].
    pub stated: f64,
}

impl Correlation {
    /// Variance over the process variance that the noise of one more point can be expected to have [1].
    pub fn noise(&self) -> f64 {
        self.nugget + self.stated
    }

    /// Adds the noise to the diagonal of a correlation matrix `(n, n)`; `weights` `(n,)` of mean 1.
    pub(crate) fn add_noise(&self, matrix: &mut Mat<f64>, weights: Option<&[f64]>) {
        for i in 0..matrix.nrows() {
            matrix[(i, i)] += self.nugget + weights.map_or(0.0, |weights| self.stated * weights[i]);
        }
    }

    /// Points `(d, n)` multiplied by sqrt(theta), so that correlation is exp(-distance^2).
    pub(crate) fn scale(&self, points: MatRef<'_, f64>) -> Mat<f64> {
        let root: Vec<f64> = self.theta.iter().map(|theta| theta.sqrt()).collect();
        Mat::from_fn(points.nrows(), points.ncols(), |k, i| root[k] * points[(k, i)])
    }
}

/// Correlation matrix `(n, n)` of points `(d, n)`, without the nugget; the diagonal is exactly 1.
pub fn correlation_matrix(correlation: &Correlation, points: MatRef<'_, f64>) -> Mat<f64> {
    let scaled = correlation.scale(points);
    let mut r = cross_of_scaled(scaled.as_ref(), scaled.as_ref());
    for i in 0..points.ncols() {
        r[(i, i)] = 1.0;
        for j in 0..i {
            r[(j, i)] = r[(i, j)];
        }
    }
    r
}

/// Correlation `(n, b)` between points `(d, n)` and points `(d, b)`, without the nugget.
pub fn cross_correlation(correlation: &Correlation, a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    cross_of_scaled(correlation.scale(a).as_ref(), correlation.scale(b).as_ref())
}

/// exp(-|a_i - b_j|^2) through one matrix product: |a|^2 + |b|^2 - 2 a.b, held at or above zero against rounding.
pub(crate) fn cross_of_scaled(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut r = Mat::zeros(a.ncols(), b.ncols());
    cross_of_scaled_into(r.as_mut(), a, &squared_norms(a), b);
    r
}

/// As [`cross_of_scaled`], into `(n, b)` and with the squared norms of `a` known.
pub(crate) fn cross_of_scaled_into(
    mut r: MatMut<'_, f64>,
    a: MatRef<'_, f64>,
    a_norms: &[f64],
    b: MatRef<'_, f64>,
) {
    matmul(r.as_mut(), Accum::Replace, a.transpose(), b, 2.0, Par::Seq);
    let b_norms = squared_norms(b);
    for (j, b_norm) in b_norms.into_iter().enumerate() {
        let column = r.rb_mut().col_mut(j).try_as_col_major_mut().expect("blocks are column-major");
        for (value, a_norm) in column.as_slice_mut().iter_mut().zip(a_norms) {
            *value = exp_nonpositive(*value - a_norm - b_norm);
        }
    }
}

/// e^x for x <= 0 (greater x, which only rounding can give, count as 0), to 2 units in the last place; below
/// x = -200, where a correlation of 1e-87 is nothing, e^-200.
///
/// Reduction x = k ln 2 + r, |r| <= ln 2 / 2, and the exponential series to degree 13 (remainder 4e-18). Written without
/// branches so that the compiler makes vectors of it, and without calls into the system's mathematical library: its
/// `exp` takes 330 ns instead of 5 after a matrix product has left the upper halves of the vector registers in use
/// (measured on an AVX-512 machine), and its bits differ between systems.
fn exp_nonpositive(x: f64) -> f64 {
    // Adding 1.5 * 2^52 rounds to an integer, which then stands in the lowest bits.
    const ROUND: f64 = 6_755_399_441_055_744.0;
    // ln 2 in two parts, the first with trailing zeros so that k ln 2 is exact.
    const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
    const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
    let x = x.clamp(-200.0, 0.0);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let k = shifted - ROUND;
    let r = (x - k * LN2_HIGH) - k * LN2_LOW;
    let mut series = 1.0 / 6_227_020_800.0;
    for inverse_factorial in [
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5_040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ] {
        series = series * r + inverse_factorial;
    }
    series * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

/// Squared norm of each column.
pub(crate) fn squared_norms(points: MatRef<'_, f64>) -> Vec<f64> {
    points.col_iter().map(|column| column.iter().map(|x| x * x).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_accurate_to_two_units_in_the_last_place() {
        assert_eq!(exp_nonpositive(0.0), 1.0);
        assert_eq!(exp_nonpositive(1e-17), 1.0);
        for i in 0..200_000 {
            let x = -199.9 * (f64::from(i) / 200_000.0).powi(3);
            let exact = x.exp();
            assert!((exp_nonpositive(x) - exact).abs() <= 2.0 * f64::EPSILON * exact, "{x}");
        }
        assert!(exp_nonpositive(-1e9) > 0.0 && exp_nonpositive(-1e9) < 1e-86);
    }

    #[test]
    fn matches_the_definition() {
        let correlation = Correlation { theta: vec![0.3, 2.0], nugget: 0.0, stated: 0.0 };
        let points = Mat::from_fn(2, 5, |k, i| (i as f64 * 0.7 + k as f64).sin() * 1.5);
        let r = correlation_matrix(&correlation, points.as_ref());
        for i in 0..5 {
            for j in 0..5 {
                let exponent: f64 =
                    (0..2).map(|k| correlation.theta[k] * (points[(k, i)] - points[(k, j)]).powi(2)).sum();
                assert!((r[(i, j)] - (-exponent).exp()).abs() < 1e-14);
            }
        }
    }
}
