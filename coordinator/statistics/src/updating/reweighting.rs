//! Weights of points that were drawn from one distribution, under others:
//!
//!   r_j = product over the changed variables k of f_k(x_jk) / q_k(x_jk),
//!
//! with q the distribution of the points and f the changed one. The changed variables are independent of all others. With t the
//! standard normal of a variable under q, f_k(x(t)) / q_k(x(t)) is tabulated over t in [-5, 5] and interpolated linearly between
//! the nodes, so that a change costs as many densities as there are nodes, whatever the number of points.
//!
//! # Source
//! Importance sampling: Owen (2013), Monte Carlo theory, methods and examples, chapter 9.

use common::random::Distribution;

/// Nodes of a table, and the standard normal of the last one.
const NODES: usize = 513;
const REACH: f64 = 5.0;

/// Points as places in the tables.
#[derive(Debug, Clone, Default)]
pub struct PointPlaces {
    /// Places `(n, K)` row-major, in nodes.
    places: Vec<f64>,
}

/// The distributions of the points, tabulated.
#[derive(Debug, Clone)]
pub struct Reweighting {
    /// Index of each changed variable among the coordinates of a state `(K,)`.
    indices: Vec<usize>,
    /// Values at the nodes `(K)(NODES,)` [SI], and the densities of the points there.
    nodes: Vec<Vec<(f64, f64)>>,
}

impl Reweighting {
    /// Tables for points whose variables `indices` have the distributions `proposals` `(K,)`.
    pub fn new(indices: Vec<usize>, proposals: &[Distribution]) -> Self {
        let node = |law: &Distribution, i: usize| {
            let x = law.from_standard_normal(2.0 * REACH * i as f64 / (NODES - 1) as f64 - REACH);
            (x, law.pdf(x))
        };
        let nodes = proposals.iter().map(|law| (0..NODES).map(|i| node(law, i)).collect()).collect();
        Self { indices, nodes }
    }

    /// Points from states of `dimension` coordinates, independent standard normals `(n, D)` row-major.
    pub fn points(&self, states: &[f64], dimension: usize) -> PointPlaces {
        let last = (NODES - 1) as f64;
        let place = |t: f64| ((t + REACH) / (2.0 * REACH) * last).clamp(0.0, last - 1e-9);
        let of_state = |v: &[f64]| self.indices.iter().map(|k| place(v[*k])).collect::<Vec<f64>>();
        PointPlaces { places: states.chunks_exact(dimension).flat_map(of_state).collect() }
    }

    /// Weights r of the points under the distributions `laws` `(K,)`, not normalised `(n,)`.
    pub fn weights(&self, laws: &[Distribution], points: &PointPlaces) -> Vec<f64> {
        let ratio = |law: &Distribution, (x, q): &(f64, f64)| if *q > 0.0 { law.pdf(*x) / q } else { 0.0 };
        let table = |(law, nodes): (&Distribution, &Vec<(f64, f64)>)| -> Vec<f64> {
            nodes.iter().map(|node| ratio(law, node)).collect()
        };
        let tables: Vec<Vec<f64>> = laws.iter().zip(&self.nodes).map(table).collect();
        let weight = |places: &[f64]| {
            places.iter().zip(&tables).fold(1.0, |product, (place, table)| {
                let (node, share) = (*place as usize, place.fract());
                product * (table[node] + share * (table[node + 1] - table[node]))
            })
        };
        points.places.chunks_exact(self.indices.len()).map(weight).collect()
    }
}
