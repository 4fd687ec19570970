//! The random inputs of a study: distributions, dependence, and the transformations between the three spaces
//! of a point.
//!
//! - independent standard normals v `(d,)` [1];
//! - physical values x `(d,)` [SI]: u = L v are normals with the correlation matrix L L' of the copula, and
//!   x_k = F_k^-1(Phi(u_k)) with F_k the distribution function of variable k;
//! - standardised values z `(d,)` [1], the inputs of the surrogates: z_k = (x_k - location_k) / scale_k, or the same of ln x_k
//!   where a positive variable scatters over a factor. Location and scale are those of the variables, or of another model
//!   of the same variables ([`InputModel::standardised_as`]).
//!
//! # Source
//! Gaussian copula (Nataf transformation): Liu, Der Kiureghian (1986), Multivariate distribution models with
//! prescribed marginals and covariances, Probabilistic Engineering Mechanics 1(2).

use super::coordinate::Coordinate;
use common::random::{Distribution, GaussianCopula, standard_normal_quantile};
use common::scene::Scene;

/// Distributions and dependence of d random variables.
#[derive(Debug, Clone, PartialEq)]
pub struct InputModel {
    variables: Vec<Distribution>,
    /// Dependence of the variables.
    pub copula: GaussianCopula,
    /// Coordinate by which each variable is standardised `(d,)`.
    coordinates: Vec<Coordinate>,
}

impl InputModel {
    /// Variables with the dependence of a copula of the same dimension.
    pub fn new(variables: Vec<Distribution>, copula: GaussianCopula) -> Self {
        assert_eq!(variables.len(), copula.dimension(), "a copula has the dimension of its variables");
        let coordinates = variables.iter().map(Coordinate::of).collect();
        Self { variables, copula, coordinates }
    }

    /// The same variables, standardised as those of `other`, a model of the same dimension: a point then has the same
    /// coordinates under both models, whatever their distributions. A variable that is constant in `other`, and has not its
    /// coordinate from a third model, keeps its own scale, and one that may become negative where `other` has its logarithm its own coordinate.
    pub fn standardised_as(mut self, other: &Self) -> Self {
        assert_eq!(self.dimension(), other.dimension(), "both models have the same variables");
        for (k, own) in self.coordinates.iter_mut().enumerate() {
            let before = other.coordinates[k];
            let is_scaled =
                !other.variables[k].is_constant() || before != Coordinate::of(&other.variables[k]);
            if is_scaled && before.fits(&self.variables[k]) {
                *own = before;
            }
        }
        self
    }

    /// The random variables of a scene.
    pub fn from_scene(scene: &Scene) -> Self {
        let variables: Vec<_> =
            scene.variables.iter().map(|variable| variable.distribution.clone()).collect();
        let copula = GaussianCopula::new(variables.len(), &scene.correlations);
        Self::new(variables, copula.expect("checked when the scene was read"))
    }

    /// Number of variables d.
    pub fn dimension(&self) -> usize {
        self.variables.len()
    }

    /// Distributions of the variables `(d,)`.
    pub fn variables(&self) -> &[Distribution] {
        &self.variables
    }

    /// The means of the variables `(d,)` [SI].
    pub fn means(&self) -> Vec<f64> {
        self.variables.iter().map(|variable| variable.mean()).collect()
    }

    /// x `(d,)` [SI] from probabilities p in (0, 1) `(d,)` [1] of the independent normals v = Phi^-1(p).
    ///
    /// A variable without correlations is the quantile of its own p, independent of the others.
    pub fn from_uniforms(&self, p: &[f64]) -> Vec<f64> {
        let alone = |(variable, p): (&Distribution, &f64)| variable.quantile(*p);
        if self.copula.is_independent() {
            return self.variables.iter().zip(p).map(alone).collect();
        }
        let v: Vec<f64> = p.iter().map(|p| standard_normal_quantile(*p)).collect();
        let u = self.copula.correlate(&v);
        let value = |(k, variable): (usize, &Distribution)| {
            let is_alone = !self.copula.is_correlated(k);
            if is_alone { variable.quantile(p[k]) } else { variable.from_standard_normal(u[k]) }
        };
        self.variables.iter().enumerate().map(value).collect()
    }

    /// x `(d,)` [SI] from independent standard normals v `(d,)` [1], accurate in both tails.
    pub fn from_independent_normals(&self, v: &[f64]) -> Vec<f64> {
        let u = self.copula.correlate(v);
        self.variables.iter().zip(u).map(|(variable, u)| variable.from_standard_normal(u)).collect()
    }

    /// The correlated normals u `(d,)` [1] of x `(d,)` [SI]; infinite on the bounds.
    pub fn normals(&self, x: &[f64]) -> Vec<f64> {
        self.variables.iter().zip(x).map(|(variable, x)| variable.to_standard_normal(*x)).collect()
    }

