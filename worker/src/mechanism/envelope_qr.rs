//! Orthogonal factorisation of many constraints that each couple few bodies: M^-1/2 G' = Q R by Householder's reflections within the
//! envelope of the matrix, with a cost that grows linearly along a chain of bodies.
//!
//! The columns of M^-1/2 G' `(n, m)` are the constraints, its rows the coordinates, both renumbered so that bodies joined to each other
//! are close: joints in the order of Cuthill and McKee, bodies in the order in which the joints reach them. Column c is stored from its
//! first to its last entry that elimination can fill; reflection c = 1 - tau v v' acts on the rows from c on. Q is the product of the
//! reflections and is never formed. Nothing is squared, so that nearly dependent constraints lose no more digits than they must.
//!
//! # Source
//! Householder factorisation: Golub, Van Loan (2013), Matrix Computations, section 5.2. Order: Cuthill, McKee (1969), Proc. 24th
//! National Conference of the ACM, 157-172.

use super::constraint::Constraint;
use super::orthonormal::DEPENDENT;

/// The matrix M^-1/2 G' in its envelope, and its factors.
#[derive(Debug, Clone)]
pub struct EnvelopeQr {
    /// Column of each row of the constraints `(m,)`.
    column: Vec<usize>,
    /// Row of the matrix of each coordinate `(n,)`.
    row: Vec<usize>,
    /// First and one past the last stored row of each column `(m,)`.
    top: Vec<usize>,
    end: Vec<usize>,
    /// Index of row zero of each column in `a`; may lie before its first stored row `(m,)`.
    offset: Vec<isize>,
    /// One past the last column that reflection c changes `(m,)`.
    reach: Vec<usize>,
    /// Stored entries: R above the diagonal, reflections v on and below it.
    a: Vec<f64>,
    /// Diagonal of R and factors tau `(m,)`.
    diagonal: Vec<f64>,
    tau: Vec<f64>,
    /// Work space `(n,)` and `(m,)`.
    x: Vec<f64>,
    y: Vec<f64>,
}

impl EnvelopeQr {
    /// Space for the factors of these constraints, whose first rows are `first`, on `n` coordinates with `m` rows; `None` if there are
    /// more rows than coordinates.
    pub(super) fn new(constraints: &[Constraint], first: &[usize], n: usize, m: usize) -> Option<Self> {
        if m > n {
            return None;
        }
        let bodies = n / 3;
        let free =
            |joint: usize| constraints[joint].ends.map(|end| end.frame).into_iter().filter(|&f| f < bodies);
        let order = joint_order(constraints, bodies);
        // Bodies in the order in which the joints reach them.
        let mut place = vec![usize::MAX; bodies];
        let mut placed = 0;
        for body in order.iter().flat_map(|&joint| free(joint)).chain(0..bodies) {
            if place[body] == usize::MAX {
                place[body] = placed;
                placed += 1;
            }
        }
        let row = (0..n).map(|k| 3 * place[k / 3] + k % 3).collect();
        let (mut column, mut top, mut end) = (vec![0; m], vec![], vec![]);
        for &joint in &order {
            for r in 0..constraints[joint].rows() {
                let c = top.len();
                column[first[joint] + r] = c;
                let rows = || free(joint).map(|body| 3 * place[body]);
                top.push(rows().min().unwrap_or(0).min(c));
                let last = rows().max().unwrap_or(0) + 3;
                end.push(last.max(end.last().copied().unwrap_or(0)).max(c + 1));
            }
        }
        // Fill: a reflection that meets a column spreads over all its own rows.
        let mut reach = vec![0; m];
        for c in 0..m {
            reach[c] = c + 1;
            for (k, top) in top.iter_mut().enumerate().skip(c + 1).filter(|(_, top)| **top < end[c]) {
                *top = (*top).min(c);
                reach[c] = k + 1;
            }
        }
        let mut offset = Vec::with_capacity(m);
        let mut stored = 0;
        for c in 0..m {
            offset.push(stored as isize - top[c] as isize);
            stored += end[c] - top[c];
        }
        let (a, diagonal, tau) = (vec![0.0; stored], vec![0.0; m], vec![0.0; m]);
        Some(EnvelopeQr {
            column,
            row,
            top,
            end,
            offset,
            reach,
            a,
            diagonal,
            tau,
            x: vec![0.0; n],
            y: vec![0.0; m],
        })
    }

    fn index(&self, row: usize, column: usize) -> usize {
        (self.offset[column] + row as isize) as usize
    }

    /// Stored entries of a column from row `from` on.
    fn rows(&self, column: usize, from: usize) -> std::ops::Range<usize> {
        self.index(from, column)..self.index(self.end[column], column)
    }

    /// Sets all entries to zero.
    pub(super) fn clear(&mut self) {
        self.a.fill(0.0);
    }

