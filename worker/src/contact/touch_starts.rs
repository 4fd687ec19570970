//! Where the search for the contact of an unworn journal with its worn bore begins, tabulated over the direction of the eccentricity.
//!
//! Without penetration the eccentricity is on the border of the free region (`free_region.rs`), which the journal reaches touching at an angle theta
//! that grows with the direction psi of the eccentricity: e = G u + G' t, psi = theta + atan(G' / G). The table has theta - psi over equal
//! cells of psi, linear within each. Where the journal bridges a groove it touches at one of its edges: a cell has both, as have some
//! beside it.
//! A journal pressed into the bore touches within the same arc of contact, in which the gap closed has one maximum unless a groove is bridged.
//!
//! # Source
//! Derived here; the hull is that of `free_region.rs`.

use super::free_region::{LEAST_GAP, hull};
use super::touch::Begin;
use crate::bore::{Profile, locate};
use crate::lanes::Real;
use std::f64::consts::TAU;

/// Cells of a turn: two degrees.
const CELLS: usize = 180;
/// Cells beside a bridged groove in which both edges are tried: the line on which they close the gap equally far turns away from the direction of the eccentricity
/// by a tenth of the penetration over the clearance, some degrees where the penetration is half of that.
const BESIDE: usize = 4;
/// Fewest angles at which the border of the free region is tabulated.
const ANGLES: usize = 360;

/// Starts on one bore, or on one per lane.
#[derive(Debug, Clone, PartialEq)]
pub struct Starts {
    /// Of each lane and cell: theta - psi of a start where the cell begins and its growth over the cell, that of the second start there, and one if there are
    /// two `(lanes, CELLS, 4)` [rad].
    cells: Vec<[f64; 4]>,
}

/// A place of the border at which the journal touches.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    /// Direction of the eccentricity, and place of the contact [rad].
    psi: f64,
    theta: f64,
    /// Number of the angle in the table.
    number: usize,
}

impl Starts {
    /// On a round bore: in the direction of the eccentricity.
    pub(super) fn round() -> Self {
        Starts { cells: vec![[0.0; 4]; CELLS] }
    }

    /// The same starts in each of `lanes` lanes.
    pub(super) fn repeated(&self, lanes: usize) -> Self {
        Starts { cells: self.cells.repeat(lanes) }
    }

    /// Replaces those of a lane.
    pub(super) fn set(&mut self, lane: usize, from: &Starts) {
        self.cells[lane * CELLS..][..CELLS].copy_from_slice(&from.cells);
    }

    /// Starts for an eccentricity in the direction `psi` in (-2 pi, 2 pi) [rad].
    #[inline(always)]
    pub(super) fn begin<R: Real>(&self, psi: R) -> Begin<R> {
        let (cell, fraction) = locate(psi, CELLS, CELLS as f64 / TAU);
        let [first, growth, second, two] = cell.columns(&self.cells, CELLS);
        let from = psi.plus_product(growth, fraction);
        Begin { places: [from + first, from + second], two }
    }

    /// Tabulates a changed bore, with an unworn journal of radius `journal_radius` [m].
    pub(super) fn profile_changed(&mut self, profile: &Profile, journal_radius: f64) {
        let vertices = border(profile, journal_radius);
        let (first, last) = (vertices[0].psi, vertices.len() - 1);
        let width = TAU / CELLS as f64;
        // The pair of vertices that contains the beginning of a cell.
        let mut pair = 0;
        let place = |psi: f64, pair: usize| {
            let (a, b) = (vertices[pair], vertices[pair + 1]);
            let share = if a.psi < b.psi { ((psi - a.psi) / (b.psi - a.psi)).clamp(0.0, 1.0) } else { 0.0 };
            a.theta + share * (b.theta - a.theta) - psi
        };
        let bridges = |pair: usize| vertices[pair].number + 1 < vertices[pair + 1].number;
        let begin = (first / width).ceil() as i64;
        for cell in begin..begin + CELLS as i64 {
            let (from, to) = (cell as f64 * width, (cell + 1) as f64 * width);
            while pair + 1 < last && vertices[pair + 1].psi <= from {
                pair += 1;
            }
            let mut end = pair;
            while end + 1 < last && vertices[end + 1].psi < to {
                end += 1;
            }
            let mut edges = (pair..=end).filter(|&pair| bridges(pair));
            let row = match edges.next() {
                None => {
                    let (one, other) = (place(from, pair), place(to, end));
                    [one, other - one, one, 0.0]
                }
                Some(one) => {
                    let other = edges.next_back().unwrap_or(one);
                    [vertices[one].theta - from, -width, vertices[other + 1].theta - from, 1.0]
                }
            };
            self.cells[cell.rem_euclid(CELLS as i64) as usize] = row;
        }
        self.try_other_edges();
    }

    /// Gives the cells beside a bridged groove the edge on its other side as a second start.
    fn try_other_edges(&mut self) {
        let width = TAU / CELLS as f64;
        let bridging: Vec<usize> = (0..CELLS).filter(|&cell| self.cells[cell][3] > 0.0).collect();
        for distance in 1..=BESIDE {
            for &cell in &bridging {
                let [first, _, second, _] = self.cells[cell];
                let turned = distance as f64 * width;
                let beside = [(CELLS + cell - distance, second + turned), (cell + distance, first - turned)];
                for (place, edge) in beside {
                    let row = &mut self.cells[place % CELLS];
                    if row[3] == 0.0 {
                        (row[2], row[3]) = (edge, 1.0);
                    }
                }
            }
        }
    }
}

/// Places of the border of the free region at which the journal touches, over a turn, the last of them the first again.
fn border(profile: &Profile, journal_radius: f64) -> Vec<Vertex> {
    let points = profile.points();
    let sub = ANGLES.div_ceil(points);
    let n = points * sub;
    let spacing = TAU / n as f64;
    let mut gap = vec![0.0; n];
    profile.tabulate(&mut gap);
    gap.iter_mut().for_each(|gap| *gap = (*gap - journal_radius).max(LEAST_GAP * journal_radius));
    let unit = |k: usize| {
        let (sin, cos) = libm::sincos(spacing * k as f64);
        [cos, sin]
    };
    let unit: Vec<_> = (0..n).map(unit).collect();
    let mut vertices: Vec<Vertex> = hull(&gap, &unit)
        .into_iter()
        .map(|number| {
            let slope = profile.within(number / sub, (number % sub) as f64 / sub as f64).d1;
            let theta = spacing * number as f64;
            Vertex { psi: theta + libm::atan2(slope, gap[number]), theta, number }
        })
        .collect();
    let first = vertices[0];
    vertices.push(Vertex { psi: first.psi + TAU, theta: first.theta + TAU, number: first.number + n });
    // The edges of a groove are known to the spacing of the table alone.
    for k in 1..vertices.len() {
        vertices[k].psi = vertices[k].psi.max(vertices[k - 1].psi);
    }
    vertices
}
