//! What the simulations gave so far, as the surrogates want it.

use crate::learning::running_maximum;
use faer::Mat;

/// Points and histories of the successful evaluations, in the order of their requests.
#[derive(Debug, Clone)]
pub struct Observations {
    d: usize,
    /// Standardised points `(n, d)` row-major.
    z: Vec<f64>,
    /// Histories per output `(outputs)(n)(m,)`, in the outputs' units.
    histories: Vec<Vec<Vec<f64>>>,
    /// How many belong to the initial design.
    design: usize,
}

impl Observations {
    /// None yet, of `d` variables and so many outputs.
    pub fn new(d: usize, outputs: usize) -> Self {
        Self { d, z: Vec::new(), histories: vec![Vec::new(); outputs], design: 0 }
    }

    /// Adds a point `(d,)` and its histories `(outputs)(m,)`.
    pub fn add(&mut self, z: &[f64], histories: Vec<Vec<f64>>) {
        self.z.extend_from_slice(z);
        for (all, history) in self.histories.iter_mut().zip(histories) {
            all.push(history);
        }
    }

    /// Everything so far is the initial design.
    pub fn close_design(&mut self) {
        self.design = self.len();
    }

    /// Number of points n.
    pub fn len(&self) -> usize {
        self.z.len() / self.d
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.z.is_empty()
    }

    /// Points as columns `(d, n)` [1].
    pub fn points(&self) -> Mat<f64> {
        Mat::from_fn(self.d, self.len(), |k, i| self.z[i * self.d + k])
    }

    /// Histories of one output `(n)(m,)`.
    pub fn histories(&self, output: usize) -> &[Vec<f64>] {
        &self.histories[output]
    }

    /// Histories of one output as a matrix `(n, m)`.
    pub fn values(&self, output: usize) -> Mat<f64> {
        as_matrix(&self.histories[output])
    }

    /// Running maxima of the histories of one output `(n, m)`.
    pub fn running_maxima(&self, output: usize) -> Mat<f64> {
        let maxima: Vec<Vec<f64>> = self.histories[output].iter().map(|h| running_maximum(h)).collect();
        as_matrix(&maxima)
    }

    /// Share of the initial design that reached the threshold by each checkpoint, from running maxima `(n, m)`.
    pub fn design_share(&self, running_maxima: &Mat<f64>, threshold: f64) -> Vec<f64> {
        let failed = |n: usize| (0..self.design).filter(|i| running_maxima[(*i, n)] >= threshold).count();
        (0..running_maxima.ncols()).map(|n| failed(n) as f64 / self.design.max(1) as f64).collect()
    }
}

fn as_matrix(rows: &[Vec<f64>]) -> Mat<f64> {
    let m = rows.first().map_or(0, Vec::len);
    Mat::from_fn(rows.len(), m, |i, n| rows[i][n])
}
