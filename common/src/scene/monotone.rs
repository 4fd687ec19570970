//! Slopes of the monotone cubic through the points of a function: it has no extremum between them.
//!
//! Fritsch and Butland: the slope at a point between secants s0, s1 over intervals h0, h1 is their weighted harmonic mean, zero where
//! the secants have opposite signs.
//!
//! # Source
//! Fritsch, Carlson (1980), SIAM J. Numer. Anal. 17, 238-246; Fritsch, Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300-304.

use super::values::Table;

/// Slope at a point between two intervals of length `h0`, `h1` with secants `s0`, `s1`; zero where these have
/// opposite signs.
pub fn fritsch_butland([h0, h1]: [f64; 2], [s0, s1]: [f64; 2]) -> f64 {
    if s0 * s1 <= 0.0 {
        return 0.0;
    }
    let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
    (w0 + w1) / (w0 / s0 + w1 / s1)
}

/// Slopes at the points of `table` `(n,)`: continuous where a table repeats, zero at both ends of others.
pub fn monotone_slopes(table: &Table) -> Vec<f64> {
    let (x, y) = (&table.at, &table.value);
    let n = x.len();
    let secant = |k: usize| (y[k + 1] - y[k]) / (x[k + 1] - x[k]);
    let inner = |k: usize| fritsch_butland([x[k] - x[k - 1], x[k + 1] - x[k]], [secant(k - 1), secant(k)]);
    let mut slope: Vec<f64> = (0..n).map(|k| if k == 0 || k + 1 == n { 0.0 } else { inner(k) }).collect();
    if table.repeat {
        let end = fritsch_butland([x[n - 1] - x[n - 2], x[1] - x[0]], [secant(n - 2), secant(0)]);
        (slope[0], slope[n - 1]) = (end, end);
    }
    slope
}

/// Integral of the cubic with these values `y` and slopes `d` at the ends of an interval of length `h`.
pub fn cubic_integral(h: f64, [y0, y1]: [f64; 2], [d0, d1]: [f64; 2]) -> f64 {
    h * (0.5 * (y0 + y1) + h * (d0 - d1) / 12.0)
}

/// Value of the monotone cubic of `table` at `x`: periodic where it repeats, else its end values outside it.
pub fn monotone_value(table: &Table, x: f64) -> f64 {
    let (slope, last) = (monotone_slopes(table), table.at.len() - 1);
    let [from, to] = [table.at[0], table.at[last]];
    let x = if table.repeat { from + (x - from).rem_euclid(to - from) } else { x.clamp(from, to) };
    let k = table.at.partition_point(|at| *at <= x).clamp(1, last) - 1;
    let h = table.at[k + 1] - table.at[k];
    let s = (x - table.at[k]) / h;
    let (y0, y1) = (table.value[k], table.value[k + 1]);
    let (d0, d1) = (h * slope[k], h * slope[k + 1]);
    y0 + s * (d0 + s * (3.0 * (y1 - y0) - 2.0 * d0 - d1 + s * (2.0 * (y0 - y1) + d0 + d1)))
}

/// Integral of the monotone cubic of `table` from its first argument to its last.
pub fn monotone_integral(table: &Table) -> f64 {
    let slope = monotone_slopes(table);
    let interval = |k: usize| {
        let (h, value) = (table.at[k + 1] - table.at[k], [table.value[k], table.value[k + 1]]);
        cubic_integral(h, value, [slope[k], slope[k + 1]])
    };
    (0..table.at.len() - 1).map(interval).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_between_equal_secants_is_the_secant_and_at_an_extremum_zero() {
        assert_eq!(fritsch_butland([1.0, 2.0], [3.0, 3.0]), 3.0);
        assert_eq!(fritsch_butland([1.0, 2.0], [3.0, -3.0]), 0.0);
    }

    #[test]
    fn the_integral_is_that_of_the_cubic_between_the_points() {
        let rise = Table { at: vec![0.0, 1.0, 2.0], value: vec![0.0, 0.0, 4.0], repeat: false };
        let values = [-1.0, 0.5, 1.5, 2.0, 3.0].map(|x| monotone_value(&rise, x));
        assert_eq!(values, [0.0, 0.0, 2.0, 4.0, 4.0]);
        // A straight line, and a rise between two level pieces: half of it by symmetry.
        let table = |at: &[f64], value: &[f64]| Table { at: at.into(), value: value.into(), repeat: false };
        assert!((monotone_integral(&table(&[0.0, 1.0, 3.0], &[2.0, 2.0, 2.0])) - 6.0).abs() < 1e-15);
        assert!(
            (monotone_integral(&table(&[0.0, 1.0, 2.0, 3.0], &[0.0, 0.0, 4.0, 4.0])) - 6.0).abs() < 1e-15
        );
    }
}
