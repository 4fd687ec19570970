//! Worn bore: wear depths of control points at equal angles, joined by a periodic cubic spline.
//!
//! The radius at angle psi [rad] in the bushing's frame is R(psi) = R2 + w(psi) [m]: R2 the unworn radius, w
//! the periodic cubic spline through the wear depths w_i of the N control points psi_i = 2 pi i / N, twice
//! continuously differentiable. With M_i = w''(psi_i) (2 pi / N)^2 [m], the spline solves the periodic
//! tridiagonal system M_{i-1} + 4 M_i + M_{i+1} = 6 (w_{i-1} - 2 w_i + w_{i+1}).
//!
//! An approximating spline has the depths as coefficients of the cubic B-splines at the control points, as the source of the model writes it:
//! it is the spline through the depths (w_{i-1} + 4 w_i + w_{i+1}) / 6, and below no depth before.
//!
//! Beside wear that ends within a few control points the spline dips between the next two, where the radius falls below what it was before: by
//! 14 % of a depth added to a single point, by 2 % of that of a smooth spot 60 degrees wide at 36 control points, a quarter of that at twice
//! the points. The control points themselves never lose depth.
//!
//! Slopes limited to 3 w_i per spacing, with which the radius never falls below the unworn one, were tried and dropped: the second derivative is
//! no longer continuous, and at the same number of points the wear of `four-bar` errs more (under `foundation` by 3.90 % instead of 3.29 % at
//! 18 points, by 1.16 % instead of 0.97 % at 36); that of `flapping-wing` moves by 0.01 %. No curve with a tangent that depends on the depths alone keeps strictly
//! above what was: where one depth grows, the curve must not fall on either side of the next point, so its slope there stays as it is,
//! whatever the other depths are, and by symmetry it is zero.
//!
//! # Source
//! de Boor (1978), A Practical Guide to Splines.

use crate::interpolate::{Cubic, PeriodicTridiagonal};
use crate::lanes::Real;
use common::scene::BoreSpline;
use std::f64::consts::TAU;

/// Radius of the bore and its derivatives to the angle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Radius<R = f64> {
    /// Radius R(psi) of the bore [m].
    pub r: R,
    /// First derivative dR/dpsi [m/rad].
    pub d1: R,
    /// Second derivative d2R/dpsi2 [m/rad^2].
    pub d2: R,
}

/// A bore with a wear profile.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// Initial radius R2 [m].
    pub(crate) initial_radius: f64,
    /// Meaning of the depths of the control points.
    curve: BoreSpline,
    /// Depth of the curve at the control points `(n,)` [m].
    depth: Vec<f64>,
    /// Cubic in the local coordinate s of [0, 1) per interval, `(n, 4)`: R = a + s (b + s (c + s d)) [m].
    pub(crate) cubic: Vec<[f64; 4]>,
    /// Intervals per radian.
    per_radian: f64,
    /// Second derivatives at the control points times the squared spacing `(n,)` [m].
    bend: Vec<f64>,
    spline: PeriodicTridiagonal,
}

impl Profile {
    /// A round bore of radius `initial_radius` [m] with `points` control points (at least 3).
    pub fn round(initial_radius: f64, points: usize) -> Self {
        let mut profile = Profile {
            initial_radius,
            curve: BoreSpline::Interpolating,
            depth: vec![0.0; points],
            cubic: vec![[0.0; 4]; points],
            per_radian: points as f64 / TAU,
            bend: vec![0.0; points],
            spline: PeriodicTridiagonal::new(points),
        };
        profile.fit_spline();
        profile
    }

    /// This bore with another meaning of the depths that it is given from now on.
    pub(crate) fn with_spline(self, curve: BoreSpline) -> Self {
        Profile { curve, ..self }
    }

    /// The bore unworn, with another number of control points.
    pub(crate) fn unworn(&self, points: usize) -> Self {
        Profile::round(self.initial_radius, points).with_spline(self.curve)
    }

    /// Number of control points.
    pub(crate) fn points(&self) -> usize {
        self.depth.len()
    }

