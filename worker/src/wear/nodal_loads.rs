//! Shares of a contact arc per control point: integrals of the gap function times the hat function of each point.
//!
//! Over the arc in contact at the eccentricity e [m], with the gap function g [m], linear between the angles of the tabulated bore
//! (`contact/arc.rs`), and the hat function phi_i [1] of control point i, the share of that point is s_i = integral of g phi_i
//! [m rad]. Where g is positive it is linear in e, g = e.u - b with the unit vector u and b = R - R1 [m], so that sums of the integrals of u phi_i and
//! b phi_i over the first intervals behind a control point give those over any number of its intervals at once. Intervals in contact
//! in part, at the ends of an arc, count one by one. Both are exact for that g.
//!
//! The shares of all points add up to more than the arc presses with, the length of the vector p = integral of g u [m rad]: pressures
//! from both sides of a wide arc partly cancel.
//!
//! # Source
//! Derived here, for the Winkler foundation of `contact/foundation.rs`.
//!
//! # In front of a worn journal
//! Shares of contacts with a worn journal per angle of the table, of the bore and of the journal.
//!
//! With the journal turned by the fraction f of an interval, an angle of the bore's table lies between two angles of the journal's table: the
//! shares 1 - f and f are added there. Hat functions of control points, which are angles of the table, are linear in between: this is exact.
//!
//! Source:
//! Derived here.

// Compiled for the instructions of the processor, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use crate::contact::{Arc, ArcVisitor, SegmentParts};

/// Sums over the first intervals behind a control point, for intervals of length one.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    /// Integral of u phi_i, x and y, and of u phi_(i+1), x and y [1].
    hats: [f64; 4],
    /// Integral of u u, entries xx, xy, yy [1].
    directions: [f64; 3],
    /// Integral of b phi_i and of b phi_(i+1) [m], and of b u, x and y [m].
    radial_gap: [f64; 4],
}

/// Sums of a tabulated bore.
#[derive(Debug, Clone)]
pub struct NodalLoads {
    /// Intervals between two control points.
    between: usize,
    /// Sums over none to all intervals behind each control point `(points, between + 1)`.
    sums: Vec<Moments>,
}

/// Shares of one arc, for intervals of length one.
#[derive(Debug, Clone, Default)]
pub struct ArcShares {
    /// Control point, and what it and the next one get [m]; points can appear several times.
    pub each: Vec<(usize, [f64; 2])>,
    /// The vector p, x and y [m].
    pub pressed: [f64; 2],
}

impl NodalLoads {
    /// Sums of a bore with `points` control points, tabulated in `arc` at a multiple of them.
    pub(super) fn new(arc: &Arc, points: usize) -> Self {
        let between = arc.intervals() / points;
        let mut of = NodalLoads { between, sums: vec![Moments::default(); points * (between + 1)] };
        for i in 0..points {
            for j in 0..between {
                let ((u, _), (v, _)) = (arc.angle(i * between + j), arc.angle(i * between + j + 1));
                let at = i * (between + 1) + j;
                let mut sum = of.sums[at];
                let hats = of.hats(j);
                for k in 0..2 {
                    sum.hats[k] += linear(u[k], v[k], hats[0]);
                    sum.hats[2 + k] += linear(u[k], v[k], hats[1]);
                }
                for (entry, [k, l]) in sum.directions.iter_mut().zip([[0, 0], [0, 1], [1, 1]]) {
                    *entry += linear(u[k], v[k], [u[l], v[l]]);
                }
                of.sums[at + 1] = sum;
            }
        }
        of.tabulate(arc);
        of
    }

    /// Takes over a changed bore.
    #[inline(always)]
    pub(super) fn tabulate(&mut self, arc: &Arc) {
        let points = self.sums.len() / (self.between + 1);
        for i in 0..points {
            let mut radial_gap = [0.0; 4];
            let (mut u, mut a) = arc.angle(i * self.between);
            for j in 0..self.between {
                let (v, b) = arc.angle(i * self.between + j + 1);
                let hats = self.hats(j);
                radial_gap[0] += linear(a, b, hats[0]);
                radial_gap[1] += linear(a, b, hats[1]);
                radial_gap[2] += linear(a, b, [u[0], v[0]]);
                radial_gap[3] += linear(a, b, [u[1], v[1]]);
                self.sums[i * (self.between + 1) + j + 1].radial_gap = radial_gap;
                (u, a) = (v, b);
            }
        }
    }

