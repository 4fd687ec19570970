//! Cells of eccentricities give the integrals of the arc, whatever was met before and in other lanes.

use crate::bore::Profile;
use crate::contact::arc::Arc;
use crate::contact::arc_cells::ArcCells;
use crate::contact::integrals::Integrals;
use crate::lanes::{InLanes, Real, in_widest_lanes};
use crate::plane::{dot, length};
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
            let mut cells = ArcCells::new(&arc, 0.0);
            let arcs = [arc.clone()];
            for e in walk(&arc, step, &mut state) {
                let found = cells.integrate::<true>(&arcs, e).scaled(arc.spacing);
                let first = cells.integrate::<false>(&arcs, e).scaled(arc.spacing);
                assert_eq!((first.v, first.p, first.d), (found.v, found.p, [0.0; 3]));
                let exact = arc.integrate(e);
                let mut fresh = ArcCells::new(&arc, 0.0);
                let anew = fresh.integrate::<true>(&arcs, e).scaled(arc.spacing);
                let bits =
                    |of: &Integrals| [of.v, of.p[0], of.p[1], of.d[0], of.d[1], of.d[2]].map(f64::to_bits);
                assert_eq!(bits(&found), bits(&anew), "{e:?}");
                too_many += usize::from(cells.cells.overfull);
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
    let mut cells = ArcCells::new(&arc, 0.0);
    let arcs = [arc.clone()];
    for direction in [0.3_f64, 1.2, 2.2] {
        let u = [0.4_f64.cos(), 0.4_f64.sin()];
        let reach = CLEARANCE - arc.gap_along([CLEARANCE * u[0], CLEARANCE * u[1]]);
        let (t, length) = ([direction.cos(), direction.sin()], 4e-7);
        let mut at = |s: f64| {
            let e = [0, 1].map(|k| (reach + 1e-7) * u[k] + s * length * t[k]);
            let found = cells.integrate::<true>(&arcs, e).scaled(arc.spacing);
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

/// Walks along other bores in every lane, which are replaced on the way.
struct InEveryLane;

impl InLanes for InEveryLane {
    fn run<R: Real>(self, like: R) {
        let mut state = 11;
        let mut cells = ArcCells::new(&Arc::out_of_reach(), like);
        for (depth, width, rough) in [(5e-6, 0.5, 0.0), (30e-6, 0.7, 0.0), (15e-6, 0.4, 1e-6)] {
            let mut arcs = vec![Arc::out_of_reach(); R::LANES];
            // The last of several lanes stays idle.
            for (lane, arc) in arcs.iter_mut().enumerate().take(R::LANES.max(2) - 1) {
                *arc = worn(depth * (1.0 + 0.1 * lane as f64), width, rough, &mut state);
            }
            arcs.iter().enumerate().for_each(|(lane, arc)| cells.set(lane, arc));
            let mut walks = vec![];
            for (lane, arc) in arcs.iter().enumerate() {
                let step = 10f64.powi(-5 - lane as i32 % 4);
                walks.push(if arc.intervals() > 0 {
                    walk(arc, step, &mut state)
                } else {
                    vec![[1e-5, 0.0]; 2000]
                });
            }
            let mut alone: Vec<ArcCells<f64>> = arcs.iter().map(|arc| ArcCells::new(arc, 0.0)).collect();
            let place = |lane: usize, k: usize| walks[lane][k];
            for k in 0..2000 {
                let e = [0, 1].map(|i| like.each(|lane| place(lane, k)[i]));
                let all = cells.integrate::<true>(&arcs, e);
                for lane in 0..R::LANES {
                    let one = alone[lane].integrate::<true>(&arcs[lane..=lane], place(lane, k));
                    let bits = |of: [f64; 7]| of.map(f64::to_bits);
                    let (found, one_sums) = (all.sums, one.sums);
                    let found =
                        [found.v, found.p[0], found.p[1], found.d[0], found.d[1], found.d[2], all.extent];
                    let found = bits(found.map(|x| x.lane(lane)));
                    let (p, d) = (one_sums.p, one_sums.d);
                    assert_eq!(
                        found,
                        bits([one_sums.v, p[0], p[1], d[0], d[1], d[2], one.extent]),
                        "lane {lane}, {k}"
                    );
                }
            }
        }
    }
}

#[test]
fn every_lane_has_the_bits_of_its_bore_alone() {
    in_widest_lanes(InEveryLane);
}
