use super::*;
use crate::models::four_branch;
use common::random::standard_normal_cdf;

/// Margins of functions of a point, one per mode.
fn margins<const M: usize>(f: impl Fn(&[f64]) -> [f64; M]) -> impl Fn(MatRef<'_, f64>) -> Mat<f64> {
    move |points| {
        let values: Vec<[f64; M]> = (0..points.ncols())
            .map(|j| f(&(0..points.nrows()).map(|k| points[(k, j)]).collect::<Vec<_>>()))
            .collect();
        Mat::from_fn(M, values.len(), |i, j| values[j][i])
    }
}

#[test]
fn a_plane_limit_is_exact_with_its_derivative() {
    let sampling = LineSampling::new(3, 20, 1);
    for beta in [-1.0, 2.0, 4.0, 7.0] {
        let plane = margins(|v| [(2.0 * v[0] - v[1] + 2.0 * v[2]) / 3.0 - beta]);
        let directions = sampling.directions(1, &plane);
        let found = sampling.estimate(&directions, &plane);
        let exact = standard_normal_cdf(-beta);
        assert!((found.probability / exact - 1.0).abs() < 1e-9, "{beta}: {found:?} {exact}");
        assert!(found.standard_error < 1e-9 * exact);
        // A rise of the margin is a fall of beta.
        let derivative: f64 = found.roots.iter().map(|root| root.weight).sum();
        assert!((derivative / standard_normal_pdf(beta) - 1.0).abs() < 1e-6, "{beta}: {derivative}");
    }
}

#[test]
fn modes_that_fail_together_count_once() {
    // The four branches of the system, as modes: directions at right angles and opposite.
    let system = margins(|v| {
        let (s, t) = ((v[0] + v[1]) / 2f64.sqrt(), v[0] - v[1]);
        let bowl = 3.0 + 0.1 * t * t;
        let k = 6.0 / 2f64.sqrt();
        assert!((bowl - s).min(bowl + s).min(t + k).min(k - t) == four_branch(v, 6.0));
        [s - bowl, -s - bowl, -t - k, t - k]
    });
    let sampling = LineSampling::new(2, 400, 2);
    let found = sampling.estimate(&sampling.directions(4, &system), &system);
    assert!((found.probability - 4.457_331_490_6e-3).abs() < 3.0 * found.standard_error, "{found:?}");
    assert!(found.standard_error < 0.02 * found.probability);
    // Counting as many points would know it to a third.
    let counting = (4.46e-3_f64 / (400.0 * GRID as f64)).sqrt();
    assert!(found.standard_error < 0.2 * counting);
}

#[test]
fn any_direction_gives_the_probability_of_a_strip() {
    // Fails between two planes and not beyond: two roots on each line.
    let strip = margins(|v| [0.5 - (v[0] - 1.5).abs()]);
    let exact = standard_normal_cdf(2.0) - standard_normal_cdf(1.0);
    for direction in [[1.0, 0.0], [0.6, 0.8]] {
        let found = LineSampling::new(2, 2000, 3).estimate(&[direction.to_vec()], &strip);
        let error = found.standard_error.max(1e-9);
        assert!((found.probability - exact).abs() < 4.0 * error, "{direction:?}: {found:?} {exact}");
    }
}

#[test]
fn derivatives_are_those_of_the_estimate_with_the_same_lines() {
    let of = |p: f64| margins(move |v: &[f64]| [v[0] + 0.1 * v[1] * v[1] - 2.0 + p, v[1] - 2.5 + 0.5 * p]);
    let sampling = LineSampling::new(2, 300, 4);
    let directions = sampling.directions(2, &of(0.0));
    let at = |p: f64| sampling.estimate(&directions, &of(p));
    let found = at(0.0);
    // dy/dp is 1 for the first mode, 1/2 for the second.
    let by_roots: f64 = found.roots.iter().map(|root| root.weight / (1.0 + root.mode as f64)).sum();
    let h = 1e-3;
    let by_difference = (at(h).probability - at(-h).probability) / (2.0 * h);
    assert!((by_roots / by_difference - 1.0).abs() < 1e-2, "{by_roots} {by_difference}");
}
