//! Dependence of random variables by a Gaussian copula: correlated standard normals, each transformed to the
//! distribution of its variable.
//!
//! ```text
//! f(x) = c(u) prod_k f_k(x_k),   c(u) = |R|^(-1/2) exp(-u' (R^-1 - I) u / 2),   u_k = Phi^-1(F_k(x_k))
//! ```
//!
//! f is the joint density, f_k and F_k the density and the distribution function of variable k, R the correlation
//! matrix `(d, d)` of the standard normals u `(d,)` [1]. Independent standard normals v give u = L v with R = L L', L
//! lower triangular. Valid for positive definite R; the coefficients of R belong to the normals, not to the variables.
//!
//! # Source
//! Nataf (1962), Determination des distributions de probabilites dont les marges sont donnees, Comptes Rendus de
//! l'Academie des Sciences 255; Lebrun, Dutfoy (2009), An innovating analysis of the Nataf transformation from the copula
//! viewpoint, Probabilistic Engineering Mechanics 24(3).

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Correlation of two of the variables.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Correlation {
    /// Index of one variable.
    pub first: usize,
    /// Index of the other variable.
    pub second: usize,
    /// Correlation coefficient of their standard normals, between -1 and 1 [1].
    pub coefficient: f64,
}

/// Correlation of two standard normals [1] with Spearman's rank correlation `rank` in [-1, 1] [1]: 2 sin(pi rank / 6).
///
/// The rank correlation of two variables equals that of their normals.
///
/// # Source
/// Kruskal (1958), Ordinal measures of association, Journal of the American Statistical Association 53(284).
pub fn normal_from_rank_correlation(rank: f64) -> f64 {
    2.0 * libm::sin(std::f64::consts::PI * rank / 6.0)
}

/// Correlations whose matrix is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "the matrix of the correlations is not positive definite: variable {variable} is determined by those before it, or contradicts them"
)]
pub struct NotPositiveDefinite {
    /// Index of the variable at which the factorisation ends.
    pub variable: usize,
}

/// Smallest variance of a normal given those before it [1]; below, the inverse of the matrix has no digits.
const LEAST_VARIANCE: f64 = 1e-10;

/// Correlation matrix of standard normals with its Cholesky factor and its inverse.
#[derive(Debug, Clone, PartialEq)]
pub struct GaussianCopula {
    d: usize,
    /// L `(d, d)` row-major, lower triangle.
    factor: Vec<f64>,
    /// R^-1 `(d, d)` row-major.
    inverse: Vec<f64>,
    /// True for each variable that is correlated to any other `(d,)`.
    correlated: Vec<bool>,
}

impl GaussianCopula {
    /// The copula of `d` independent variables.
    pub fn independent(d: usize) -> Self {
        let identity: Vec<f64> = (0..d * d).map(|i| if i / d == i % d { 1.0 } else { 0.0 }).collect();
        Self { d, inverse: identity.clone(), factor: identity, correlated: vec![false; d] }
    }

