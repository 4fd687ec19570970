//! How far the wear under two models of the motion is apart where it matters.

/// Largest difference over `joints` of their largest wear rates, relative to the largest of all of them under
/// `b`: a joint that hardly wears cannot decide. Rates per joint of the scene `(points,)` each [m per cycle].
/// Zero if nothing wears under either; infinite if something wears under `a` alone.
pub fn largest_difference(a: &[Vec<f64>], b: &[Vec<f64>], joints: &[usize]) -> f64 {
    let largest = |rates: &[Vec<f64>], j: usize| rates[j].iter().fold(0.0, |m: f64, x| m.max(*x));
    let most = joints.iter().map(|&j| largest(b, j)).fold(0.0, f64::max);
    let off = joints.iter().map(|&j| (largest(a, j) - largest(b, j)).abs()).fold(0.0, f64::max);
    if off == 0.0 { 0.0 } else { off / most }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_hardly_wears_does_not_decide() {
        let a = [vec![1.0, 5.1, 0.0], vec![0.02, 0.0], vec![9.0]];
        let b = [vec![5.0, 1.0, 0.0], vec![0.01, 0.0], vec![7.0]];
        assert!((largest_difference(&a, &b, &[0, 1]) - 0.02).abs() < 1e-12);
        assert!((largest_difference(&a, &b, &[1]) - 1.0).abs() < 1e-12);
        assert_eq!(largest_difference(&b, &b, &[0, 1, 2]), 0.0);
    }

    #[test]
    fn wear_where_there_is_none_is_no_agreement() {
        assert_eq!(largest_difference(&[vec![1.0]], &[vec![0.0]], &[0]), f64::INFINITY);
        assert_eq!(largest_difference(&[vec![0.0]], &[vec![0.0]], &[0]), 0.0);
    }
}
