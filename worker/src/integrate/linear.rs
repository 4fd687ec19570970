//! LU factorisation with partial pivoting of one small dense matrix, in place and without allocation: the step
//! loop solves some ten million 6 x 6 systems an evaluation.

/// Factors the `n` x `n` matrix `a` (by rows) in place; false if it is singular.
pub fn factor(a: &mut [f64], pivot: &mut [usize], n: usize) -> bool {
    for k in 0..n {
        let mut best = k;
        for i in k + 1..n {
            if a[i * n + k].abs() > a[best * n + k].abs() {
                best = i;
            }
        }
        pivot[k] = best;
        if best != k {
            for j in 0..n {
                a.swap(k * n + j, best * n + j);
            }
        }
        let diagonal = a[k * n + k];
        if diagonal == 0.0 || !diagonal.is_finite() {
            return false;
        }
        let inverse = 1.0 / diagonal;
        let (upper, lower) = a.split_at_mut((k + 1) * n);
        let row = &upper[k * n..];
        for other in lower.chunks_exact_mut(n) {
            let l = other[k] * inverse;
            other[k] = l;
            for j in k + 1..n {
                other[j] -= l * row[j];
            }
        }
        a[k * n + k] = inverse;
    }
    true
}

/// Solves with the factors of [`factor`], in place.
pub fn solve(a: &[f64], pivot: &[usize], n: usize, x: &mut [f64]) {
    for (k, &other) in pivot[..n].iter().enumerate() {
        x.swap(k, other);
    }
    for i in 1..n {
        let row = &a[i * n..i * n + i];
        let sum: f64 = row.iter().zip(x.iter()).map(|(l, x)| l * x).sum();
        x[i] -= sum;
    }
    for i in (0..n).rev() {
        let mut sum = x[i];
        for j in i + 1..n {
            sum -= a[i * n + j] * x[j];
        }
        x[i] = sum * a[i * n + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_a_system_that_needs_pivoting() {
        let a = [0.0, 2.0, 1.0, 1.0, 1.0, 1.0, 2.0, 0.0, 3.0];
        let x = [1.0, -2.0, 3.0];
        let mut b: Vec<f64> = (0..3).map(|i| (0..3).map(|j| a[i * 3 + j] * x[j]).sum()).collect();
        let (mut lu, mut pivot) = (a, [0; 3]);
        assert!(factor(&mut lu, &mut pivot, 3));
        solve(&lu, &pivot, 3, &mut b);
        for i in 0..3 {
            assert!((b[i] - x[i]).abs() < 1e-14);
        }
    }

    #[test]
    fn reports_a_singular_matrix() {
        let (mut lu, mut pivot) = ([1.0, 2.0, 2.0, 4.0], [0; 2]);
        assert!(!factor(&mut lu, &mut pivot, 2));
    }
}
