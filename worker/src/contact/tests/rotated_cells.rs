//! Cells of states give the integrals of the arc in contact with a turned journal, whatever was met before and in other lanes.

// A state has several coordinates and a lane: plain indices.
#![allow(clippy::needless_range_loop)]

use crate::bore::Profile;
use crate::contact::arc::Arc;
use crate::contact::integrals::RotatedIntegrals;
use crate::contact::journal_table::JournalTable;
use crate::contact::rotated_arc::RotatedArc;
use crate::contact::rotated_cells::RotatedCells;
use crate::lanes::{InLanes, Real, in_widest_lanes};
use crate::plane::{dot, length};
use std::f64::consts::TAU;

const JOURNAL: f64 = 1.5e-3;
const CLEARANCE: f64 = 23.5e-6;
const POINTS: usize = 36;
const INTERVALS: usize = 720;

/// An eccentricity [m] and an angle of the journal [rad].
type State = ([f64; 2], f64);

/// Numbers in [0, 1) that follow no rule.
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Depths of up to `depth` [m] on one side, with depths of up to `rough` [m] on top.
fn depths(depth: f64, rough: f64, state: &mut u64) -> Vec<f64> {
    let smooth = |i: usize| depth * (0.5 + 0.5 * (TAU * i as f64 / POINTS as f64).cos()).powi(4);
    (0..POINTS).map(|i| smooth(i) + rough * random(state)).collect()
}

/// A bore and a journal worn by up to `depth` [m] on one side, with depths of up to `rough` [m] on top.
fn worn(depth: f64, rough: f64, state: &mut u64) -> (Arc, JournalTable) {
    let mut bore = Profile::round(JOURNAL + CLEARANCE, POINTS);
    bore.set_depth(&depths(depth, rough, state));
    let mut arc = Arc::new(JOURNAL, CLEARANCE, POINTS, INTERVALS);
    arc.profile_changed(&bore);
    let mut journal = Profile::round(0.0, POINTS);
    journal.set_depth(&depths(0.7 * depth, rough, state));
    let mut table = JournalTable::new(POINTS, arc.intervals());
    table.tabulate(&journal);
    (arc, table)
}

/// A walk along the bore in steps of up to `step` [m], in and out of contact, while the journal turns to and fro.
fn walk((arc, journal): &(Arc, JournalTable), step: f64, state: &mut u64) -> Vec<State> {
    let (mut angle, mut alpha) = (0.0_f64, 0.3);
    let states = (0..2000).map(|_| {
        angle += (random(state) - 0.45) * step / CLEARANCE;
        alpha += (random(state) - 0.55) * 0.1 * step / CLEARANCE;
        let u = [angle.cos(), angle.sin()];
        let reach =
            CLEARANCE - RotatedArc { arc, journal }.gap_along([CLEARANCE * u[0], CLEARANCE * u[1]], alpha);
        let r = reach - 1e-7 + 10f64.powf(-8.0 + 3.0 * random(state));
        ([r * u[0], r * u[1]], alpha)
    });
    states.collect()
}

fn numbers<R: Copy>(of: &RotatedIntegrals<R>) -> [R; 10] {
    let RotatedIntegrals { to_e, t, et, tt } = of;
    let (p, d) = (to_e.p, to_e.d);
    [to_e.v, p[0], p[1], d[0], d[1], d[2], *t, et[0], et[1], *tt]
}

fn bits(of: &RotatedIntegrals) -> [u64; 10] {
    numbers(of).map(f64::to_bits)
}

#[test]
fn cells_give_the_integrals_of_the_turned_arc_whatever_cells_were_met_before() {
    let mut state = 7;
    let (mut worst, mut touching, mut too_many) = (0.0_f64, 0, 0);
    for (depth, rough) in [(0.0, 0.0), (3e-6, 0.0), (15e-6, 0.0), (8e-6, 1e-6)] {
        let pairs = [worn(depth, rough, &mut state)];
        let [(arc, journal)] = &pairs;
        for step in [1e-9, 3e-8, 1e-5] {
            let mut cells = RotatedCells::new(arc, 0.0);
            for (e, alpha) in walk(&pairs[0], step, &mut state) {
                let found = cells.integrate::<true>(&pairs, e, alpha);
                let first = cells.integrate::<false>(&pairs, e, alpha);
                let of_first = [first.to_e.v, first.to_e.p[0], first.to_e.p[1], first.t];
                if !cells.cells.overfull {
                    assert_eq!(of_first, [found.to_e.v, found.to_e.p[0], found.to_e.p[1], found.t]);
                    assert_eq!((first.to_e.d, first.et, first.tt), ([0.0; 3], [0.0; 2], 0.0));
                }
                let anew = RotatedCells::new(arc, 0.0).integrate::<true>(&pairs, e, alpha);
                assert_eq!(bits(&found), bits(&anew), "{e:?}, {alpha}");
                too_many += usize::from(cells.cells.overfull);
                let exact = RotatedArc { arc, journal }.integrals::<true>(e, alpha);
                let (size, extent) = (length(exact.to_e.p), exact.to_e.d[0] + exact.to_e.d[2]);
                // Lighter contacts lose digits to rounding: 1e-9 m of 2e-5 m leaves eleven.
                if size < 1e-9 * 0.01 {
                    continue;
                }
                touching += 1;
                // A slope of the depth of one to one would be far beyond any journal; derivatives to alpha are set against that.
                let scale = |k: usize| match k {
                    0 => exact.to_e.v,
                    1 | 2 => size,
                    3..=5 => extent,
                    6 => size * 1e-5,
                    7 | 8 => extent * 1e-5,
                    _ => extent * 1e-10 + size * 1e-4,
                };
                for (k, (a, b)) in numbers(&found).into_iter().zip(numbers(&exact)).enumerate() {
                    let off = (a - b).abs() / scale(k);
                    assert!(off < 1e-5, "number {k}: {a:e} and {b:e} at {e:?}, {alpha}");
                    worst = worst.max(off);
                }
            }
        }
    }
    println!("{touching} contacts within {worst:e}, {too_many} times too many intervals");
    assert!(touching > 10_000, "{touching}");
}