    /// The independent normals v `(d,)` [1] of x `(d,)` [SI]; not finite on the bounds.
    pub fn independent_normals(&self, x: &[f64]) -> Vec<f64> {
        self.copula.decorrelate(&self.normals(x))
    }

    /// z `(d,)` [1] from x `(d,)` [SI].
    pub fn standardise(&self, x: &[f64]) -> Vec<f64> {
        x.iter().enumerate().map(|(k, x)| self.standardised_value(k, *x)).collect()
    }

    /// x `(d,)` [SI] from z `(d,)` [1], clamped to the bounds against rounding.
    pub fn to_physical(&self, z: &[f64]) -> Vec<f64> {
        z.iter().enumerate().map(|(k, z)| self.physical_value(k, *z)).collect()
    }

    /// z of the value x of variable `k` [SI].
    pub fn standardised_value(&self, k: usize, x: f64) -> f64 {
        self.coordinates[k].of_value(x)
    }

    /// The value of variable `k` at z [SI], clamped to its bounds against rounding.
    pub fn physical_value(&self, k: usize, z: f64) -> f64 {
        let (lower, upper) = self.variables[k].support();
        self.coordinates[k].value(z).clamp(lower, upper)
    }
}

impl<T: AsRef<[Distribution]> + ?Sized> From<&T> for InputModel {
    fn from(variables: &T) -> Self {
        let variables = variables.as_ref();
        Self::new(variables.to_vec(), GaussianCopula::independent(variables.len()))
    }
}

impl From<&InputModel> for InputModel {
    fn from(model: &InputModel) -> Self {
        model.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use common::random::{Correlation, standard_normal_cdf};

    fn model() -> InputModel {
        let variables = vec![
            Distribution::lognormal(2.0, 0.5).unwrap(),
            Distribution::uniform(-1.0, 3.0).unwrap(),
            Distribution::constant(4.0).unwrap(),
            Distribution::weibull(10.0, 3.0).unwrap(),
        ];
        let pair = |first, second, coefficient| Correlation { first, second, coefficient };
        InputModel::new(variables, GaussianCopula::new(4, &[pair(0, 3, -0.5), pair(0, 1, 0.8)]).unwrap())
    }

    #[test]
    fn a_model_standardised_as_another_has_its_coordinates() {
        let before = model();
        let variables = vec![
            Distribution::lognormal(3.0, 0.1).unwrap(),
            Distribution::constant(1.0).unwrap(),
            Distribution::normal(4.0, 2.0).unwrap(),
            Distribution::weibull(11.0, 3.0).unwrap(),
        ];
        let after = InputModel::new(variables, before.copula.clone()).standardised_as(&before);
        let x = after.from_uniforms(&[0.2, 0.7, 0.9, 0.4]);
        let (z, of_before) = (after.standardise(&x), before.standardise(&x));
        assert_eq!([z[0], z[1], z[3]], [of_before[0], of_before[1], of_before[3]]);
        // A constant that has its coordinate from the first model hands it on.
        let again = InputModel::new(after.variables.clone(), before.copula.clone()).standardised_as(&after);
        assert_eq!(again.standardise(&x), z);
        // A constant of the other model has no scale.
        assert!((z[2] - (x[2] - 4.0) / 2.0).abs() < 1e-15);
        for (x, again) in x.iter().zip(after.to_physical(&z)) {
            assert!((x - again).abs() < 1e-14 * x.abs());
        }
    }

    #[test]
    fn points_go_through_all_spaces_and_back() {
        let model = model();
        for v in [[0.3, -1.0, 0.2, 2.0], [5.5, 0.0, 0.0, -3.0], [-6.0, 0.5, 0.0, -1.0]] {
            let x = model.from_independent_normals(&v);
            let normals = model.variables.iter().zip(&x).map(|(variable, x)| variable.to_standard_normal(*x));
            let back = model.copula.decorrelate(&normals.collect::<Vec<f64>>());
            for k in [0, 1, 3] {
                assert!((back[k] - v[k]).abs() < 1e-6, "{v:?} {back:?}");
            }
            let z = model.standardise(&x);
            assert_eq!((x[2], z[2]), (4.0, 0.0));
            for (x, again) in x.iter().zip(model.to_physical(&z)) {
                assert!((x - again).abs() < 1e-14 * (1.0 + x.abs()));
            }
            let p: Vec<f64> = v.iter().map(|v| standard_normal_cdf(*v)).collect();
            for (x, again) in x.iter().zip(model.from_uniforms(&p)) {
                assert!((x / again - 1.0).abs() < 1e-6, "{x} {again}");
            }
        }
    }
}
