//! Every distribution against quadrature, its own inverse, and finite differences.

use super::truncated_normal::TruncatedNormal;
use super::*;
use crate::random::standard_normal_pdf;

/// A truncated normal whose bounds need not enclose the mean: far in a tail digits are lost first.
fn truncated(mean: f64, std: f64, lower: f64, upper: f64) -> Distribution {
    Distribution::TruncatedNormal(TruncatedNormal { mean, std, lower, upper })
}

/// Laws of every kind, most of them twice, with moments and bounds that no formula simplifies at.
fn laws() -> Vec<Distribution> {
    let made = [
        Distribution::normal(-3.0, 2.0),
        Distribution::normal(40.05e-3, 3e-6),
        Distribution::lognormal(120.0, 12.0),
        Distribution::lognormal(1.2e-13, 0.8e-13),
        Distribution::uniform(-1.0, 4.0),
        Distribution::uniform_by_moments(23e-6, 2e-6),
        Distribution::gumbel(10.0, 2.0, Extreme::Maxima),
        Distribution::gumbel(-1.0, 0.3, Extreme::Minima),
        Distribution::weibull(200e9, 10e9),
        Distribution::weibull(3.0, 4.0),
        Distribution::exponential(5.0, 2.0),
        Distribution::exponential_from(0.0, 0.02),
        Distribution::beta(0.3, 0.1, 0.0, 0.5),
        Distribution::beta(-1.0, 1.2, -3.0, 1.5),
        Distribution::triangular(1.0, 1.5, 4.0),
        Distribution::triangular(-2.0, 3.0, 3.0),
    ];
    let measured = Distribution::empirical(&CORNERS).unwrap();
    let cut = [
        truncated(1.5, 0.2, 0.9, 2.1),
        truncated(-3.0, 2.0, -4.0, 5.0),
        truncated(0.0, 1.0, 4.0, 6.0),
        truncated(10.0, 1.0, -1e9, 9.0),
    ];
    made.into_iter().map(Result::unwrap).chain(cut).chain([measured]).collect()
}

/// The integral of h(x) f(x) up to x, by Gauss' rule of five points between 800 quantiles.
fn integrate(d: &Distribution, to: f64, h: impl Fn(f64) -> f64) -> f64 {
    const NODES: [(f64, f64); 5] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let knots: Vec<f64> = (0..=800)
        .map(|i| d.from_standard_normal(f64::from(i) / 50.0 - 8.0).min(to))
        .chain(kink(d).filter(|x| *x < to))
        .chain([to.min(d.from_standard_normal(8.0))])
        .collect();
    let mut knots = knots;
    knots.sort_by(f64::total_cmp);
    let panel = |a: f64, b: f64| {
        let at = |(node, weight): &(f64, f64)| {
            let x = 0.5 * (a + b) + 0.5 * (b - a) * node;
            weight * h(x) * d.pdf(x)
        };
        0.5 * (b - a) * NODES.iter().map(at).sum::<f64>()
    };
    knots.windows(2).map(|pair| panel(pair[0], pair[1])).sum()
}

/// Measured values, at which an empirical density jumps; equal ones are tested beside the law.
const CORNERS: [f64; 5] = [1.0, 2.0, 2.5, 4.0, 7.0];

/// Where the density has a corner or a jump inside its support.
fn kink(d: &Distribution) -> impl Iterator<Item = f64> + use<> {
    let found: &[f64] = match d {
        Distribution::Triangular(_) => &[1.5, 3.0],
        Distribution::Empirical(_) => &CORNERS,
        _ => &[],
    };
    found.iter().copied()
}

fn near(found: f64, expected: f64, within: f64, what: impl std::fmt::Debug) {
    assert!((found - expected).abs() <= within, "{what:?}: {found} instead of {expected}");
}

#[test]
fn moments_agree_with_quadrature() {
    for d in laws() {
        let (mean, std) = (d.mean(), d.std());
        near(integrate(&d, f64::INFINITY, |_| 1.0), 1.0, 1e-9, &d);
        near(integrate(&d, f64::INFINITY, |x| (x - mean) / std), 0.0, 1e-8, &d);
        near(integrate(&d, f64::INFINITY, |x| ((x - mean) / std).powi(2)), 1.0, 1e-7, &d);
        if !matches!(d, Distribution::TruncatedNormal(_)) {
            assert_eq!((d.parent_mean(), d.parent_std(), d.given_std()), (mean, std, std));
        }
    }
}