#[test]
fn force_and_moment_are_the_gradient_of_the_potential_across_cells() {
    // Along a straight path the potential grows by the integral of its slope, by Simpson's rule over steps much shorter than a cell.
    let mut state = 3;
    let pairs = [worn(10e-6, 3e-7, &mut state)];
    let (arc, journal) = &pairs[0];
    let mut cells = RotatedCells::new(arc, 0.0);
    for (direction, turn) in [(0.3_f64, 0.0), (1.2, 0.02), (2.2, -0.07), (1.0, 0.3)] {
        let u = [0.4_f64.cos(), 0.4_f64.sin()];
        let at_bore = [CLEARANCE * u[0], CLEARANCE * u[1]];
        let reach = CLEARANCE - RotatedArc { arc, journal }.gap_along(at_bore, 0.2);
        let (t, length) = ([direction.cos(), direction.sin()], 4e-7);
        let mut at = |s: f64| {
            let e = [0, 1].map(|k| (reach + 4e-6) * u[k] + s * length * t[k]);
            let found = cells.integrate::<true>(&pairs, e, 0.2 + s * turn);
            (found.to_e.v, dot(found.to_e.p, t) * length + found.t * turn)
        };
        let steps = 4000;
        let grown: f64 = (0..steps)
            .map(|k| {
                let s = |half: f64| (f64::from(k) + half) / f64::from(steps);
                let (begin, middle, end) = (at(s(0.0)).1, at(s(0.5)).1, at(s(1.0)).1);
                (begin + 4.0 * middle + end) / 6.0 / f64::from(steps)
            })
            .sum();
        let (begin, end) = (at(0.0).0, at(1.0).0);
        let off = (grown - (end - begin)).abs() / end.max(begin);
        assert!(off < 1e-9, "{direction} rad: {off}");
    }
}

/// Walks along other bores in every lane, which are replaced on the way.
struct InEveryLane;

impl InLanes for InEveryLane {
    fn run<R: Real>(self, like: R) {
        let mut state = 11;
        let out_of_reach = || (Arc::out_of_reach(), worn(0.0, 0.0, &mut 1).1);
        let mut cells = RotatedCells::new(&Arc::out_of_reach(), like);
        for (depth, rough) in [(3e-6, 0.0), (12e-6, 0.0), (8e-6, 1e-6)] {
            // The last of several lanes stays idle.
            let pairs: Vec<_> = (0..R::LANES)
                .map(|lane| {
                    let idle = lane + 1 == R::LANES && lane > 0;
                    if idle {
                        out_of_reach()
                    } else {
                        worn(depth * (1.0 + 0.1 * lane as f64), rough, &mut state)
                    }
                })
                .collect();
            pairs.iter().enumerate().for_each(|(lane, pair)| cells.set(lane, &pair.0));
            let walks: Vec<Vec<State>> = pairs
                .iter()
                .enumerate()
                .map(|(lane, pair)| {
                    let step = 10f64.powi(-5 - lane as i32 % 4);
                    if pair.0.intervals() > 0 {
                        walk(pair, step, &mut state)
                    } else {
                        vec![([1e-5, 0.0], 0.0); 2000]
                    }
                })
                .collect();
            let mut alone: Vec<RotatedCells<f64>> =
                pairs.iter().map(|(arc, _)| RotatedCells::new(arc, 0.0)).collect();
            for k in 0..2000 {
                let e = [0, 1].map(|i| like.each(|lane| walks[lane][k].0[i]));
                let alpha = like.each(|lane| walks[lane][k].1);
                let all = numbers(&cells.integrate::<true>(&pairs, e, alpha));
                for lane in 0..R::LANES {
                    let (e, alpha) = walks[lane][k];
                    let one = alone[lane].integrate::<true>(&pairs[lane..=lane], e, alpha);
                    let found = all.map(|x| x.lane(lane).to_bits());
                    assert_eq!(found, bits(&one), "lane {lane}, {k}");
                }
            }
        }
    }
}

#[test]
fn every_lane_has_the_bits_of_its_bore_alone() {
    in_widest_lanes(InEveryLane);
}
