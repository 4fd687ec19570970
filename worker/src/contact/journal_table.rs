//! Wear depth of a journal at the angles of an elastic foundation, whatever the angle by which it is turned.
//!
//! The foundation is tabulated at the angles psi_k = k s in the bushing's frame, of which a whole number lies
//! between two control points. A journal turned by alpha has there the depth h(psi_k - alpha) [m]. The
//! fraction f of -alpha / s is the same for all angles: with the base index b = floor(-alpha / s) the depth at
//! psi_k is the cubic number b + k of the table at f, a + f (b + f (c + f d)). The depth in the table is h -
//! h'' s^2 / 12, as that of the bore (`arc.rs`), by the spline through the values of that at the control
//! points: it stays twice continuously differentiable in alpha.
//!
//! # Source
//! Derived here.
//!
//! # Journals
//! Surface of a journal with its wear, which turns with the journal's body.
//!
//! R_j(chi) = R1 - h(chi) [m]: R1 the unworn radius, h the periodic cubic spline (`bore.rs`) through the wear
//! depths of control points at equal angles chi [rad] in the frame of the journal's body. With the angle
//! alpha = phi_journal - phi_bushing [rad] between the bodies, the place chi of the journal lies at the angle
//! psi = chi + alpha in the bushing's frame, and what a contact law of e and psi takes for the bore is there
//!
//!   R(psi) + h(psi - alpha),
//!
//! with the worn bore R [m]: the unworn journal in it leaves the gap of the two worn surfaces.
//!
//! Source:
//! The turning profile is derived here. Wear of revolute joints in multibody systems: Mukras, Kim, Mauntler,
//! Schmitz, Sawyer (2010), Wear 268, 643-652. Splines: de Boor (1978), A Practical Guide to Splines.

use super::segment::SEGMENT;
use crate::bore::{Profile, Radius};
use crate::interpolate::Cubic;
use crate::lanes::Real;
use std::f64::consts::TAU;

/// Tabulated depth of one journal.
#[derive(Debug, Clone, PartialEq)]
pub struct JournalTable {
    /// Number of table intervals n of a turn.
    intervals: usize,
    /// Spline through h - h'' s^2 / 12 at the control points.
    chords: Profile,
    /// Coefficients of the cubics in the fraction of a table interval, over two turns and a segment more
    /// `(2 n + SEGMENT + 1,)` each [m].
    cubic: [Vec<f64>; 4],
    /// Lower bound of the depth over each [`SEGMENT`] table intervals [m].
    least: Vec<f64>,
}

/// Place of a turned journal on the foundation: table interval of the journal at the angle zero of the foundation, and the fraction there.
pub type Rotated = (usize, f64);

impl JournalTable {
    /// An unworn journal with `points` control points, on a foundation of `intervals` intervals, a multiple
    /// of the points.
    pub(super) fn new(points: usize, intervals: usize) -> Self {
        let length = 2 * intervals + SEGMENT + 1;
        JournalTable {
            intervals,
            chords: Profile::round(0.0, points),
            cubic: std::array::from_fn(|_| vec![0.0; length]),
            least: vec![0.0; length.div_ceil(SEGMENT)],
        }
    }

    /// Tabulates a changed depth, the radius of the profile `worn`.
    pub(super) fn tabulate(&mut self, worn: &Profile) {
        let points = worn.points();
        let sub = self.intervals / points;
        self.chords.set_depth(&worn.chord_depth(sub));
        let step = 1.0 / sub as f64;
        for j in 0..self.cubic[0].len() {
            let within = j % self.intervals;
            let (cubic, o) = (Cubic(self.chords.cubic[within / sub]), (within % sub) as f64 * step);
            let values = [
                cubic.value(o),
                cubic.slope(o) * step,
                0.5 * cubic.curvature(o) * step * step,
                cubic.0[3] * step * step * step,
            ];
            for (to, value) in self.cubic.iter_mut().zip(values) {
                to[j] = value;
            }
        }
        // Least of the Bezier coefficients of a cubic, a lower bound of its values.
        let [a, b, c, d] = &self.cubic;
        let bound = |j: usize| {
            a[j].min(a[j] + b[j] / 3.0).min(a[j] + (2.0 * b[j] + c[j]) / 3.0).min(a[j] + b[j] + c[j] + d[j])
        };
        for (block, least) in self.least.iter_mut().enumerate() {
            let last = (block * SEGMENT + SEGMENT).min(a.len());
            *least = (block * SEGMENT..last).map(bound).fold(f64::INFINITY, f64::min);
        }
    }

    /// Place of the journal turned by `alpha` [rad].
    #[inline(always)]
    pub(super) fn turned(&self, alpha: f64) -> Rotated {
        let n = self.intervals as f64;
        let place = (-alpha * (n / TAU)).rem_euclid(n);
        // A place just below zero is rounded to a whole turn.
        let place = if place < n { place } else { 0.0 };
        let base = place as usize;
        (base, place - base as f64)
    }

    /// Place of the journal where the angle zero of the foundation is at the beginning of its interval `base`, a whole number counted on over
    /// full turns.
    #[inline(always)]
    pub(super) fn in_interval(&self, base: f64) -> Rotated {
        (base.rem_euclid(self.intervals as f64) as usize, 0.0)
    }

    /// Coefficients in the fraction of the cubics of the depth at `count` angles of the foundation from the angle `first` on `(4, count)` [m].
    #[inline(always)]
    pub(super) fn cubics(&self, at: Rotated, first: usize, count: usize) -> [&[f64]; 4] {
        let (from, [a, b, c, d]) = (at.0 + first, &self.cubic);
        let to = from + count;
        [&a[from..to], &b[from..to], &c[from..to], &d[from..to]]
    }

