//! Difference of the wear rates of two models of the motion.

/// Largest difference between models `a` and `b` of the largest wear rate of a surface, relative to the largest rate of all `surfaces`
/// under `b`, so that surfaces that hardly wear do not decide [1].
///
/// Rates are given for every surface of the joints of the scene and every control point `(surfaces, points)` [m per cycle]. The result
/// is zero if nothing wears under either model, infinite if a surface wears under `a` alone.
pub(crate) fn wear_rate_difference(a: &[Vec<f64>], b: &[Vec<f64>], surfaces: &[usize]) -> f64 {
    let largest = |rates: &[Vec<f64>], j: usize| rates[j].iter().fold(0.0, |m: f64, x| m.max(*x));
    let largest_of_all = surfaces.iter().map(|&j| largest(b, j)).fold(0.0, f64::max);
    let off = surfaces.iter().map(|&j| (largest(a, j) - largest(b, j)).abs()).fold(0.0, f64::max);
    if off == 0.0 { 0.0 } else { off / largest_of_all }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_that_hardly_wears_does_not_decide() {
        let a = [vec![1.0, 5.1, 0.0], vec![0.02, 0.0], vec![9.0]];
        let b = [vec![5.0, 1.0, 0.0], vec![0.01, 0.0], vec![7.0]];
        assert!((wear_rate_difference(&a, &b, &[0, 1]) - 0.02).abs() < 1e-12);
        assert!((wear_rate_difference(&a, &b, &[1]) - 1.0).abs() < 1e-12);
        assert_eq!(wear_rate_difference(&b, &b, &[0, 1, 2]), 0.0);
    }

    #[test]
    fn wear_where_there_is_none_is_no_agreement() {
        assert_eq!(wear_rate_difference(&[vec![1.0]], &[vec![0.0]], &[0]), f64::INFINITY);
        assert_eq!(wear_rate_difference(&[vec![0.0]], &[vec![0.0]], &[0]), 0.0);
    }
}