    /// Hat functions of a control point and of the next one at both ends of the interval `j` behind it `(2, 2)` [1].
    #[inline(always)]
    fn hats(&self, j: usize) -> [[f64; 2]; 2] {
        let per = 1.0 / self.between as f64;
        let (s, t) = (j as f64 * per, (j + 1) as f64 * per);
        [[1.0 - s, 1.0 - t], [s, t]]
    }

    /// Shares of the arc of the tabulated bore `arc` in contact at the eccentricity `e` [m].
    #[inline(always)]
    pub(super) fn shares(&self, arc: &Arc, e: [f64; 2], shares: &mut ArcShares) {
        shares.each.clear();
        shares.pressed = [0.0; 2];
        arc.visit(e, &mut Collector { sums: self, e, shares });
    }
}

/// Integral of the product of two functions, linear over an interval of length one with the values `a`, `b` and `c` at its ends.
#[inline(always)]
fn linear(a: f64, b: f64, c: [f64; 2]) -> f64 {
    const SIXTH: f64 = 1.0 / 6.0;
    (a * (2.0 * c[0] + c[1]) + b * (c[0] + 2.0 * c[1])) * SIXTH
}

/// Collects the shares of an arc.
struct Collector<'a> {
    sums: &'a NodalLoads,
    e: [f64; 2],
    shares: &'a mut ArcShares,
}

impl ArcVisitor for Collector<'_> {
    #[inline(always)]
    fn whole(&mut self, from: usize, to: usize) {
        let between = self.sums.between;
        let [x, y] = self.e;
        let mut k = from;
        while k < to {
            let i = k / between;
            let last = between.min(to - i * between);
            let at = i * (between + 1);
            let (a, b) = (&self.sums.sums[at + k - i * between], &self.sums.sums[at + last]);
            let (mut hats, mut directions, mut radial_gap) = ([0.0; 4], [0.0; 3], [0.0; 4]);
            for n in 0..4 {
                hats[n] = b.hats[n] - a.hats[n];
                radial_gap[n] = b.radial_gap[n] - a.radial_gap[n];
            }
            for n in 0..3 {
                directions[n] = b.directions[n] - a.directions[n];
            }
            let of = [x * hats[0] + y * hats[1] - radial_gap[0], x * hats[2] + y * hats[3] - radial_gap[1]];
            self.shares.each.push((i, of));
            self.shares.pressed[0] += x * directions[0] + y * directions[1] - radial_gap[2];
            self.shares.pressed[1] += x * directions[1] + y * directions[2] - radial_gap[3];
            k = i * between + last;
        }
    }

    #[inline(always)]
    fn end(&mut self, k: usize, parts: [f64; 2], directions: [[f64; 2]; 2]) {
        let i = k / self.sums.between;
        let [here, next] = self.sums.hats(k - i * self.sums.between);
        let of = |hat: [f64; 2]| parts[0] * hat[0] + parts[1] * hat[1];
        self.shares.each.push((i, [of(here), of(next)]));
        for n in 0..2 {
            self.shares.pressed[n] += parts[0] * directions[0][n] + parts[1] * directions[1][n];
        }
    }
}

/// Sums over samples, per angle of the table.
#[derive(Debug, Clone, Default)]
pub struct IntervalLoads {
    /// Number of intervals of a turn.
    intervals: usize,
    /// Angles of the bore counted over one turn and a segment more, of the journal over two [N m].
    bore: Vec<f64>,
    journal: Vec<f64>,
}

impl IntervalLoads {
    /// Empties the sums, for tables with `intervals` in a turn.
    pub(super) fn clear(&mut self, intervals: usize) {
        self.intervals = intervals;
        let more = SegmentParts::ANGLES + 1;
        for (sums, turns) in [(&mut self.bore, 1), (&mut self.journal, 2)] {
            sums.clear();
            sums.resize(turns * intervals + more, 0.0);
        }
    }

