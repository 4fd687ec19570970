//! Cached predictions of a whole population, so that points added to the data at fixed lengths cost one row
//! each.
//!
//! For a block of b population points the cache keeps W = L^-1 R `(n, b)` and what follows from it: z'W
//! `(m, b)`, the trend's f - T'W `(p, b)` and the squared norms of W's columns `(b,)`. None of these depends
//! on the coefficients of the trend, which change with every result. The rows that [`Kriging::extended`] adds
//! to L give new rows of W,
//!
//!   W2 = L22^-1 (R2 - L21 W),
//!
//! at n b multiplications each; all other quantities are sums to which these rows are added. So no triangular
//! solve with the whole factor is needed, and exponentials for the new points only. If the correlation
//! changed, everything is computed anew.
//!
//! W is kept in double precision. Rounded to single precision (2^-24 of ||w|| < 1) it would change variance
//! factors by up to 2^-23 sum |C^-1 r|, which is of the size of the factors themselves where a smooth
//! function is known well; the test `single_precision_would_move_small_variances` shows it. 1e6 points and n
//! = 150 would take 1.2 GB, so a cache has a limit of memory: the first blocks are kept as far as they fit, the
//! others are computed anew whenever they are needed.
//!
//! # Source
//! Golub, Van Loan (2013), Matrix Computations, section 6.5 (updating factorisations); its use for cached
//! predictions is this project's own.

use super::factor::solve_lower;
use super::kriging::larger_means;
use super::{Kriging, Prediction};
use crate::design::Population;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use rayon::prelude::*;

/// Number of points of a block: one row of W is 4 kB, and r(x) of a block stays in the second-level cache.
const BLOCK: usize = 512;
/// Number of rows for which a block allocates memory at once.
const ROOM: usize = 16;

/// Cached predictions of a population by one model.
#[derive(Debug, Clone)]
pub struct PredictionCache {
    model: Option<Kriging>,
    /// The first blocks of the population, as many as fit.
    blocks: Vec<Block>,
    /// Most memory of the blocks [bytes].
    limit: usize,
}

impl Default for PredictionCache {
    /// An empty cache without a limit.
    fn default() -> Self {
        Self { model: None, blocks: Vec::new(), limit: usize::MAX }
    }
}

impl PredictionCache {
    /// Number of points of every block but the last.
    pub const BLOCK: usize = BLOCK;

    /// Sets the most memory that the blocks may take after the next update [bytes].
    pub fn set_limit(&mut self, bytes: usize) {
        self.limit = bytes;
    }

    /// Updates the cache to `model` and `population`. The population may have grown since the last update;
    /// its first points must be the same. The result does not depend on the number of threads: blocks are
    /// fixed and independent. Returns the number of points whose rows were added, which may be 0; `None` if everything was computed,
    /// for the first model, other lengths, or other values of the old points.
    pub fn update(&mut self, model: &Kriging, population: &Population) -> Option<usize> {
        let known = self.model.as_ref().filter(|known| model.extends(known)).map(Kriging::points);
        let bytes_of_block =
            8 * BLOCK * (model.points() + ROOM + model.z.ncols() + model.trend.t.ncols() + 1);
        let kept = population.len().div_ceil(BLOCK).min(self.limit / bytes_of_block);
        self.blocks.resize_with(kept, Block::empty);
        self.blocks.par_iter_mut().enumerate().for_each(|(i, block)| {
            let points = population.columns(i * BLOCK..population.len().min((i + 1) * BLOCK));
            match known {
                Some(n) if block.len() == points.ncols() => block.extend(model, points, n),
                _ => *block = Block::compute(model, points),
            }
        });
        let added = known.map(|n| model.points() - n);
        if added != Some(0) {
            self.model = Some(model.clone());
        }
        added
    }

    /// Predictions of block `i` (the points from `i * BLOCK` on) by the model of the last update; `None`
    /// beyond the population, and where the limit of memory leaves no room.
    pub fn block(&self, i: usize) -> Option<Prediction> {
        Some(self.blocks.get(i)?.predict(self.model.as_ref()?))
    }

    /// Memory of the cache [bytes].
    pub fn bytes(&self) -> usize {
        let bytes_of = |block: &Block| {
            let w: usize = block.w.iter().map(Vec::capacity).sum();
            8 * (w + block.len() * (1 + block.explained.nrows() + block.trend.nrows()))
        };
        self.blocks.iter().map(bytes_of).sum()
    }
}

/// Cached quantities of one block.
#[derive(Debug, Clone)]
struct Block {
    /// W' `(b, n)` column-major, so that a new row of W is a new column at the end; in parts, so that none is
    /// ever moved.
    w: Vec<Vec<f64>>,
    /// Explained part z'W of the means `(m, b)`.
    explained: Mat<f64>,
    /// Trend part f - T'W `(p, b)`.
    trend: Mat<f64>,
    /// Squared norms of the columns of W `(b,)`.
    squares: Vec<f64>,
}

impl Block {
    fn empty() -> Self {
        Self { w: vec![], explained: Mat::new(), trend: Mat::new(), squares: vec![] }
    }

    fn len(&self) -> usize {
        self.squares.len()
    }

    /// Computes the block of points `(d, b)`.
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
        block.add_rows(model, whitened.as_ref(), 0);
        block
    }

    /// Adds the rows of W from `first` on, `(k, b)`, to the sums.
    fn add_rows(&mut self, model: &Kriging, rows: MatRef<'_, f64>, first: usize) {
        let z = model.z.subrows(first, rows.nrows());
        let t = model.trend.t.subrows(first, rows.nrows());
        matmul(self.explained.as_mut(), Accum::Add, z.transpose(), rows, 1.0, Par::Seq);
        matmul(self.trend.as_mut(), Accum::Add, t.transpose(), rows, -1.0, Par::Seq);
        for (square, column) in self.squares.iter_mut().zip(rows.col_iter()) {
            *square += column.squared_norm_l2();
        }
    }

    /// Extends the block by the rows of the model's points from `n` on; `points` `(d, b)` are those of the
    /// block.
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
            self.w.last_mut().expect("a part with room was added").extend(column.iter());
        }
        self.add_rows(model, rows.transpose(), n);
    }

    fn predict(&self, model: &Kriging) -> Prediction {
        let v = model.trend.orthogonal(self.trend.as_ref());
        let mut mean = self.explained.clone();
        matmul(mean.as_mut(), Accum::Add, model.coefficients.transpose(), v.as_ref(), 1.0, Par::Seq);
        for column in mean.col_iter_mut() {
            column.iter_mut().zip(&model.shift).for_each(|(mean, shift)| *mean += shift);
        }
        if model.sided {
            mean = larger_means(&mean);
        }
        let factors = self.squares.iter().zip(v.col_iter());
        let variance_factor =
            factors.map(|(square, v)| (1.0 - square + model.trend.variance(v)).max(0.0)).collect();
        Prediction { mean, variance_factor }
    }
}
