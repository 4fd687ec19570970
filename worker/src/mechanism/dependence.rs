//! Dependence of the closure equations of a scene on each other: redundant joints, freedoms left, dead points and change points.

use super::closure::{Closure, Gaps};
use nalgebra::{DMatrix, DVector};

/// A row counts as dependent if its part normal to the rows before it is below this share of its length.
const DEPENDENT: f64 = 1e-9;

impl Closure<'_> {
    /// Branch of a mechanism without freedom on either side of a dead point: true if det(dphi/dq) > 0.
    pub(crate) fn orientation(&self, t: f64, q: &DVector<f64>) -> Option<bool> {
        if self.m != self.n || self.n == 0 {
            return None;
        }
        let jacobian = self.gaps(t, q).jacobian;
        if self.first_dependent_row(&jacobian, |_| true).is_some() {
            return None;
        }
        Some(jacobian.determinant() > 0.0)
    }

    /// Whether drives and joints leave no freedom at a closed position.
    pub(crate) fn is_determined(&self, q: &DVector<f64>) -> bool {
        let Gaps { jacobian, .. } = self.gaps(0.0, q);
        self.n > 0 && self.m >= self.n && jacobian.rank(DEPENDENT) == self.n
    }

    /// The first ideal joint whose rows depend linearly on those of the ideal joints before it.
    pub(crate) fn first_dependent_joint(&self, q: &DVector<f64>) -> Option<usize> {
        let jacobian = self.gaps(0.0, q).jacobian;
        self.first_dependent_row(&jacobian, |joint| self.is_ideal(joint))
    }

    /// The ideal joint that depends most on those before it, and the smallest share of a row of it normal to theirs; one without ideal joints.
    pub(crate) fn independence(&self, t: f64, q: &DVector<f64>) -> (usize, f64) {
        let shares = self.shares(&self.gaps(t, q).jacobian, |joint| self.is_ideal(joint));
        shares.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 1.0))
    }

    fn is_ideal(&self, joint: usize) -> bool {
        !self.scene.joints[joint].kind.has_clearance()
    }

    /// Joint of the first row, among those of the wanted joints, that depends linearly on the rows before it.
    fn first_dependent_row(&self, jacobian: &DMatrix<f64>, wanted: impl Fn(usize) -> bool) -> Option<usize> {
        self.shares(jacobian, wanted).last().filter(|(_, share)| *share <= DEPENDENT).map(|(joint, _)| *joint)
    }

    /// Joint of each row of the wanted joints, and the share of the row normal to the rows before it, up to the first dependent one.
    fn shares(&self, jacobian: &DMatrix<f64>, wanted: impl Fn(usize) -> bool) -> Vec<(usize, f64)> {
        let (mut basis, mut shares) = (Vec::<DVector<f64>>::new(), Vec::new());
        for (joint, (c, &row)) in self.constraints.iter().zip(&self.row).enumerate() {
            for r in (row..row + c.rows()).filter(|_| wanted(joint)) {
                let mut own = jacobian.row(r).transpose();
                let length = own.norm();
                // Twice is enough: the second pass removes the rounding errors of the first.
                for _ in 0..2 {
                    for b in &basis {
                        let share = b.dot(&own);
                        own -= b * share;
                    }
                }
                let left = own.norm();
                // A row of zeros is dependent.
                shares.push((joint, if left <= DEPENDENT * length { 0.0 } else { left / length }));
                if left <= DEPENDENT * length {
                    return shares;
                }
                basis.push(own.normalize());
            }
        }
        shares
    }

    /// Joint with the largest share in the combination of rows closest to zero (left singular vector of the
    /// smallest singular value).
    pub(crate) fn weakest_joint(&self, t: f64, q: &DVector<f64>) -> usize {
        let svd = self.gaps(t, q).jacobian.svd(true, false);
        let Some(u) = svd.u else { return 0 };
        let weakest = svd.singular_values.imin();
        let share =
            |joint: usize| u.column(weakest).rows(self.row[joint], self.constraints[joint].rows()).norm();
        (0..self.constraints.len()).max_by(|&a, &b| share(a).total_cmp(&share(b))).unwrap_or(0)
    }
}