    /// Sets the entry of a row of the constraints and a coordinate.
    pub(super) fn set(&mut self, row: usize, coordinate: usize, value: f64) {
        let at = self.index(self.row[coordinate], self.column[row]);
        self.a[at] = value;
    }

    /// Factors the matrix; false if its columns are dependent. `shares` `(m,)` receives the share of each constraint that is normal to
    /// those before it in the order of the columns [1].
    pub(super) fn factor(&mut self, shares: &mut [f64]) -> bool {
        let m = self.column.len();
        let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        for c in 0..m {
            // Reflections keep lengths: what is above the diagonal was taken by the columns before.
            let length = norm(&self.a[self.rows(c, self.top[c])]);
            let own = self.rows(c, c);
            let left = norm(&self.a[own.clone()]);
            self.y[c] = left / length;
            if left.is_nan() || left <= DEPENDENT * length {
                self.copy_shares(c + 1, shares);
                return false;
            }
            let first = self.a[own.start];
            let diagonal = if first > 0.0 { -left } else { left };
            self.a[own.start] = first - diagonal;
            (self.diagonal[c], self.tau[c]) = (diagonal, 1.0 / (diagonal * (diagonal - first)));
            for k in (c + 1..self.reach[c]).filter(|&k| self.top[k] <= c) {
                let start = self.index(c, k);
                let (before, after) = self.a.split_at_mut(start);
                reflect(&before[own.clone()], self.tau[c], &mut after[..own.len()]);
            }
        }
        self.copy_shares(m, shares);
        true
    }

    /// Copies the first `known` shares, by columns, to the rows of the constraints; the others count as one.
    fn copy_shares(&self, known: usize, shares: &mut [f64]) {
        for (share, &c) in shares.iter_mut().zip(&self.column) {
            *share = if c < known { self.y[c] } else { 1.0 };
        }
    }

    /// Replaces `x` by R^-T x `(m,)`.
    pub(super) fn forward(&mut self, x: &mut [f64]) {
        self.gather(x);
        for c in 0..self.y.len() {
            let above = &self.a[self.index(self.top[c], c)..self.index(c, c)];
            let known: f64 = above.iter().zip(&self.y[self.top[c]..]).map(|(r, y)| r * y).sum();
            self.y[c] = (self.y[c] - known) / self.diagonal[c];
        }
        self.scatter(x);
    }

    /// Replaces `x` by R^-1 x `(m,)`.
    pub(super) fn backward(&mut self, x: &mut [f64]) {
        self.gather(x);
        for c in (0..self.y.len()).rev() {
            self.y[c] /= self.diagonal[c];
            let y = self.y[c];
            let above = &self.a[self.index(self.top[c], c)..self.index(c, c)];
            self.y[self.top[c]..].iter_mut().zip(above).for_each(|(x, r)| *x -= r * y);
        }
        self.scatter(x);
    }

    /// Adds Q' x to `to` `(m,)` for the weighted values `x` of the coordinates `(n,)`.
    pub(super) fn add_components(&mut self, x: impl Iterator<Item = f64>, to: &mut [f64]) {
        for (value, &row) in x.zip(&self.row) {
            self.x[row] = value;
        }
        for c in 0..self.y.len() {
            let v = &self.a[self.rows(c, c)];
            reflect(v, self.tau[c], &mut self.x[c..c + v.len()]);
        }
        to.iter_mut().zip(&self.column).for_each(|(to, &c)| *to += self.x[c]);
    }

    /// Subtracts Q x from `to` `(n,)` for `x` `(m,)`, each coordinate k times `weight(k)`.
    pub(super) fn subtract(&mut self, x: &[f64], weight: impl Fn(usize) -> f64, to: &mut [f64]) {
        self.combine(x);
        for (k, (to, &row)) in to.iter_mut().zip(&self.row).enumerate() {
            *to -= self.x[row] * weight(k);
        }
    }

    /// Part of constraint row `i` normal to those before it in the order of the columns `(n,)`.
    pub(super) fn remainder(&mut self, i: usize, to: &mut [f64]) {
        let c = self.column[i];
        self.x.fill(0.0);
        self.x[c] = self.diagonal[c];
        self.reflect_back(c + 1);
        to.iter_mut().zip(&self.row).for_each(|(to, &row)| *to = self.x[row]);
    }

    /// Fills the work space with Q x for `x` `(m,)`.
    fn combine(&mut self, x: &[f64]) {
        self.x.fill(0.0);
        x.iter().zip(&self.column).for_each(|(x, &c)| self.x[c] = *x);
        self.reflect_back(self.column.len());
    }

    /// Applies the first `count` reflections to the work space, the last one first.
    fn reflect_back(&mut self, count: usize) {
        for c in (0..count).rev() {
            let v = &self.a[self.rows(c, c)];
            reflect(v, self.tau[c], &mut self.x[c..c + v.len()]);
        }
    }

