//! Integrals over the arc in contact for eccentricities near each other, prepared once for all of them.
//!
//! Eccentricities e [m] are divided into square cells of side s [m] about the points of a lattice. Within a cell every gap
//! changes by s / sqrt 2 at most: intervals of the bore whose gaps are further from zero than that are in contact, or free, all over
//! the cell. Those in contact add up to one quadratic in e - e_0, with the cell's centre e_0; only the few intervals about the ends
//! of an arc have to be looked at for each eccentricity. The integrals are those of `arc.rs`, but for rounding; they
//! depend on the eccentricity alone, not on the cells met before.
//!
//! The side is [`SIDE`] c a^2 with the clearance c [m] and the angle a between the intervals [rad], or a share of that where
//! too many intervals would have to be looked at: a bore worn to the journal's shape has small gaps along wide arcs, and its
//! journal moves little.
//!
//! # Source
//! Derived here; lists of neighbours that stay valid within a margin: Verlet (1967), Physical Review 159, 98-103.

// Compiled into the loops of the lanes, where closures of iterators are not: plain loops.
#![allow(clippy::needless_range_loop)]

use super::arc::Arc;
use super::integrals::Integrals;
use crate::lanes::Real;
use crate::plane::{dot, length};

/// Side of the widest cells over c a^2 [1].
const SIDE: f64 = 40.0;
/// Factor from one size of cells to the next smaller one [1], and number of sizes.
const SMALLER: f64 = 0.125;
const SIZES: usize = 3;
/// Intervals that are evaluated at once, the number of such groups above which cells are made smaller, and the largest number.
const AT_ONCE: usize = 8;
const ENOUGH: usize = 2;
const MOST: usize = 8;

/// Intervals about the ends of an arc; where there are fewer, the others touch nothing.
#[derive(Debug, Clone, Copy)]
struct EndIntervals {
    /// Unit vectors at both ends of each interval, x and y `(2, AT_ONCE)` each [1].
    u: [[f64; AT_ONCE]; 2],
    v: [[f64; AT_ONCE]; 2],
    /// Gaps there at the centre of the cell `(AT_ONCE,)` each [m].
    a: [f64; AT_ONCE],
    b: [f64; AT_ONCE],
}

impl EndIntervals {
    /// A set without any interval.
    const NONE: Self = EndIntervals {
        u: [[0.0; AT_ONCE]; 2],
        v: [[0.0; AT_ONCE]; 2],
        a: [-1.0; AT_ONCE],
        b: [-1.0; AT_ONCE],
    };
}

/// The cells met last, each within the one before.
#[derive(Debug, Clone)]
pub struct ArcCell {
    /// Centres e_0 of the cells of each size `(SIZES, 2)` [m]; not a number if there is no such cell.
    centres: [[f64; 2]; SIZES],
    /// Size of the smallest cell.
    size: usize,
    /// Sums of the intervals in contact all over the smallest cell, at its centre and for intervals of length one.
    whole: Integrals,
    /// The other intervals that may touch, in groups.
    ends: [EndIntervals; MOST],
    /// Number of these groups; `None` if even the smallest cells have too many.
    groups: Option<usize>,
}

impl ArcCell {
    /// No cell yet.
    pub(super) const NONE: Self = ArcCell {
        centres: [[f64::NAN; 2]; SIZES],
        size: 0,
        whole: Integrals { v: 0.0, p: [0.0; 2], d: [0.0; 3] },
        ends: [EndIntervals::NONE; MOST],
        groups: None,
    };

    /// Integrals over the arc of the bore `arc` in contact at the eccentricity `e` [m]; the bore is that of the call before, unless
    /// the cells have been replaced by [`Self::NONE`].
    #[inline(always)]
    pub(super) fn integrate(&mut self, arc: &Arc, e: [f64; 2]) -> Integrals {
        if length(e) <= arc.reach() {
            return Integrals::default();
        }
        self.find(arc, e);
        let Some(groups) = self.groups else { return arc.integrate(e) };
        let centre = self.centres[self.size];
        let x = [e[0] - centre[0], e[1] - centre[1]];
        let mut sums = [[0.0; AT_ONCE]; 6];
        for g in 0..groups {
            add_ends(&mut sums, &self.ends[g], x);
        }
        let [v, px, py] = [sum(&sums[0]), sum(&sums[1]), sum(&sums[2])];
        let [xx, xy, yy] = [sum(&sums[3]), sum(&sums[4]), sum(&sums[5])];
        let mut all = self.whole;
        let moved = [all.d[0] * x[0] + all.d[1] * x[1], all.d[1] * x[0] + all.d[2] * x[1]];
        all.v += v + 2.0 * dot(all.p, x) + dot(moved, x);
        all.p = [all.p[0] + moved[0] + px, all.p[1] + moved[1] + py];
        all.d = [all.d[0] + xx, all.d[1] + xy, all.d[2] + yy];
        arc.finished(all)
    }