    /// Replaces the wear depths by `depth` `(n,)` [m] and recomputes the spline.
    pub fn set_depth(&mut self, depth: &[f64]) {
        match self.curve {
            BoreSpline::Interpolating => self.depth.copy_from_slice(depth),
            BoreSpline::Approximating => {
                let n = depth.len();
                for (i, on_curve) in self.depth.iter_mut().enumerate() {
                    let neighbours = depth[(i + n - 1) % n] + depth[(i + 1) % n];
                    *on_curve = (4.0 * depth[i] + neighbours) / 6.0;
                }
            }
        }
        self.fit_spline();
    }

    /// Radius and derivatives at angle `psi` in (-2 pi, 2 pi) [rad].
    #[inline(always)]
    pub fn radius_at(&self, psi: f64) -> Radius {
        look_up(psi, self.points(), self.per_radian, &self.cubic)
    }

    /// Radius and derivatives in interval `interval` between control points, at its fraction `s` in [0, 1].
    #[inline(always)]
    pub(crate) fn within(&self, interval: usize, s: f64) -> Radius {
        cubic_at(self.cubic[interval], s, self.per_radian)
    }

    /// Depth at the control points less a twelfth of w'' times the squared spacing of `sub` intervals between two of them: the values
    /// of chords that have the mean of their arcs to fourth order `(points,)` [m].
    pub(crate) fn chord_depth(&self, sub: usize) -> Vec<f64> {
        let share = 1.0 / (12.0 * (sub * sub) as f64);
        self.depth.iter().zip(&self.bend).map(|(depth, bend)| depth - share * bend).collect()
    }

    /// Radius at `x` control points from that at angle zero, in [-n, 2 n) [m].
    #[inline(always)]
    pub(crate) fn turned(&self, x: f64) -> f64 {
        let from = x + self.cubic.len() as f64;
        let point = from as usize;
        self.turned_to(point, from - point as f64)
    }

    /// Radius at the fraction `s` of the interval behind point `point` of three turns, the second of which begins at angle zero [m].
    #[inline(always)]
    pub(crate) fn turned_to(&self, point: usize, s: f64) -> f64 {
        let n = self.cubic.len();
        let once = if point >= n { point - n } else { point };
        Cubic(self.cubic[if once >= n { once - n } else { once }]).value(s)
    }

    /// Fills `table` with R at `table.len()` equal angles from 0 (a multiple of the control points) [m].
    pub(crate) fn tabulate(&self, table: &mut [f64]) {
        let sub = table.len() / self.cubic.len();
        for (interval, chunk) in self.cubic.iter().zip(table.chunks_exact_mut(sub)) {
            for (j, value) in chunk.iter_mut().enumerate() {
                *value = Cubic(*interval).value(j as f64 / sub as f64);
            }
        }
    }

    /// Fills `table` as [`Self::tabulate`] does, each value moved by -R'' spacing^2 / 12, so that the chords
    /// between the values have the mean of the arcs they stand for to fourth order [m].
    pub(crate) fn tabulate_chords(&self, table: &mut [f64]) {
        self.tabulate(table);
        let sub = table.len() / self.cubic.len();
        for (interval, chunk) in self.cubic.iter().zip(table.chunks_exact_mut(sub)) {
            for (j, value) in chunk.iter_mut().enumerate() {
                *value -= Cubic(*interval).curvature(j as f64 / sub as f64) / (12.0 * (sub * sub) as f64);
            }
        }
    }

    /// Solves the periodic tridiagonal system of the second differences and sets the cubics.
    ///
    /// With M_i the second derivative times the squared spacing: M_{i-1} + 4 M_i + M_{i+1} = 6 (w_{i-1} - 2
    /// w_i + w_{i+1}).
    fn fit_spline(&mut self) {
        let n = self.depth.len();
        let (w, m) = (&self.depth, &mut self.bend);
        let second = |before: f64, at: f64, after: f64| 6.0 * (before - 2.0 * at + after);
        m[0] = second(w[n - 1], w[0], w[1]);
        for (m, w) in m[1..].iter_mut().zip(w.windows(3)) {
            *m = second(w[0], w[1], w[2]);
        }
        m[n - 1] = second(w[n - 2], w[n - 1], w[0]);
        self.spline.solve(m);
        for i in 0..n {
            let next = if i + 1 == n { 0 } else { i + 1 };
            let (m0, m1, w0, w1) = (m[i], m[next], w[i], w[next]);
            self.cubic[i] =
                [self.initial_radius + w0, w1 - w0 - (2.0 * m0 + m1) / 6.0, 0.5 * m0, (m1 - m0) / 6.0];
        }
    }
}

