//! Predictions of a whole population, kept so that points added to the data at fixed lengths cost one row each.
//!
//! For a block of b population points W = L^-1 R `(n, b)` is kept, and what follows from it: z'W `(m, b)`, the trend's
//! f - T'W `(p, b)` and the squares of W's columns `(b,)`. None of these depends on the trend's coefficients, which
//! change with every datum. Rows that [`Kriging::extended`] added to L give new rows of W,
//!
//!   W2 = L22^-1 (R2 - L21 W),
//!
//! at n b multiplications each, and everything else is added to: no triangular solve, no exponential but for the new
//! points. If the correlation changed, everything is computed anew.
//!
//! W is kept in double precision. Rounded to single (2^-24 of ||w|| < 1) it would move variance factors by up to
//! 2^-23 sum |C^-1 r|, which is of the size of the factors themselves where a smooth function is known well; the test
//! `single_precision_would_move_small_variances` shows it. 1e6 points and n = 150 are 1.2 GB.

use super::Kriging;
use super::factor::solve_lower;
use crate::statistics::design::Population;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

/// Points of a block: one row of W is 4 kB, and r(x) of a block stays in the second-level cache.
const BLOCK: usize = 512;
/// Rows for which a block makes room at once.
const ROOM: usize = 16;

/// What [`PredictionCache::update`] had to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// Everything was computed: the first model, other lengths, or other values of the old points.
    Computed,
    /// So many rows were added.
    Extended {
        /// New points of the model; may be 0.
        rows: usize,
    },
}

/// Cached predictions of a population by one model.
#[derive(Debug, Clone, Default)]
pub struct PredictionCache {
    model: Option<Kriging>,
    blocks: Vec<Block>,
}

/// Predictions of one block of the population.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockPrediction {
    /// Means `(m, b)`, in the outputs' units.
    pub mean: Mat<f64>,
    /// Variance over sigma2 `(b,)` [1], at least 0.
    pub variance_factor: Vec<f64>,
}

impl PredictionCache {
    /// Points of every block but the last.
    pub const BLOCK: usize = BLOCK;

    /// Brings the cache to `model` and `population`. The population may have grown since the last time; its first points
    /// must be the same. The result does not depend on the number of threads: blocks are fixed and independent.
    pub fn update(&mut self, model: &Kriging, population: &Population) -> Update {
        let known = self.model.as_ref().filter(|known| model.extends(known)).map(Kriging::points);
        let blocks = population.len().div_ceil(BLOCK);
        self.blocks.resize_with(blocks, Block::empty);
        self.blocks.par_iter_mut().enumerate().for_each(|(i, block)| {
            let points = population.columns(i * BLOCK..population.len().min((i + 1) * BLOCK));
            match known {
                Some(n) if block.len() == points.ncols() => block.extend(model, points, n),
                _ => *block = Block::compute(model, points),
            }
        });
        let update = match known {
            Some(n) => Update::Extended { rows: model.points() - n },
            None => Update::Computed,
        };
        if update != (Update::Extended { rows: 0 }) {
            self.model = Some(model.clone());
        }
        update
    }

    /// Predictions of block `i`, of the points from `i * BLOCK` on, by the model of the last update; `None` beyond the
    /// population.
    pub fn block(&self, i: usize) -> Option<BlockPrediction> {
        Some(self.blocks.get(i)?.predict(self.model.as_ref()?))
    }

    /// Bytes that the cache holds.
    pub fn bytes(&self) -> usize {
        let of = |block: &Block| {
            let w: usize = block.w.iter().map(Vec::capacity).sum();
            8 * (w + block.len() * (1 + block.explained.nrows() + block.trend.nrows()))
        };
        self.blocks.iter().map(of).sum()
    }
}

#[derive(Debug, Clone)]
struct Block {
    /// W' `(b, n)` column-major, so that a new row of W is a new column at the end; in parts, so that none is ever moved.
    w: Vec<Vec<f64>>,
    /// z'W `(m, b)`.
    explained: Mat<f64>,
    /// f - T'W `(p, b)`.
    trend: Mat<f64>,
    /// Squares of the columns of W `(b,)`.
    squares: Vec<f64>,
}

impl Block {
    fn empty() -> Self {
        Self { w: vec![], explained: Mat::new(), trend: Mat::new(), squares: vec![] }
    }

    fn len(&self) -> usize {
        self.squares.len()
    }

    /// From points `(d, b)`.
    fn compute(model: &Kriging, points: MatRef<'_, f64>) -> Self {
        let (n, b) = (model.points(), points.ncols());
        let whitened = model.whitened(points);
        let mut w = Vec::with_capacity(b * n);
        for i in 0..n {
            w.extend(whitened.row(i).iter());
        }
        let mut block = Self {
            w: vec![w],
            explained: Mat::zeros(model.z.ncols(), b),
            trend: model.trend.trend.basis(points),
            squares: vec![0.0; b],
        };
        block.take_up(model, whitened.as_ref(), 0);
        block
    }

    /// Adds what the rows of W from `first` on, `(k, b)`, say.
    fn take_up(&mut self, model: &Kriging, rows: MatRef<'_, f64>, first: usize) {
        let z = model.z.subrows(first, rows.nrows());
        let t = model.trend.t.subrows(first, rows.nrows());
        matmul(self.explained.as_mut(), Accum::Add, z.transpose(), rows, 1.0, Par::Seq);
        matmul(self.trend.as_mut(), Accum::Add, t.transpose(), rows, -1.0, Par::Seq);
        for (square, column) in self.squares.iter_mut().zip(rows.col_iter()) {
            *square += column.squared_norm_l2();
        }
    }

    /// Adds the rows of the model's points from `n` on; `points` `(d, b)` are those of the block.
    fn extend(&mut self, model: &Kriging, points: MatRef<'_, f64>, n: usize) {
        let (b, k) = (self.len(), model.points() - n);
        if k == 0 || b == 0 {
            return;
        }
        // R2' - W' L21' `(b, k)`.
        let mut rows = model.correlations_with(points, n);
        let mut first = 0;
        for part in &self.w {
            let old = MatRef::from_column_major_slice(part, b, part.len() / b);
            let across = model.l.submatrix(n, first, k, old.ncols());
            matmul(rows.as_mut(), Accum::Add, old, across.transpose(), -1.0, Par::Seq);
            first += old.ncols();
        }
        solve_lower(model.l.submatrix(n, n, k, k), rows.as_mut().transpose_mut());
        for column in rows.col_iter() {
            if self.w.last().is_none_or(|part| part.capacity() < part.len() + b) {
                self.w.push(Vec::with_capacity(b * ROOM));
            }
            let part = self.w.last_mut().expect("there is room for a row");
            part.extend(column.iter());
        }
        self.take_up(model, rows.transpose(), n);
    }

    fn predict(&self, model: &Kriging) -> BlockPrediction {
        let v = model.trend.orthogonal(self.trend.as_ref());
        let mut mean = self.explained.clone();
        matmul(mean.as_mut(), Accum::Add, model.coefficients.transpose(), v.as_ref(), 1.0, Par::Seq);
        for column in mean.col_iter_mut() {
            column.iter_mut().zip(&model.shift).for_each(|(mean, shift)| *mean += shift);
        }
        let factors = self.squares.iter().zip(v.col_iter());
        let variance_factor =
            factors.map(|(square, v)| (1.0 - square + model.trend.variance(v)).max(0.0)).collect();
        BlockPrediction { mean, variance_factor }
    }
}