#[test]
fn quantiles_invert_the_distribution_function_in_both_tails() {
    for d in laws() {
        for p in [1e-12, 1e-9, 1e-4, 0.03, 0.25, 0.5] {
            let (low, high) = (d.quantile(p), d.upper_quantile(p));
            // What one rounding of x is worth in probability.
            let rounding = |x: f64| 4.0 * f64::EPSILON * x.abs() * d.pdf(x);
            // Cancellation against a bound's own probability, which truncation far in a tail cannot avoid.
            near(d.cdf(low), p, 1e-9 * p + rounding(low) + 1e-15, (&d, p));
            near(d.survival(high), p, 1e-9 * p + rounding(high) + 1e-15, (&d, p));
            near(d.quantile(1.0 - p), high, 1e-3 * d.std() * (1.0 + 1e-15 / p), (&d, p));
            assert!((d.cdf(low) + d.survival(low) - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn standard_normals_go_there_and_back() {
    for d in laws() {
        let (lower, upper) = d.support();
        let mut last = f64::NEG_INFINITY;
        for u in [-6.5, -6.0, -4.0, -1.0, -1e-3, 0.0, 0.5, 2.0, 5.0, 6.0, 6.5] {
            let x = d.from_standard_normal(u);
            assert!(x > last && x >= lower && x <= upper, "{d:?} {u} {x}");
            last = x;
            // One rounding of x, in u.
            let rounding = 8.0 * f64::EPSILON * x.abs() * d.pdf(x) / standard_normal_pdf(u);
            near(d.to_standard_normal(x), u, 1e-8 + rounding, (&d, u));
        }
    }
}

/// The laws whose parameters are mean and standard deviation, remade with others.
fn remade(d: &Distribution, mean: f64, std: f64) -> Option<Distribution> {
    let (lower, upper) = d.support();
    Some(match d {
        Distribution::TruncatedNormal(_) => truncated(mean, std, lower, upper),
        Distribution::Normal(_) => Distribution::normal(mean, std).unwrap(),
        Distribution::Lognormal(_) => Distribution::lognormal(mean, std).unwrap(),
        Distribution::Gumbel(g) => {
            let maxima = Distribution::gumbel(d.mean(), d.std(), Extreme::Maxima).unwrap();
            let same = maxima == Distribution::Gumbel(*g);
            Distribution::gumbel(mean, std, if same { Extreme::Maxima } else { Extreme::Minima }).unwrap()
        }
        Distribution::Weibull(_) => Distribution::weibull(mean, std).unwrap(),
        Distribution::Beta(_) => Distribution::beta(mean, std, lower, upper).unwrap(),
        _ => return None,
    })
}

#[test]
fn scores_are_the_derivatives_of_the_log_density() {
    let mut checked = 0;
    for d in laws() {
        let (mean, std) = (d.parent_mean(), d.parent_std());
        let h = 1e-5 * std;
        let Some(_) = remade(&d, mean, std) else { continue };
        checked += 1;
        for p in [1e-3, 0.1, 0.5, 0.9, 0.999] {
            let x = d.quantile(p);
            let at = |mean, std| remade(&d, mean, std).unwrap();
            let by = |of: &dyn Fn(&Distribution) -> f64| {
                [
                    (of(&at(mean + h, std)) - of(&at(mean - h, std))) / (2.0 * h),
                    (of(&at(mean, std + h)) - of(&at(mean, std - h))) / (2.0 * h),
                ]
            };
            for (found, expected) in d.scores(x).into_iter().zip(by(&|d| d.pdf(x).ln())) {
                near(found, expected, 1e-5 * (1.0 / std + expected.abs()), (&d, p));
            }
            for (found, expected) in d.cdf_derivatives(x).into_iter().zip(by(&|d| d.cdf(x))) {
                near(found, expected, 1e-6 / std, (&d, p));
            }
        }
    }
    assert_eq!(checked, 14);
}

/// d/dp of E[X] and E[(X - mean)^2]: what makes a score one of mean or standard deviation, whatever the law.
#[test]
fn scores_move_mean_and_variance_as_they_say() {
    for d in laws() {
        if matches!(d, Distribution::TruncatedNormal(_)) {
            continue;
        }
        let (mean, std) = (d.mean(), d.std());
        let all = |h: &dyn Fn(f64) -> f64| integrate(&d, f64::INFINITY, h);
        let t = |x: f64| (x - mean) / std;
        near(all(&|x| std * d.scores(x)[0]), 0.0, 1e-7, &d);
        near(all(&|x| std * d.scores(x)[1]), 0.0, 1e-7, &d);
        near(all(&|x| std * d.scores(x)[0] * t(x)), 1.0, 1e-6, &d);
        near(all(&|x| std * d.scores(x)[0] * t(x) * t(x)), 0.0, 2e-6, &d);
        near(all(&|x| std * d.scores(x)[1] * t(x)), 0.0, 1e-6, &d);
        near(all(&|x| std * d.scores(x)[1] * t(x) * t(x)), 2.0, 2e-6, &d);
    }
}

#[test]
fn derivatives_of_the_distribution_function_are_the_integrals_of_the_scores() {
    for d in laws() {
        let std = d.parent_std();
        for p in [1e-3, 0.2, 0.7, 0.99] {
            let x = d.quantile(p);
            let found = d.cdf_derivatives(x).map(|by| std * by);
            near(found[0], integrate(&d, x, |x| std * d.scores(x)[0]), 1e-7, (&d, p));
            near(found[1], integrate(&d, x, |x| std * d.scores(x)[1]), 1e-7, (&d, p));
        }
    }
}

#[test]
fn a_constant_is_standardised_to_zero() {
    let d = Distribution::constant(7.5).unwrap();
    assert_eq!((d.mean(), d.std(), d.given_std(), d.quantile(0.3)), (7.5, 0.0, 0.0, 7.5));
    assert_eq!((d.from_standard_normal(-5.0) - d.parent_mean()) / d.parent_std(), 0.0);
    assert_eq!((d.scores(7.5), d.to_standard_normal(7.5)), ([0.0; 2], 0.0));
    assert_eq!([d.cdf(7.4), d.cdf(7.5), d.survival(7.4)], [0.0, 1.0, 1.0]);
}

#[test]
fn what_makes_no_distribution_is_refused_with_its_numbers() {
    for (refused, expected) in [
        (Distribution::normal(1.0, 0.0), "std = 0 is out of range, allowed: > 0, finite"),
        (Distribution::normal(f64::NAN, 1.0), "mean = NaN is out of range, allowed: any finite number"),
        (Distribution::lognormal(-1.0, 1.0), "mean = -1 is out of range, allowed: > 0, finite"),
        (Distribution::uniform(2.0, 1.0), "upper = 1 is out of range, allowed: > 2, finite"),
        (Distribution::weibull(2.0, 30.0), "std = 30 is out of range, allowed: > 0.002 and < 20"),
        (Distribution::exponential_from(3.0, 3.0), "lower = 3 is out of range, allowed: < 3, finite"),
        (Distribution::beta(2.0, 0.1, 0.0, 1.0), "the bounds 0 and 1 do not enclose the mean 2"),
        (Distribution::triangular(0.0, 2.0, 1.0), "the bounds 0 and 1 do not enclose the mode 2"),
        (Distribution::truncated_normal(1.0, 1.0, 1.0, 3.0), "the bounds 1 and 3 do not enclose the mean 1"),
    ] {
        assert_eq!(refused.unwrap_err().to_string(), expected);
    }
    let widest = Distribution::beta(0.5, 0.5, 0.0, 1.0).unwrap_err().to_string();
    assert!(widest.contains("< 0.4767"), "{widest}");
}

/// Figures that others print: Echard's and Rackwitz' lognormals, Beta(2, 3), Rayleigh's median.
#[test]
fn published_values() {
    // LN(1, 0.2): zeta = sqrt(ln 1.04) = 0.198042, lambda = -0.019610.
    let d = Distribution::lognormal(1.0, 0.2).unwrap();
    near(d.from_standard_normal(0.0), (-0.019_610_356_f64).exp(), 1e-8, &d);
    near(d.from_standard_normal(1.0) / d.from_standard_normal(0.0), 0.198_042_2_f64.exp(), 1e-6, &d);
    // Beta(2, 3): mean 0.4, variance 0.04, F(0.5) = 11/16, f(0.5) = 1.5.
    let d = Distribution::beta(0.4, 0.2, 0.0, 1.0).unwrap();
    near(d.cdf(0.5), 0.6875, 1e-12, &d);
    near(d.pdf(0.5), 1.5, 1e-11, &d);
    // A lower tail of one in a billion: F = y^2 (6 - 8 y + 3 y^2).
    let y = d.quantile(1e-9);
    near(y * y * (6.0 - 8.0 * y + 3.0 * y * y) / 1e-9, 1.0, 1e-9, &d);
    // Six standard deviations: Phi(-6) = 9.865876e-10.
    let d = Distribution::exponential(1.0, 1.0).unwrap();
    near(d.from_standard_normal(6.0), -(9.865_876_450_376_98e-10_f64).ln(), 1e-12, &d);
}
