//! Interpolation: cubic Hermite polynomials, and the periodic tridiagonal system of cubic splines.
//!
//! Hermite: y(s) = y0 + s (d0 + s (3 r - 2 d0 - d1 + s (d0 + d1 - 2 r))), r = y1 - y0, with the values y0, y1
//! and the slopes d0, d1 per interval at its ends, s in [0, 1].
//!
//! # Source
//! Periodic tridiagonal systems by the formula of Sherman and Morrison: Press, Teukolsky, Vetterling, Flannery (2007), Numerical
//! Recipes, chapter 2.7.

/// Cubic a + s (b + s (c + s d)) in the fraction s of an interval: the coefficients [a, b, c, d].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cubic(pub [f64; 4]);

impl Cubic {
    /// Cubic through the values `y` `(2,)` with the slopes `d` `(2,)` at the ends of the interval, slopes per
    /// length of the interval.
    #[inline(always)]
    pub(crate) fn hermite([y0, y1]: [f64; 2], [d0, d1]: [f64; 2]) -> Self {
        let rise = y1 - y0;
        Cubic([y0, d0, 3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise])
    }

    /// Value at the fraction `s`.
    #[inline(always)]
    pub(crate) fn value(&self, s: f64) -> f64 {
        let [a, b, c, d] = self.0;
        a + s * (b + s * (c + s * d))
    }

    /// First derivative to s at the fraction `s`.
    #[inline(always)]
    pub(crate) fn slope(&self, s: f64) -> f64 {
        let [_, b, c, d] = self.0;
        b + s * (2.0 * c + 3.0 * s * d)
    }

    /// Second derivative to s at the fraction `s`.
    #[inline(always)]
    pub(crate) fn curvature(&self, s: f64) -> f64 {
        let [_, _, c, d] = self.0;
        2.0 * c + 6.0 * s * d
    }
}

/// The periodic tridiagonal matrix with 4 on its diagonal and 1 next to it, factorised: A + u v' with A
/// tridiagonal, u = (g, 0, .., 1), v = (1, 0, .., 1/g), g = -4 (Sherman and Morrison).
#[derive(Debug, Clone, PartialEq)]
pub struct PeriodicTridiagonal {
    /// Inverse pivots of A `(n,)`.
    inverse: Vec<f64>,
    /// A^-1 u `(n,)`.
    z: Vec<f64>,
    /// 1 / (1 + v'z).
    share: f64,
}

/// g of [`PeriodicTridiagonal`].
const GAMMA: f64 = -4.0;

impl PeriodicTridiagonal {
    /// The matrix `(n, n)`, for n of 3 at least.
    pub(crate) fn new(n: usize) -> Self {
        let (mut inverse, mut z) = (vec![1.0 / (4.0 - GAMMA); n], vec![0.0; n]);
        for i in 1..n {
            let diagonal = if i == n - 1 { 4.0 - 1.0 / GAMMA } else { 4.0 };
            inverse[i] = 1.0 / (diagonal - inverse[i - 1]);
        }
        (z[0], z[n - 1]) = (GAMMA, 1.0);
        eliminate(&inverse, &mut z);
        let share = 1.0 / (1.0 + z[0] + z[n - 1] / GAMMA);
        PeriodicTridiagonal { inverse, z, share }
    }

    /// Replaces the right-hand side `y` `(n,)` by the solution.
    pub(crate) fn solve(&self, y: &mut [f64]) {
        eliminate(&self.inverse, y);
        let factor = (y[0] + y[y.len() - 1] / GAMMA) * self.share;
        y.iter_mut().zip(&self.z).for_each(|(y, z)| *y -= factor * z);
    }
}

/// Solves A x = y by the inverse pivots of A; x replaces y.
fn eliminate(inverse: &[f64], y: &mut [f64]) {
    let n = y.len();
    y[0] *= inverse[0];
    for i in 1..n {
        y[i] = (y[i] - y[i - 1]) * inverse[i];
    }
    for i in (0..n - 1).rev() {
        y[i] -= inverse[i] * y[i + 1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hermite_cubic_has_the_values_and_slopes_of_its_ends() {
        let cubic = Cubic::hermite([2.0, -1.0], [0.5, 3.0]);
        assert_eq!([cubic.value(0.0), cubic.slope(0.0)], [2.0, 0.5]);
        assert!((cubic.value(1.0) + 1.0).abs() < 1e-15 && (cubic.slope(1.0) - 3.0).abs() < 1e-14);
        let (s, h) = (0.3, 1e-6);
        let difference = (cubic.slope(s + h) - cubic.slope(s - h)) / (2.0 * h);
        assert!((cubic.curvature(s) - difference).abs() < 1e-8);
    }

    #[test]
    fn the_periodic_system_is_solved() {
        for n in [3, 4, 36] {
            let x: Vec<f64> = (0..n).map(|i| (1.3 * i as f64).sin()).collect();
            let mut y: Vec<f64> = (0..n).map(|i| x[(i + n - 1) % n] + 4.0 * x[i] + x[(i + 1) % n]).collect();
            PeriodicTridiagonal::new(n).solve(&mut y);
            for (x, y) in x.iter().zip(&y) {
                assert!((x - y).abs() < 1e-14, "{x} against {y}");
            }
        }
    }
}