    /// Prepares the largest cell about `e` [m] with few enough intervals to look at. Whether the cell of one size will do depends on the
    /// cell alone, hence so does the cell found.
    #[inline(always)]
    fn find(&mut self, arc: &Arc, e: [f64; 2]) {
        let mut side = SIDE * arc.scale();
        for size in 0..SIZES {
            let centre = [Real::round(e[0] / side) * side, Real::round(e[1] / side) * side];
            if centre != self.centres[size] {
                for smaller in size..SIZES {
                    self.centres[smaller] = [f64::NAN; 2];
                }
                self.centres[size] = centre;
                self.size = size;
                self.fill(arc, side);
                if self.groups.is_some_and(|groups| groups <= ENOUGH) {
                    return;
                }
            } else if size == self.size {
                return;
            }
            side *= SMALLER;
        }
    }

    /// Prepares the smallest cell, of side `side` [m].
    #[inline(always)]
    fn fill(&mut self, arc: &Arc, side: f64) {
        // Half the diagonal, and a little for rounding and for unit vectors that are slightly longer than one.
        let margin = 0.72 * side;
        self.whole = Integrals::default();
        let ends = &mut self.ends;
        let mut found = 0;
        arc.visit_near(self.centres[self.size], margin, &mut self.whole, |[a, b], [u, v]| {
            let (group, i) = (found / AT_ONCE, found % AT_ONCE);
            if group == MOST {
                return;
            }
            found += 1;
            if i == 0 {
                ends[group] = EndIntervals::NONE;
            }
            let to = &mut ends[group];
            (to.a[i], to.b[i]) = (a, b);
            for k in 0..2 {
                (to.u[k][i], to.v[k][i]) = (u[k], v[k]);
            }
        });
        // With the last group full there may be more.
        self.groups = (found < MOST * AT_ONCE).then_some(found.div_ceil(AT_ONCE));
    }
}

/// Adds twice the potential, its gradient x, y and its second derivative xx, xy, yy of these intervals at the eccentricity `x` from
/// the centre of the cell [m], for intervals of length one.
///
/// Of an interval with the larger gap h and the smaller one l the share f = h / (h - l), at most one, is in contact; the formulas are
/// those of `arc.rs`, without branches.
#[inline(always)]
fn add_ends(sums: &mut [[f64; AT_ONCE]; 6], ends: &EndIntervals, x: [f64; 2]) {
    for i in 0..AT_ONCE {
        let (ux, uy, vx, vy) = (ends.u[0][i], ends.u[1][i], ends.v[0][i], ends.v[1][i]);
        let a = ends.a[i] + (x[0] * ux + x[1] * uy);
        let b = ends.b[i] + (x[0] * vx + x[1] * vy);
        let falls = b < a;
        let (high, low) = if falls { (a, b) } else { (b, a) };
        let high = if high > 0.0 { high } else { 0.0 };
        let (over, under) = if low > 0.0 { (low, 0.0) } else { (0.0, low) };
        let f = high / (high - under + f64::MIN_POSITIVE);
        let (f2, f3) = (f * f, f * f * f * (1.0 / 3.0));
        let near = high * (0.5 * f - f2 * (1.0 / 6.0)) + over * (1.0 / 6.0);
        let far = high * f2 * (1.0 / 6.0) + over * (1.0 / 3.0);
        let (near_2, mixed, far_2) = (f - f2 + f3, 0.5 * f2 - f3, f3);
        let (wa, wb) = if falls { (near, far) } else { (far, near) };
        let (aa, bb) = if falls { (near_2, far_2) } else { (far_2, near_2) };
        sums[0][i] += wa * a + wb * b;
        sums[1][i] += wa * ux + wb * vx;
        sums[2][i] += wa * uy + wb * vy;
        sums[3][i] += aa * ux * ux + 2.0 * mixed * ux * vx + bb * vx * vx;
        sums[4][i] += aa * ux * uy + mixed * (ux * vy + vx * uy) + bb * vx * vy;
        sums[5][i] += aa * uy * uy + 2.0 * mixed * uy * vy + bb * vy * vy;
    }
}

