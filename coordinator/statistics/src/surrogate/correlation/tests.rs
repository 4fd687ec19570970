use super::*;

/// Correlations `(n, b)` [1] between points `a` `(d, n)` and `b` `(d, b)`, without the noise.
pub fn cross_correlation(correlation: &Correlation, a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let (a, b) = (correlation.scale(a), correlation.scale(b));
    let mut r = Mat::zeros(a.ncols(), b.ncols());
    let norms = squared_norms(a.as_ref());
    cross_of_scaled_into(correlation.kernel, r.as_mut(), a.as_ref(), &norms, b.as_ref());
    r
}

#[test]
fn matches_the_definition() {
    for kernel in Kernel::ALL {
        let correlation = Correlation { kernel, theta: vec![0.3, 2.0], nugget: 0.0, stated: 0.0 };
        let points = Mat::from_fn(2, 5, |k, i| (i as f64 * 0.7 + k as f64).sin() * 1.5);
        let (mut r, mut slopes) = (Mat::zeros(5, 5), Mat::zeros(5, 5));
        correlation_and_slopes_into(&correlation, points.as_ref(), r.as_mut(), slopes.as_mut());
        let whole = correlation_matrix(&correlation, points.as_ref());
        let cross = cross_correlation(&correlation, points.as_ref(), points.as_ref());
        for i in 0..5 {
            for j in 0..5 {
                let difference = |k: usize| points[(k, i)] - points[(k, j)];
                let square: f64 = (0..2).map(|k| correlation.theta[k] * difference(k).powi(2)).sum();
                let (mut value, mut slope) = ([square], [0.0]);
                kernel.correlate_with_slopes(&mut value, &mut slope);
                assert!((whole[(i, j)] - value[0]).abs() < 1e-14);
                // Where the distance is lost to rounding, that of the Matern functions is 1e-8 and not 0.
                assert!((cross[(i, j)] - value[0]).abs() < 1e-13);
                if i > j {
                    assert!((slopes[(i, j)] - slope[0]).abs() < 1e-14);
                    assert_eq!(r[(i, j)], whole[(i, j)]);
                }
            }
        }
    }
}
