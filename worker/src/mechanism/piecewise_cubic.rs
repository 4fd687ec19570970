//! Piecewise cubic functions through tables of drives and loads, with the derivatives that these need.
//!
//! # Source
//! Monotone cubic: Fritsch, Carlson (1980), SIAM J. Numer. Anal. 17, 238-246, with the slopes of Fritsch,
//! Butland (1984), SIAM J. Sci. Stat. Comput. 5, 300-304. Cubic spline: de Boor (1978), A Practical Guide to
//! Splines.

use crate::interpolate::Cubic;
use common::scene::Table;
use common::scene::monotone::{cubic_integral, monotone_slopes};
use nalgebra::{DMatrix, DVector};

/// Value and first three derivatives at one argument.
pub type Jet<R = f64> = [R; 4];

/// A piecewise cubic through the points of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct PiecewiseCubic {
    /// Arguments of the points, increasing `(n,)`.
    at: Vec<f64>,
    /// Values and slopes at them `(n, 2)`.
    node: Vec<[f64; 2]>,
    /// Integral from the first argument to each `(n,)`.
    integral: Vec<f64>,
    /// Whether the table repeats.
    repeat: bool,
}

impl PiecewiseCubic {
    /// The monotone cubic of Fritsch and Carlson: continuously differentiable, no overshoot between points.
    pub(crate) fn monotone(table: &Table) -> Self {
        Self::with_slopes(table, monotone_slopes(table))
    }

    /// The twice continuously differentiable cubic spline; with slope zero at both ends unless the table
    /// repeats.
    pub(crate) fn spline(table: &Table) -> Self {
        Self::spline_with_ends(table, [0.0; 2])
    }

    /// The twice continuously differentiable cubic spline; unless the table repeats, its slope at either end is that of the polynomial
    /// through the four points nearest to the end, or through all of fewer.
    pub(crate) fn interpolating(table: &Table) -> Self {
        let nearest = table.at.len().min(4);
        let first: Vec<usize> = (0..nearest).collect();
        let last: Vec<usize> = (0..nearest).map(|k| table.at.len() - 1 - k).collect();
        Self::spline_with_ends(table, [first, last].map(|points| slope_at_first(table, &points)))
    }

    /// The spline with these slopes at the ends of a table that does not repeat.
    fn spline_with_ends(table: &Table, ends: [f64; 2]) -> Self {
        let (x, y) = (&table.at, &table.value);
        let n = x.len();
        let step = |k: usize| x[k + 1] - x[k];
        let secant = |k: usize| (y[k + 1] - y[k]) / step(k);
        let mut matrix = DMatrix::zeros(n, n);
        let mut right = DVector::zeros(n);
        // Continuity of the second derivative where intervals a (before) and b (after) meet.
        for k in 0..n {
            let is_end = k == 0 || k + 1 == n;
            if is_end && !table.repeat {
                matrix[(k, k)] = 1.0;
                right[k] = ends[usize::from(k > 0)];
                continue;
            }
            if k + 1 == n {
                // The last point is the first one, a period later.
                (matrix[(k, k)], matrix[(k, 0)]) = (1.0, -1.0);
                continue;
            }
            let (a, before) = if k == 0 { (n - 2, n - 2) } else { (k - 1, k - 1) };
            let (ha, hb) = (step(a), step(k));
            matrix[(k, before)] += 1.0 / ha;
            matrix[(k, k)] += 2.0 / ha + 2.0 / hb;
            matrix[(k, k + 1)] += 1.0 / hb;
            right[k] = 3.0 * (secant(a) / ha + secant(k) / hb);
        }
        // The matrix is strictly diagonally dominant but for two rows that set a value: it has an inverse.
        let slope = matrix.lu().solve(&right).unwrap_or(right);
        Self::with_slopes(table, slope.iter().copied().collect())
    }

    /// The cubics through the points of `table` with these slopes `(n,)`.
    fn with_slopes(table: &Table, slope: Vec<f64>) -> Self {
        let node: Vec<[f64; 2]> = table.value.iter().zip(slope).map(|(&y, d)| [y, d]).collect();
        let mut integral = vec![0.0];
        for k in 0..node.len() - 1 {
            let h = table.at[k + 1] - table.at[k];
            let ([y0, d0], [y1, d1]) = (node[k], node[k + 1]);
            integral.push(integral[k] + cubic_integral(h, [y0, y1], [d0, d1]));
        }
        PiecewiseCubic { at: table.at.clone(), node, integral, repeat: table.repeat }
    }

    /// Place of the argument `x` in the table: the interval, the distance from its first point and the turns before it, or the end beyond which
    /// it lies.
    fn locate(&self, x: f64) -> Result<(usize, f64, f64), usize> {
        let (first, last) = (self.at[0], self.at[self.at.len() - 1]);
        let mut turns = 0.0;
        let mut x = x;
        if self.repeat {
            turns = ((x - first) / (last - first)).floor();
            x = (x - turns * (last - first)).clamp(first, last);
        } else if x < first {
            return Err(0);
        } else if x > last {
            return Err(self.at.len() - 1);
        }
        let interval = self.at.partition_point(|&a| a <= x).clamp(1, self.at.len() - 1) - 1;
        Ok((interval, x - self.at[interval], turns))
    }

    /// The cubic of interval `k` in the distance from its first point.
    fn cubic(&self, k: usize) -> Cubic {
        let ([y0, d0], [y1, d1]) = (self.node[k], self.node[k + 1]);
        let h = self.at[k + 1] - self.at[k];
        let c = (3.0 * (y1 - y0) / h - 2.0 * d0 - d1) / h;
        let d = (d0 + d1 - 2.0 * (y1 - y0) / h) / (h * h);
        Cubic([y0, d0, c, d])
    }