    /// Lower bound of the depth over the segment that begins at the angle `first` of the foundation [m].
    #[inline(always)]
    pub(super) fn least(&self, at: Rotated, first: usize) -> f64 {
        let block = (at.0 + first) / SEGMENT;
        self.least[block].min(self.least[block + 1])
    }

    /// Depth at `N` angles of the foundation from the angle `first` on, at most the turn and a segment `(N,)` [m], with its first and second
    /// derivatives to the angle alpha of the journal [m/rad, m/rad^2].
    #[inline(always)]
    pub(super) fn depths<const N: usize>(&self, (base, f): Rotated, first: usize) -> [[f64; N]; 3] {
        let from = base + first;
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| &self.cubic[k][from..from + N]);
        let per_angle = self.intervals as f64 / TAU;
        let mut out = [[0.0; N]; 3];
        for i in 0..N {
            let fd = f * d[i];
            out[0][i] = a[i] + f * (b[i] + f * (c[i] + fd));
            out[1][i] = -per_angle * (b[i] + f * (2.0 * c[i] + 3.0 * fd));
            out[2][i] = per_angle * per_angle * (2.0 * c[i] + 6.0 * fd);
        }
        out
    }
}

/// Surface of a journal that wears.
#[derive(Debug, Clone, PartialEq)]
pub struct Journal {
    /// Unworn radius R1 [m].
    pub(crate) unworn: f64,
    /// Depth h, as the radius of a profile whose unworn radius is zero.
    pub(crate) worn: Profile,
    /// Depth at the angles of the elastic foundation, for a law that has one.
    pub(super) table: Option<JournalTable>,
}

/// The two surfaces of a joint.
#[derive(Debug, Clone, Copy)]
pub struct Surfaces<'a> {
    /// The bore, worn so far.
    pub bore: &'a Profile,
    /// The journal, worn so far; `None` if it stays round.
    pub journal: Option<&'a Journal>,
}

impl<'a> From<&'a Profile> for Surfaces<'a> {
    fn from(bore: &'a Profile) -> Self {
        Surfaces { bore, journal: None }
    }
}

impl Journal {
    /// An unworn journal of radius `radius` [m] with `points` control points, tabulated at `intervals` equal intervals for an elastic
    /// foundation of as many.
    pub(super) fn new(radius: f64, points: usize, intervals: Option<usize>) -> Self {
        let table = intervals.map(|intervals| JournalTable::new(points, intervals));
        Journal { unworn: radius, worn: Profile::round(0.0, points), table }
    }

    /// Replaces the wear depths at the control points by `depth` `(points,)` [m].
    pub fn set_depth(&mut self, depth: &[f64]) {
        self.worn.set_depth(depth);
        if let Some(table) = &mut self.table {
            table.tabulate(&self.worn);
        }
    }

    /// Radius R_j and its derivatives at the angle `chi` [rad] in the frame of the journal's body.
    #[inline(always)]
    pub fn radius_at(&self, chi: f64) -> Radius {
        worn_radius(self.unworn, self.worn.radius_at(within_a_turn(chi)))
    }
}

/// Radius R1 - h of a journal with the unworn radius R1 `radius` [m], from the depth h.
#[inline(always)]
pub(super) fn worn_radius<R: Real>(radius: R, depth: Radius<R>) -> Radius<R> {
    Radius { r: radius - depth.r, d1: -depth.d1, d2: -depth.d2 }
}

/// An angle without its whole turns, within half a turn of zero [rad].
#[inline(always)]
pub(super) fn within_a_turn<R: Real>(angle: R) -> R {
    angle.minus_product((angle * (1.0 / TAU)).round(), angle.like(TAU))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_journal_has_its_depth_at_the_angles_of_the_foundation() {
        let (points, intervals) = (36, 720);
        let mut worn = Profile::round(0.0, points);
        let depth: Vec<f64> =
            (0..points).map(|i| 4e-6 * (1.0 + (TAU * i as f64 / points as f64).cos()).powi(2)).collect();
        worn.set_depth(&depth);
        let mut table = JournalTable::new(points, intervals);
        table.tabulate(&worn);
        let spacing = TAU / intervals as f64;
        let chord = |psi: f64| {
            let at = worn.radius_at(psi.rem_euclid(TAU));
            at.r - at.d2 * spacing * spacing / 12.0
        };
        for alpha in [0.0, 0.3, -2.0, 3.1, 40.0 * TAU + 1.0, -1e-18] {
            let at = table.turned(alpha);
            for first in [0, 16, 352, 704] {
                let found = table.depths::<17>(at, first);
                let least = table.least(at, first);
                for i in 0..17 {
                    let psi = (first + i) as f64 * spacing;
                    // The correction is that of the control points, interpolated.
                    assert!((found[0][i] - chord(psi - alpha)).abs() < 2e-12, "{alpha}, {psi}");
                    assert!(found[0][i] >= least);
                    let h = 1e-4;
                    let [after, before] = [h, -h].map(|h| table.depths::<17>(table.turned(alpha + h), first));
                    let slope = (after[0][i] - before[0][i]) / (2.0 * h);
                    let bend = (after[1][i] - before[1][i]) / (2.0 * h);
                    assert!((found[1][i] - slope).abs() < 1e-11, "{alpha}: {} against {slope}", found[1][i]);
                    assert!((found[2][i] - bend).abs() < 1e-7, "{alpha}: {} against {bend}", found[2][i]);
                }
            }
        }
    }
}