/// Sum of the numbers, in pairs.
#[inline(always)]
fn sum(x: &[f64; AT_ONCE]) -> f64 {
    ((x[0] + x[4]) + (x[2] + x[6])) + ((x[1] + x[5]) + (x[3] + x[7]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bore::Profile;
    use std::f64::consts::TAU;

    const JOURNAL: f64 = 1.5e-3;
    const CLEARANCE: f64 = 23.5e-6;

    /// Numbers in [0, 1) that follow no rule.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A bore worn to the shape of a journal that moved out by up to `depth` [m] in directions within `width` of zero [rad], with
    /// depths of up to `rough` [m] on top.
    fn worn(depth: f64, width: f64, rough: f64, state: &mut u64) -> Arc {
        let points = 36;
        let mut profile = Profile::round(JOURNAL + CLEARANCE, points);
        let depths: Vec<f64> = (0..points)
            .map(|i| {
                let angle = TAU * i as f64 / points as f64;
                let reach = |k: i32| {
                    let to = f64::from(k) / 20.0;
                    (CLEARANCE + depth * (1.0 - 0.5 * to * to)) * (angle - to * width).cos()
                };
                let scar = (-20..=20).map(reach).fold(CLEARANCE, f64::max) - CLEARANCE;
                scar + rough * random(state)
            })
            .collect();
        profile.set_depth(&depths);
        let mut arc = Arc::new(JOURNAL, CLEARANCE, points, 720);
        arc.profile_changed(&profile);
        arc
    }

    /// Eccentricities of a walk along the bore in steps of up to `step` [m], in and out of contact.
    fn walk(arc: &Arc, step: f64, state: &mut u64) -> Vec<[f64; 2]> {
        let mut angle = 0.0_f64;
        let eccentricities = (0..2000).map(|_| {
            angle += (random(state) - 0.45) * step / CLEARANCE;
            let u = [angle.cos(), angle.sin()];
            let reach = CLEARANCE - arc.gap_along([CLEARANCE * u[0], CLEARANCE * u[1]]);
            let r = reach - 1e-7 + 10f64.powf(-9.0 + 3.5 * random(state));
            [r * u[0], r * u[1]]
        });
        eccentricities.collect()
    }

    #[test]
    fn cells_give_the_integrals_of_the_arc_whatever_cells_were_met_before() {
        let mut state = 7;
        let (mut worst, mut touching, mut too_many) = (0.0_f64, 0, 0);
        for (depth, width, rough) in
            [(0.0, 0.0, 0.0), (5e-6, 0.5, 0.0), (30e-6, 0.1, 0.0), (30e-6, 0.7, 0.0), (15e-6, 0.4, 1e-6)]
        {
            let arc = worn(depth, width, rough, &mut state);
            for step in [1e-9, 3e-8, 1e-5] {
                let mut cell = ArcCell::NONE;
                for e in walk(&arc, step, &mut state) {
                    let (found, exact) = (cell.integrate(&arc, e), arc.integrate(e));
                    let mut fresh = ArcCell::NONE;
                    let anew = fresh.integrate(&arc, e);
                    let bits = |of: &Integrals| {
                        [of.v, of.p[0], of.p[1], of.d[0], of.d[1], of.d[2]].map(f64::to_bits)
                    };
                    assert_eq!(bits(&found), bits(&anew), "{e:?}");
                    too_many += usize::from(cell.groups.is_none());
                    let (size, extent) = (length(exact.p), exact.d[0] + exact.d[2]);
                    // Lighter contacts lose digits to rounding: 1e-9 m of 2e-5 m leaves eleven.
                    if size < 1e-9 * 0.01 {
                        continue;
                    }
                    touching += 1;
                    worst = worst.max((found.v / exact.v - 1.0).abs());
                    for k in 0..2 {
                        worst = worst.max((found.p[k] - exact.p[k]).abs() / size);
                    }
                    for k in 0..3 {
                        worst = worst.max((found.d[k] - exact.d[k]).abs() / extent);
                    }
                }
            }
        }
        println!("{touching} contacts within {worst:e}, {too_many} times too many intervals");
        assert!(touching > 10_000, "{touching}");
        assert!(worst < 1e-6, "{worst}");
    }

    #[test]
    fn the_force_is_the_gradient_of_the_potential_across_cells() {
        // Along a straight path the potential grows by the integral of its slope, by Simpson's rule over steps much shorter than a cell.
        let mut state = 3;
        let arc = worn(20e-6, 0.5, 5e-7, &mut state);
        let mut cell = ArcCell::NONE;
        for direction in [0.3_f64, 1.2, 2.2] {
            let u = [0.4_f64.cos(), 0.4_f64.sin()];
            let reach = CLEARANCE - arc.gap_along([CLEARANCE * u[0], CLEARANCE * u[1]]);
            let (t, length) = ([direction.cos(), direction.sin()], 4e-7);
            let mut at = |s: f64| {
                let e = [0, 1].map(|k| (reach + 1e-7) * u[k] + s * length * t[k]);
                let found = cell.integrate(&arc, e);
                (found.v, dot(found.p, t))
            };
            let steps = 4000;
            let grown: f64 = (0..steps)
                .map(|k| {
                    let s = |half: f64| (f64::from(k) + half) / f64::from(steps);
                    let (begin, middle, end) = (at(s(0.0)).1, at(s(0.5)).1, at(s(1.0)).1);
                    (begin + 4.0 * middle + end) / 6.0 * length / f64::from(steps)
                })
                .sum();
            let (begin, end) = (at(0.0).0, at(1.0).0);
            let off = (grown - (end - begin)).abs() / end.max(begin);
            assert!(off < 1e-10, "{direction} rad: {off}");
        }
    }
}