    /// Adds `scale` times these parts, with the journal's interval `base` at the first angle of the bore and the fraction `f` there.
    #[inline(always)]
    pub(super) fn add(&mut self, parts: &[SegmentParts], (base, f): (usize, f64), scale: f64) {
        let (here, next) = (scale * (1.0 - f), scale * f);
        for of in parts {
            let bore = &mut self.bore[of.first..of.first + SegmentParts::ANGLES];
            for i in 0..SegmentParts::ANGLES {
                bore[i] += scale * of.part[i];
            }
            let first = base + of.first;
            let journal = &mut self.journal[first..first + SegmentParts::ANGLES + 1];
            for i in 0..SegmentParts::ANGLES {
                journal[i] += here * of.part[i];
            }
            for i in 0..SegmentParts::ANGLES {
                journal[i + 1] += next * of.part[i];
            }
        }
    }

    /// Adds the sums to the control points of the bore and then those of the journal, whose number divides that of the intervals.
    pub(super) fn share_out(&self, to: &mut [f64]) {
        let (bore, journal) = to.split_at_mut(to.len() / 2);
        for (points, sums) in [(bore, &self.bore), (journal, &self.journal)] {
            let (n, between) = (points.len(), self.intervals / points.len());
            for (k, amount) in sums.iter().enumerate() {
                let (i, s) = ((k / between) % n, (k % between) as f64 / between as f64);
                points[i] += amount * (1.0 - s);
                points[if i + 1 == n { 0 } else { i + 1 }] += amount * s;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bore::Profile;
    use crate::plane::dot;
    use std::f64::consts::TAU;

    #[test]
    fn shares_are_the_integrals_of_the_gap_times_the_hat_functions() {
        let (journal, clearance) = (1.5e-3, 23.5e-6);
        for (points, intervals) in [(36, 288), (72, 288), (18, 288), (12, 288), (100, 288)] {
            let mut profile = Profile::round(journal + clearance, points);
            // A scar with roughness on top.
            let depth = |i: usize| {
                let psi = TAU * i as f64 / points as f64;
                15e-6 * (0.5 + 0.5 * psi.cos()).powi(3) + 4e-7 * (0.5 + 0.5 * (7.3 * (i * i) as f64).sin())
            };
            profile.set_depth(&(0..points).map(depth).collect::<Vec<f64>>());
            let mut arc = Arc::new(journal, clearance, points, intervals);
            let mut sums = NodalLoads::new(&arc, points);
            arc.profile_changed(&profile);
            sums.tabulate(&arc);
            let mut shares = ArcShares::default();
            for step in 0..60 {
                let psi = 0.21 * f64::from(step);
                let u = [psi.cos(), psi.sin()];
                let reach = clearance - arc.gap_along([clearance * u[0], clearance * u[1]]);
                for penetration in [2e-8, 3e-7, 4e-6] {
                    let e = u.map(|u| (reach + penetration) * u);
                    sums.shares(&arc, e, &mut shares);
                    let (mut found, mut expected) = (vec![0.0; points], vec![0.0; points]);
                    for &(i, [here, next]) in &shares.each {
                        found[i] += here;
                        found[(i + 1) % points] += next;
                    }
                    // Every interval by the midpoint rule.
                    const PARTS: usize = 400;
                    let mut pressed = [0.0; 2];
                    let n = arc.intervals();
                    for k in 0..n {
                        let ((u, a), (v, b)) = (arc.angle(k), arc.angle(k + 1));
                        let (a, b) = (dot(e, u) - a, dot(e, v) - b);
                        for part in 0..PARTS {
                            let s = (part as f64 + 0.5) / PARTS as f64;
                            let g = (a + s * (b - a)).max(0.0) / PARTS as f64;
                            let place = (k as f64 + s) * points as f64 / n as f64;
                            let i = place as usize;
                            expected[i] += g * (1.0 - (place - i as f64));
                            expected[(i + 1) % points] += g * (place - i as f64);
                            for (n, pressed) in pressed.iter_mut().enumerate() {
                                *pressed += g * (u[n] + s * (v[n] - u[n]));
                            }
                        }
                    }
                    let all: f64 = expected.iter().sum();
                    let off = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    let turned = (0..2).map(|n| (shares.pressed[n] - pressed[n]).abs()).fold(0.0, f64::max);
                    assert!(all > 0.0 && off < 1e-4 * all, "{points} points, {psi}: {off} of {all}");
                    assert!(turned < 1e-4 * all, "{points} points, {psi}: {turned} of {all}");
                }
            }
        }
    }
}
