//! A distribution with another mean or standard deviation.
//!
//! Mean and standard deviation are those of the scene: of the parent for a truncated normal. A bound of a truncated normal
//! that the scene gives (`lower`, `upper`) is a physical limit and stays where it is, as those of a beta variable do. A bound
//! that follows from its truncation keeps its distance in standard deviations: it moves with the mean and the standard
//! deviation. Uniform and triangular distributions keep their shape: their bounds move.
//!
//! # Source
//! Moments of the distributions: Johnson, Kotz, Balakrishnan (1994, 1995), Continuous Univariate Distributions, volumes 1 and 2.

use common::random::{Distribution, Extreme, LawError};
use common::scene::SceneSource;
use toml::Value;

/// Bounds that the scene gives, by variable.
pub fn fixed_bounds(source: &SceneSource) -> Vec<[bool; 2]> {
    by_row(source, |row| ["lower", "upper"].map(|key| row.get(key).is_some()))
}

/// Variables whose standard deviation the scene gives as a share of the mean, which it follows.
pub fn relative_spreads(source: &SceneSource) -> Vec<bool> {
    by_row(source, |row| {
        row.get("std").and_then(Value::as_str).is_some_and(|text| text.trim_end().ends_with('%'))
    })
}

/// A property of the row of every random variable in the text of its scene; the default without a row.
fn by_row<T: Default>(source: &SceneSource, of: impl Fn(&Value) -> T) -> Vec<T> {
    let rows = source.document.get("variables").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let row = |name: &str| rows.iter().find(|row| row.get("name").and_then(Value::as_str) == Some(name));
    source.variables().iter().map(|variable| row(&variable.name).map(&of).unwrap_or_default()).collect()
}

/// The distribution with the mean and the standard deviation given [unit of the variable]. `fixed` tells which bounds of a
/// truncated normal stay where they are, the lower and the upper one.
///
/// # Errors
/// [`LawError`] if the distribution does not exist. A constant ignores the standard deviation.
pub fn with_moments(
    law: &Distribution,
    mean: f64,
    std: f64,
    fixed: [bool; 2],
) -> Result<Distribution, LawError> {
    let (before, spread) = (law.parent_mean(), law.parent_std());
    let moved = |x: f64| mean + (x - before) / spread * std;
    let (lower, upper) = law.support();
    match law {
        Distribution::Normal(_) => Distribution::normal(mean, std),
        Distribution::Lognormal(_) => Distribution::lognormal(mean, std),
        Distribution::Uniform(_) => Distribution::uniform_by_moments(mean, std),
        Distribution::Weibull(_) => Distribution::weibull(mean, std),
        Distribution::Exponential(_) => Distribution::exponential(mean, std),
        Distribution::Beta(_) => Distribution::beta(mean, std, lower, upper),
        Distribution::Constant(_) => Distribution::constant(mean),
        Distribution::Gumbel(_) => {
            let extreme = if law.quantile(0.5) < before { Extreme::Maxima } else { Extreme::Minima };
            Distribution::gumbel(mean, std, extreme)
        }
        Distribution::Empirical(law) => law.moved(mean, std).map(Distribution::Empirical),
        Distribution::Triangular(_) => {
            Distribution::triangular(moved(lower), moved(3.0 * before - lower - upper), moved(upper))
        }
        Distribution::TruncatedNormal(_) => {
            let bound = |x: f64, fixed: bool| if fixed { x } else { moved(x) };
            Distribution::truncated_normal(mean, std, bound(lower, fixed[0]), bound(upper, fixed[1]))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_distribution_gets_the_moments_asked_for() {
        let laws = [
            Distribution::normal(2.0, 0.5),
            Distribution::lognormal(2.0, 0.5),
            Distribution::uniform(1.0, 3.0),
            Distribution::weibull(2.0, 0.5),
            Distribution::exponential(2.0, 0.5),
            Distribution::beta(2.0, 0.5, 0.0, 5.0),
            Distribution::gumbel(2.0, 0.5, Extreme::Minima),
            Distribution::gumbel(2.0, 0.5, Extreme::Maxima),
            Distribution::triangular(0.0, 2.0, 6.0),
        ];
        let measured = Distribution::empirical(&[1.0, 2.0, 2.5, 4.0]).unwrap();
        for law in laws.map(Result::unwrap).into_iter().chain([measured]) {
            let same = with_moments(&law, law.parent_mean(), law.given_std(), [false; 2]).unwrap();
            for p in [0.1, 0.5, 0.9] {
                assert!((same.quantile(p) - law.quantile(p)).abs() < 1e-9, "{law:?} {same:?}");
            }
            let other = with_moments(&law, 2.2, 0.4, [true; 2]).unwrap();
            assert!((other.mean() - 2.2).abs() < 1e-9 && (other.std() - 0.4).abs() < 1e-9, "{other:?}");
        }
    }

    #[test]
    fn a_truncation_moves_and_a_physical_limit_stays() {
        let law = Distribution::truncated_normal(10.0, 1.0, 8.0, 12.0).unwrap();
        let support = |fixed| with_moments(&law, 11.0, 2.0, fixed).unwrap().support();
        let near = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() < 1e-12 && (a.1 - b.1).abs() < 1e-12;
        assert!(near(support([false; 2]), (7.0, 15.0)));
        assert!(near(support([true, false]), (8.0, 15.0)));
        assert!(with_moments(&law, 7.5, 1.0, [true; 2]).is_err());
    }
}
