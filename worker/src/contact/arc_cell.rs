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
use super::integrals::{Integrals, UnitIntegrals};
use crate::lanes::Real;
use crate::plane::{fused_dot, length};

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

    /// Integrals over the arc of the bore `arc` in contact at the eccentricity `e` [m], for intervals of length one; the bore is that of
    /// the call before, unless the cells have been replaced by [`Self::NONE`]. Zeros for the second derivative unless `SECOND`.
    #[inline(always)]
    pub(super) fn integrate<const SECOND: bool>(&mut self, arc: &Arc, e: [f64; 2]) -> UnitIntegrals {
        if length(e) <= arc.reach() {
            return UnitIntegrals::none(0.0);
        }
        self.find(arc, e);
        let Some(groups) = self.groups else { return arc.integrate_units(e) };
        let centre = self.centres[self.size];
        let x = [e[0] - centre[0], e[1] - centre[1]];
        let mut ends = EndSums::NONE;
        for g in 0..groups {
            ends.add::<SECOND>(&self.ends[g], x);
        }
        let Integrals { v, p, d } = self.whole;
        let moved = [fused_dot([d[0], d[1]], x), fused_dot([d[1], d[2]], x)];
        let mut sums = Integrals {
            v: sum(&ends.v) + v + fused_dot([2.0 * p[0] + moved[0], 2.0 * p[1] + moved[1]], x),
            p: [p[0] + moved[0] + sum(&ends.p[0]), p[1] + moved[1] + sum(&ends.p[1])],
            d: [0.0; 3],
        };
        if SECOND {
            for k in 0..3 {
                sums.d[k] = d[k] + sum(&ends.d[k]);
            }
        }
        UnitIntegrals { sums, extent: d[0] + d[2] + sum(&ends.extent) }
    }

    /// Prepares the largest cell about `e` [m] with few enough intervals to look at. Whether the cell of one size will do depends on the
    /// cell alone, hence so does the cell found.
    #[inline(always)]
    fn find(&mut self, arc: &Arc, e: [f64; 2]) {
        let mut side = SIDE * arc.scale();
        let mut per_side = arc.per_scale() * (1.0 / SIDE);
        for size in 0..SIZES {
            let centre = [Real::round(e[0] * per_side) * side, Real::round(e[1] * per_side) * side];
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
            per_side *= 1.0 / SMALLER;
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

/// Sums over intervals about the ends of an arc, for intervals of length one, in [`AT_ONCE`] parts each.
struct EndSums {
    /// Twice the potential, its gradient x, y, and its second derivative xx, xy, yy.
    v: [f64; AT_ONCE],
    p: [[f64; AT_ONCE]; 2],
    d: [[f64; AT_ONCE]; 3],
    /// Shares in contact [1].
    extent: [f64; AT_ONCE],
}

impl EndSums {
    /// Nothing.
    const NONE: Self =
        EndSums { v: [0.0; AT_ONCE], p: [[0.0; AT_ONCE]; 2], d: [[0.0; AT_ONCE]; 3], extent: [0.0; AT_ONCE] };

    /// Adds these intervals at the eccentricity `x` from the centre of the cell [m]; without second derivatives unless `SECOND`.
    ///
    /// Of an interval with the larger gap h and the smaller one l the share f = h / (h - l), at most one, is in contact; the formulas are
    /// those of `integrals.rs`, without branches and with fused operations.
    #[inline(always)]
    fn add<const SECOND: bool>(&mut self, ends: &EndIntervals, x: [f64; 2]) {
        const SIXTH: f64 = 1.0 / 6.0;
        for i in 0..AT_ONCE {
            let (ux, uy, vx, vy) = (ends.u[0][i], ends.u[1][i], ends.v[0][i], ends.v[1][i]);
            let a = ends.a[i].plus_product(x[0], ux).plus_product(x[1], uy);
            let b = ends.b[i].plus_product(x[0], vx).plus_product(x[1], vy);
            let falls = b < a;
            let (high, low) = if falls { (a, b) } else { (b, a) };
            let high = if high > 0.0 { high } else { 0.0 };
            let (over, under) = if low > 0.0 { (low, 0.0) } else { (0.0, low) };
            let f = high / (high - under + f64::MIN_POSITIVE);
            let f2 = f * f;
            // Half and a sixth of the parts h f and h f^2.
            let (half, sixth) = (high * f * 0.5, high * f2 * SIXTH);
            let near = (half - sixth).plus_product(over, SIXTH);
            let far = sixth.plus_product(over, 2.0 * SIXTH);
            let (wa, wb) = if falls { (near, far) } else { (far, near) };
            self.v[i] = self.v[i].plus_product(wa, a).plus_product(wb, b);
            self.p[0][i] = self.p[0][i].plus_product(wa, ux).plus_product(wb, vx);
            self.p[1][i] = self.p[1][i].plus_product(wa, uy).plus_product(wb, vy);
            self.extent[i] += f;
            if SECOND {
                let f3 = f2 * f * (1.0 / 3.0);
                let (near, mixed, far) = (f - f2 + f3, 0.5 * f2 - f3, f3);
                let (aa, bb) = if falls { (near, far) } else { (far, near) };
                let (ax, bx) = ((aa * ux).plus_product(mixed, vx), (mixed * ux).plus_product(bb, vx));
                let (ay, by) = ((aa * uy).plus_product(mixed, vy), (mixed * uy).plus_product(bb, vy));
                self.d[0][i] = self.d[0][i].plus_product(ax, ux).plus_product(bx, vx);
                self.d[1][i] = self.d[1][i].plus_product(ay, ux).plus_product(by, vx);
                self.d[2][i] = self.d[2][i].plus_product(ay, uy).plus_product(by, vy);
            }
        }
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
    use crate::plane::dot;
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
                    let found = cell.integrate::<true>(&arc, e).scaled(arc.spacing());
                    let first = cell.integrate::<false>(&arc, e).scaled(arc.spacing());
                    assert_eq!((first.v, first.p, first.d), (found.v, found.p, [0.0; 3]));
                    let exact = arc.integrate(e);
                    let mut fresh = ArcCell::NONE;
                    let anew = fresh.integrate::<true>(&arc, e).scaled(arc.spacing());
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
                let found = cell.integrate::<true>(&arc, e).scaled(arc.spacing());
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