/// Radius and derivatives of bores with `points` control points, one per lane: `cubics` holds those of the first bore, then those of
/// the second, and so on `(lanes, points, 4)`.
#[inline(always)]
fn look_up<R: Real>(psi: R, points: usize, per_radian: f64, cubics: &[[f64; 4]]) -> Radius<R> {
    /// Added to a number in [0, 2^32), leaves the nearest whole number in the last bits.
    const SHIFT: f64 = 4503599627370496.0;
    let (zero, n) = (psi.zero(), psi.like(points as f64));
    let x = psi * per_radian;
    let x = R::select(x.below(zero), x + n, x);
    // Whole numbers belong to either neighbour: n to the last interval. NaN takes the first one, and stays NaN.
    let whole = (x - 0.5).larger(zero).smaller(n - 1.0) + SHIFT;
    let floor = whole - SHIFT;
    cubic_at(whole.columns(cubics, points), x - floor, per_radian)
}

/// Radius and derivatives of a cubic at the fraction `s` of its interval, `k` intervals per radian.
#[inline(always)]
fn cubic_at<R: Real>([a, b, c, d]: [R; 4], s: R, k: f64) -> Radius<R> {
    // c + s d, c + 1.5 s d and c + 3 s d.
    let sd = s * d;
    let (c1, c2, c3) = (c + sd, c.plus_product(sd, s.like(1.5)), c.plus_product(sd, s.like(3.0)));
    Radius {
        r: a.plus_product(s, b.plus_product(s, c1)),
        d1: b.plus_product(s + s, c2) * k,
        d2: c3 * (2.0 * k * k),
    }
}

/// One bore per lane, all with the same number of control points.
#[derive(Debug, Clone)]
pub struct Bores {
    /// Number of control points.
    points: usize,
    /// Intervals per radian.
    per_radian: f64,
    /// Cubics of the bores, lane by lane `(lanes, points, 4)`; see [`Profile`].
    cubics: Vec<[f64; 4]>,
}

impl Bores {
    /// `profile` in each of `lanes` lanes.
    pub(crate) fn new(profile: &Profile, lanes: usize) -> Self {
        Bores {
            points: profile.points(),
            per_radian: profile.per_radian,
            cubics: profile.cubic.repeat(lanes),
        }
    }

    /// Replaces the bore of a lane.
    pub(crate) fn set(&mut self, lane: usize, profile: &Profile) {
        self.cubics[lane * self.points..][..self.points].copy_from_slice(&profile.cubic);
    }