    /// Copies values by rows of the constraints to the work space, by columns.
    fn gather(&mut self, x: &[f64]) {
        x.iter().zip(&self.column).for_each(|(x, &c)| self.y[c] = *x);
    }

    fn scatter(&self, x: &mut [f64]) {
        x.iter_mut().zip(&self.column).for_each(|(x, &c)| *x = self.y[c]);
    }
}

/// Replaces `x` by (1 - tau v v') x.
fn reflect(v: &[f64], tau: f64, x: &mut [f64]) {
    let share: f64 = tau * v.iter().zip(&*x).map(|(v, x)| v * x).sum::<f64>();
    x.iter_mut().zip(v).for_each(|(x, v)| *x -= share * v);
}

/// Order of the joints by breadth, from one at an end of the island: joints that share a free body are neighbours.
fn joint_order(constraints: &[Constraint], bodies: usize) -> Vec<usize> {
    let free =
        |joint: usize| constraints[joint].ends.map(|end| end.frame).into_iter().filter(|&f| f < bodies);
    let mut on_body = vec![Vec::new(); bodies];
    for joint in 0..constraints.len() {
        free(joint).for_each(|body| on_body[body].push(joint));
    }
    let neighbours = |joint: usize| free(joint).flat_map(|body| on_body[body].iter().copied());
    let degree = |joint: usize| neighbours(joint).count();
    let mut order: Vec<usize> = Vec::with_capacity(constraints.len());
    let mut reached = vec![false; constraints.len()];
    for seed in 0..constraints.len() {
        if reached[seed] {
            continue;
        }
        // The joint reached last from any other lies at an end.
        let mut seen = reached.clone();
        let last = by_breadth(seed, &mut seen, neighbours, degree).pop().unwrap_or(seed);
        order.extend(by_breadth(last, &mut reached, neighbours, degree));
    }
    order
}

/// Joints connected to `seed` in the order of their distance from it, of equal distance by their number of neighbours.
fn by_breadth<I: Iterator<Item = usize>>(
    seed: usize,
    reached: &mut [bool],
    neighbours: impl Fn(usize) -> I,
    degree: impl Fn(usize) -> usize,
) -> Vec<usize> {
    let mut order = vec![seed];
    reached[seed] = true;
    let mut next = 0;
    while let Some(&joint) = order.get(next) {
        next += 1;
        let first = order.len();
        for neighbour in neighbours(joint) {
            if !std::mem::replace(&mut reached[neighbour], true) {
                order.push(neighbour);
            }
        }
        order[first..].sort_by_key(|&joint| degree(joint));
    }
    order
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::mechanism::constraint::first_rows;
    use crate::mechanism::frame::End;
    use common::scene::JointKind;

    /// A ladder of `windows` four-bars, one of its joints prismatic and one fixed: bodies are cranks, couplers, then the ground.
    pub(in crate::mechanism) fn ladder(windows: usize) -> (Vec<Constraint>, usize) {
        let bodies = 2 * windows + 1;
        let end = |frame: usize, arm: [f64; 2]| End { frame, arm };
        let mut constraints = vec![];
        for k in 0..=windows {
            let ends = [end(k, [0.02 * k as f64, -0.5]), end(bodies, [k as f64, 0.0])];
            let slides = JointKind::Prismatic { axis: 0.4, angle: 0.1 };
            let kind = if k == 2 { slides } else { JointKind::Revolute };
            constraints.push(Constraint::new(k, ends, &kind));
        }
        for k in 0..windows {
            let coupler = windows + 1 + k;
            let kind = if k == 1 { JointKind::Fixed { angle: 0.3 } } else { JointKind::Revolute };
            constraints.push(Constraint::new(k, [end(coupler, [-0.4, 0.1]), end(k, [0.0, 0.5])], &kind));
            let right = [end(k + 1, [0.1, 0.5]), end(coupler, [0.6, 0.0])];
            constraints.push(Constraint::new(k, right, &JointKind::Revolute));
        }
        // The order of the file is not that of the chain.
        constraints.reverse();
        constraints.swap(1, 3 * windows / 2);
        (constraints, bodies)
    }

    #[test]
    fn entries_grow_linearly_along_a_chain() {
        let stored = |windows: usize| {
            let (mut constraints, bodies) = ladder(windows);
            constraints.sort_by_key(|c| c.scene_joint % 7);
            let (first, m) = first_rows(&constraints);
            EnvelopeQr::new(&constraints, &first, 3 * bodies, m).expect("fewer rows than coordinates").a.len()
        };
        let (short, long) = (stored(20), stored(80));
        assert!(long < 5 * short, "{long} against {short}");
    }
}