    /// The copula of `d` variables with correlations of pairs of distinct variables, each pair once; pairs without an
    /// entry are independent. Panics if an index is not below `d`.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`] if no variables can have these correlations together.
    pub fn new(d: usize, correlations: &[Correlation]) -> Result<Self, NotPositiveDefinite> {
        let mut copula = Self::independent(d);
        let mut matrix = copula.factor.clone();
        for Correlation { first, second, coefficient } in correlations {
            matrix[first * d + second] = *coefficient;
            matrix[second * d + first] = *coefficient;
            if *coefficient != 0.0 {
                copula.correlated[*first] = true;
                copula.correlated[*second] = true;
            }
        }
        // Cholesky, row by row.
        let l = &mut copula.factor;
        for i in 0..d {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| l[i * d + k] * l[j * d + k]).sum();
                let rest = matrix[i * d + j] - known;
                if i != j {
                    l[i * d + j] = rest / l[j * d + j];
                } else if rest > LEAST_VARIANCE {
                    l[i * d + i] = rest.sqrt();
                } else {
                    return Err(NotPositiveDefinite { variable: i });
                }
            }
        }
        copula.invert();
        Ok(copula)
    }

    /// Computes R^-1 column by column from L y = e, L' x = y.
    fn invert(&mut self) {
        let d = self.d;
        for column in 0..d {
            let unit: Vec<f64> = (0..d).map(|i| if i == column { 1.0 } else { 0.0 }).collect();
            let mut x = self.decorrelate(&unit);
            for i in (0..d).rev() {
                let known: f64 = (i + 1..d).map(|k| self.factor[k * d + i] * x[k]).sum();
                x[i] = (x[i] - known) / self.factor[i * d + i];
            }
            for (i, x) in x.into_iter().enumerate() {
                self.inverse[i * d + column] = x;
            }
        }
    }

    /// Number d of variables.
    pub fn dimension(&self) -> usize {
        self.d
    }

    /// True if no variable is correlated to another.
    pub fn is_independent(&self) -> bool {
        !self.correlated.contains(&true)
    }

    /// True if variable `k` is correlated to any other.
    pub fn is_correlated(&self, k: usize) -> bool {
        self.correlated[k]
    }

    /// Correlated normals u = L v `(d,)` [1] from independent ones v `(d,)` [1].
    pub fn correlate(&self, independent: &[f64]) -> Vec<f64> {
        let row = |i: usize| &self.factor[i * self.d..i * self.d + i + 1];
        // A zero of L excludes an uncorrelated variable, even if that is infinite.
        let product = |(l, v): (&f64, &f64)| if *l == 0.0 { 0.0 } else { l * v };
        (0..self.d).map(|i| row(i).iter().zip(independent).map(product).sum()).collect()
    }

    /// Independent normals v = L^-1 u `(d,)` [1] from correlated ones u `(d,)` [1].
    pub fn decorrelate(&self, correlated: &[f64]) -> Vec<f64> {
        let mut v = Vec::with_capacity(self.d);
        self.decorrelate_into(correlated, &mut v);
        v
    }

    fn decorrelate_into(&self, correlated: &[f64], v: &mut Vec<f64>) {
        v.clear();
        for (i, u) in correlated.iter().enumerate() {
            let row = &self.factor[i * self.d..];
            let known: f64 = row.iter().zip(&*v).map(|(l, v): (&f64, &f64)| l * v).sum();
            v.push((u - known) / row[i]);
        }
    }

    /// ln c(u) = (u'u - v'v) / 2 - ln |L| [1] of every row of normals u `(n, d)` row-major [1], with v = L^-1 u.
    pub fn log_densities(&self, u: &[f64]) -> Vec<f64> {
        let log_determinant: f64 = (0..self.d).map(|k| self.factor[k * self.d + k].ln()).sum();
        let square = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        let mut v = Vec::with_capacity(self.d);
        let of_row = |u: &[f64]| {
            self.decorrelate_into(u, &mut v);
            0.5 * (square(u) - square(&v)) - log_determinant
        };
        u.chunks_exact(self.d).map(of_row).collect()
    }

    /// Derivative d ln c / du_k = -((R^-1 - I) u)_k [1]; `u` returns a normal by its index and is called only for variables
    /// that k depends on.
    pub fn score(&self, k: usize, u: impl Fn(usize) -> f64) -> f64 {
        let row = &self.inverse[k * self.d..(k + 1) * self.d];
        let term = |(j, r): (usize, &f64)| {
            let weight = if j == k { r - 1.0 } else { *r };
            if weight == 0.0 { 0.0 } else { -weight * u(j) }
        };
        row.iter().enumerate().map(term).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn correlation(first: usize, second: usize, coefficient: f64) -> Correlation {
        Correlation { first, second, coefficient }
    }

    #[test]
    fn the_factor_has_its_closed_form() {
        let copula = GaussianCopula::new(3, &[correlation(0, 2, 0.6)]).unwrap();
        assert_eq!(copula.correlate(&[1.0, 5.0, 0.0]), [1.0, 5.0, 0.6]);
        let u = copula.correlate(&[0.3, -2.0, 1.5]);
        assert!((u[2] - (0.6 * 0.3 + 0.8 * 1.5)).abs() < 1e-15);
        for (back, v) in copula.decorrelate(&u).iter().zip([0.3, -2.0, 1.5]) {
            assert!((back - v).abs() < 1e-15);
        }
        assert!(copula.is_correlated(2) && !copula.is_correlated(1) && !copula.is_independent());
        assert!(GaussianCopula::new(2, &[]).unwrap().is_independent());
        assert_eq!(GaussianCopula::new(2, &[]).unwrap(), GaussianCopula::independent(2));
    }

    #[test]
    fn the_score_is_the_derivative_of_the_log_density() {
        let pairs = [correlation(0, 1, 0.5), correlation(1, 3, -0.7), correlation(0, 3, 0.1)];
        let copula = GaussianCopula::new(4, &pairs).unwrap();
        let log = |u: &[f64]| copula.log_densities(u)[0];
        let u = [0.4, -1.2, 2.0, 0.9];
        for k in 0..4 {
            let h = 1e-5;
            let at = |h: f64| {
                let mut u = u;
                u[k] += h;
                log(&u)
            };
            let exact = (at(h) - at(-h)) / (2.0 * h);
            assert!((copula.score(k, |j| u[j]) - exact).abs() < 1e-9, "{k}");
        }
        assert_eq!(copula.score(2, |j| u[j]), 0.0);
    }

    #[test]
    fn impossible_correlations_are_refused() {
        let pairs = [correlation(0, 1, 0.9), correlation(1, 2, 0.9), correlation(0, 2, -0.9)];
        assert_eq!(GaussianCopula::new(3, &pairs), Err(NotPositiveDefinite { variable: 2 }));
        assert_eq!(
            GaussianCopula::new(2, &[correlation(0, 1, 1.0)]),
            Err(NotPositiveDefinite { variable: 1 })
        );
    }

    #[test]
    fn rank_correlations_have_their_fixed_points() {
        for (rank, normal) in [(0.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (0.5, 0.517_638_090_205_041_5)] {
            assert!((normal_from_rank_correlation(rank) - normal).abs() < 1e-15);
        }
    }
}