    /// Value and derivatives at `x`. A repeated table continues from its last value.
    pub(crate) fn jet(&self, x: f64) -> Jet {
        match self.locate(x) {
            Ok((interval, s, turns)) => {
                let Cubic([y0, d0, c, d]) = self.cubic(interval);
                let advance = self.node[self.node.len() - 1][0] - self.node[0][0];
                let cubic = Cubic([y0 + turns * advance, d0, c, d]);
                [cubic.value(s), cubic.slope(s), cubic.curvature(s), 6.0 * d]
            }
            Err(end) => [self.node[end][0], 0.0, 0.0, 0.0],
        }
    }

    /// Integral from the first argument to `x`.
    pub(crate) fn integral(&self, x: f64) -> f64 {
        let whole = self.integral[self.integral.len() - 1];
        match self.locate(x) {
            Ok((interval, s, turns)) => {
                let Cubic([y0, d0, c, d]) = self.cubic(interval);
                turns * whole
                    + self.integral[interval]
                    + s * (y0 + s * (d0 / 2.0 + s * (c / 3.0 + s * d / 4.0)))
            }
            Err(end) => self.integral[end] + (x - self.at[end]) * self.node[end][0],
        }
    }
}

/// Slope at the first of these points of a table of the polynomial through all of them (Lagrange).
fn slope_at_first(table: &Table, points: &[usize]) -> f64 {
    let x = |i: usize| table.at[points[i]];
    let y = |i: usize| table.value[points[i]];
    let mut slope = 0.0;
    for i in 1..points.len() {
        let others = (1..points.len()).filter(|&j| j != i);
        let weight: f64 = others.map(|j| (x(0) - x(j)) / (x(i) - x(j))).product();
        slope += weight * (y(i) - y(0)) / (x(i) - x(0));
    }
    slope
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn wave(points: usize, trend: f64) -> Table {
        let at: Vec<f64> = (0..=points).map(|k| k as f64 / points as f64).collect();
        let value = at.iter().map(|x| (TAU * x).sin() + trend * x).collect();
        Table { at, value, repeat: true }
    }

    #[test]
    fn a_spline_converges_with_fourth_order_and_goes_on_from_where_it_ended() {
        let error = |n: usize| {
            let spline = PiecewiseCubic::spline(&wave(n, 2.0));
            (0..500)
                .map(|k| {
                    let x = -1.0 + 3.0 * (f64::from(k) + 0.37) / 500.0;
                    (spline.jet(x)[0] - (TAU * x).sin() - 2.0 * x).abs()
                })
                .fold(0.0, f64::max)
        };
        let order = (error(16) / error(32)).log2();
        assert!((order - 4.0).abs() < 0.3, "order {order}");
    }

    #[test]
    fn an_interpolating_spline_is_exact_for_cubics_up_to_its_ends() {
        let f = |x: f64| 1.0 + x * (2.0 - x * (3.0 - 0.5 * x));
        for points in [vec![0.0, 0.4, 1.0, 1.1, 2.0, 2.5], vec![-1.0, 0.0, 0.3, 2.0]] {
            let value = points.iter().map(|x| f(*x)).collect();
            let (first, last) = (points[0], points[points.len() - 1]);
            let cubic = PiecewiseCubic::interpolating(&Table { at: points, value, repeat: false });
            for k in 0..=50 {
                let x = first + (last - first) * f64::from(k) / 50.0;
                assert!((cubic.jet(x)[0] - f(x)).abs() < 1e-12, "{x}");
            }
        }
        // Two points: a straight line.
        let line = Table { at: vec![1.0, 3.0], value: vec![0.0, 4.0], repeat: false };
        assert!((PiecewiseCubic::interpolating(&line).jet(1.5)[0] - 1.0).abs() < 1e-14);
        let repeated = wave(12, 0.0);
        assert_eq!(PiecewiseCubic::interpolating(&repeated), PiecewiseCubic::spline(&repeated));
    }

    #[test]
    fn derivatives_and_integral_agree_with_differences() {
        for cubic in [PiecewiseCubic::spline(&wave(12, 0.0)), PiecewiseCubic::monotone(&wave(12, 0.0))] {
            for k in 0..40 {
                let (x, h) = (-0.51 + 0.0513 * f64::from(k), 1e-5);
                let (low, at, high) = (cubic.jet(x - h), cubic.jet(x), cubic.jet(x + h));
                assert!(((high[0] - low[0]) / (2.0 * h) - at[1]).abs() < 1e-7, "slope at {x}");
                assert!(((high[1] - low[1]) / (2.0 * h) - at[2]).abs() < 1e-5, "curvature at {x}");
                let rate = (cubic.integral(x + h) - cubic.integral(x - h)) / (2.0 * h);
                assert!((rate - at[0]).abs() < 1e-7, "integral at {x}");
            }
        }
    }

    #[test]
    fn a_monotone_table_does_not_overshoot_and_holds_its_ends() {
        let step = Table { at: vec![0.0, 0.5, 0.6, 1.0], value: vec![1.0, 1.0, 3.0, 3.0], repeat: false };
        let cubic = PiecewiseCubic::monotone(&step);
        for k in 0..200 {
            let y = cubic.jet(-0.5 + 0.01 * f64::from(k))[0];
            assert!((1.0..=3.0).contains(&y), "{y}");
        }
        assert_eq!((cubic.jet(-3.0)[0], cubic.jet(7.0)), (1.0, [3.0, 0.0, 0.0, 0.0]));
    }
}