    /// Radius and derivatives at angle `psi` in (-2 pi, 2 pi) [rad], of one bore per lane.
    #[inline(always)]
    pub(crate) fn radius_at<R: Real>(&self, psi: R) -> Radius<R> {
        look_up(psi, self.points, self.per_radian, &self.cubics)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bumpy(points: usize) -> Profile {
        let mut profile = Profile::round(1.5e-3, points);
        let depth: Vec<f64> =
            (0..points).map(|i| 1e-5 * (1.0 + (TAU * i as f64 / points as f64).cos())).collect();
        profile.set_depth(&depth);
        profile
    }

    #[test]
    fn interpolates_its_control_points_and_closes() {
        let p = bumpy(36);
        for (i, d) in p.depth.iter().enumerate() {
            assert!((p.radius_at(TAU * i as f64 / 36.0).r - 1.5e-3 - d).abs() < 1e-17);
        }
        let (a, b) = (p.radius_at(-1e-12), p.radius_at(1e-12));
        assert!((a.r - b.r).abs() < 1e-15 && (a.d1 - b.d1).abs() < 1e-15 && (a.d2 - b.d2).abs() < 1e-14);
    }

    #[test]
    fn converges_with_fourth_order_to_a_smooth_profile() {
        let error = |n: usize| {
            let p = bumpy(n);
            (0..1000)
                .map(|k| {
                    let psi = TAU * (k as f64 + 0.5) / 1000.0;
                    (p.radius_at(psi).r - 1.5e-3 - 1e-5 * (1.0 + psi.cos())).abs()
                })
                .fold(0.0, f64::max)
        };
        let order = (error(18) / error(36)).log2();
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let p = bumpy(36);
        for k in 0..50 {
            let (psi, h) = (0.05 + 0.12 * k as f64, 1e-5);
            let exact = p.radius_at(psi);
            assert!(((p.radius_at(psi + h).r - p.radius_at(psi - h).r) / (2.0 * h) - exact.d1).abs() < 1e-10);
            assert!(
                ((p.radius_at(psi + h).d1 - p.radius_at(psi - h).d1) / (2.0 * h) - exact.d2).abs() < 1e-9
            );
        }
    }

    #[test]
    fn chords_have_the_mean_of_the_arc() {
        // Exactly so, as the arc is a cubic; Simpson's rule has the mean of a cubic exactly, too.
        let p = bumpy(36);
        let off = |table: &[f64]| {
            let spacing = TAU / table.len() as f64;
            (0..table.len())
                .map(|k| {
                    let radius = |s: f64| p.radius_at(spacing * (k as f64 + s)).r;
                    let mean = (radius(0.0) + 4.0 * radius(0.5) + radius(1.0)) / 6.0;
                    0.5 * (table[k] + table[(k + 1) % table.len()]) - mean
                })
                .fold(0.0, |a: f64, b| a.max(b.abs()))
        };
        for sub in [1, 2, 5] {
            let mut table = vec![0.0; 36 * sub];
            p.tabulate_chords(&mut table);
            assert!(off(&table) < 1e-17, "{}", off(&table));
            p.tabulate(&mut table);
            assert!(off(&table) > 1e-10, "{}", off(&table));
        }
    }

    /// Deepest dip of the spline below zero for a spot of this depth at control points, as a share of the deepest [1].
    fn dip(points: usize, depth: impl Fn(f64) -> f64) -> f64 {
        let mut p = Profile::round(1.5e-3, points);
        let depths: Vec<f64> = (0..points).map(|i| 1e-5 * depth(TAU * i as f64 / points as f64)).collect();
        p.set_depth(&depths);
        let least = (0..3600).map(|k| p.radius_at(TAU * f64::from(k) / 3600.0).r - 1.5e-3);
        let largest = depths.iter().fold(0.0_f64, |a, d| a.max(*d));
        -least.fold(0.0, f64::min) / largest
    }

    #[test]
    fn the_spline_dips_beside_wear_that_ends_within_a_point_and_hardly_beside_wear_that_fades() {
        // A single point: the cardinal spline.
        let single = dip(36, |psi| if psi == 0.0 { 1.0 } else { 0.0 });
        assert!((single - 0.137).abs() < 1e-3, "{single}");
        // A spot 60 degrees wide, without slope at its ends.
        let half = TAU / 12.0;
        let spot = |psi: f64| {
            let x = psi.min(TAU - psi) / half;
            if x < 1.0 { (1.0 - x * x).powi(2) } else { 0.0 }
        };
        let dips = [36, 72, 144].map(|points| dip(points, spot));
        println!("single point {single:.3}, spot of 60 deg {dips:?}");
        assert!((dips[0] - 0.0212).abs() < 1e-3, "{dips:?}");
        assert!(dips[1] < dips[0] / 3.0 && dips[2] < dips[1] / 3.0, "{dips:?}");
    }

    #[test]
    fn table_agrees_with_the_spline() {
        let p = bumpy(36);
        let mut table = vec![0.0; 288];
        p.tabulate(&mut table);
        for (k, value) in table.iter().enumerate() {
            assert!((value - p.radius_at(TAU * k as f64 / 288.0).r).abs() < 1e-17);
        }
    }
}
