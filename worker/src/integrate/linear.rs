//! LU factorisation with partial pivoting, and Cholesky's, of one small dense matrix, in place and without
//! allocation: the step loop solves some ten million 6 x 6 systems an evaluation.

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

/// A pivot that lost more than this share of its diagonal element makes the matrix singular.
const DEPENDENT: f64 = 1e-13;

/// Cholesky factor of the symmetric `n` x `n` matrix `a` (by rows; its lower triangle is read and replaced);
/// false if it is not positive definite to within rounding.
pub fn cholesky(a: &mut [f64], n: usize) -> bool {
    for i in 0..n {
        let before = a[i * n + i];
        for j in 0..=i {
            let (upper, lower) = a.split_at(i * n);
            let row = if j == i { &lower[..j] } else { &upper[j * n..j * n + j] };
            let sum: f64 = row.iter().zip(&lower[..j]).map(|(x, y)| x * y).sum();
            let left = a[i * n + j] - sum;
            if j < i {
                a[i * n + j] = left / a[j * n + j];
            } else if left > DEPENDENT * before {
                a[i * n + i] = left.sqrt();
            } else {
                return false;
            }
        }
    }
    true
}

/// Solves with the factor of [`cholesky`] for `columns` right-hand sides `x` `(n, columns)`, in place.
pub fn cholesky_solve(a: &[f64], n: usize, x: &mut [f64], columns: usize) {
    for i in 0..n {
        let (done, row) = x.split_at_mut(i * columns);
        for (j, known) in done.chunks_exact(columns).enumerate() {
            row.iter_mut().zip(known).for_each(|(x, y)| *x -= a[i * n + j] * y);
        }
        row[..columns].iter_mut().for_each(|x| *x /= a[i * n + i]);
    }
    for i in (0..n).rev() {
        let (row, done) = x[i * columns..].split_at_mut(columns);
        for (k, known) in done.chunks_exact(columns).enumerate() {
            let factor = a[(i + 1 + k) * n + i];
            row.iter_mut().zip(known).for_each(|(x, y)| *x -= factor * y);
        }
        row.iter_mut().for_each(|x| *x /= a[i * n + i]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cholesky_solves_several_columns_at_once() {
        let a = [4.0, 2.0, 0.6, 2.0, 5.0, 1.5, 0.6, 1.5, 3.0];
        let x = [1.0, -2.0, 0.5, 4.0, 3.0, -1.0];
        let mut b = [0.0; 6];
        for i in 0..3 {
            for c in 0..2 {
                b[2 * i + c] = (0..3).map(|j| a[i * 3 + j] * x[2 * j + c]).sum();
            }
        }
        let mut factor = a;
        assert!(cholesky(&mut factor, 3));
        cholesky_solve(&factor, 3, &mut b, 2);
        for (found, exact) in b.iter().zip(x) {
            assert!((found - exact).abs() < 1e-14);
        }
        let mut singular = [1.0, 0.0, 1.0, 1.0];
        assert!(!cholesky(&mut singular, 2));
    }

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
