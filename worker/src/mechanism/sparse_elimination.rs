//! Elimination of an island's ideal joints as in [`Elimination`](super::elimination::Elimination), with factors that are stored within
//! their envelope and without derivatives: what explicit steps need.
//!
//! With M^-1/2 G' = Q R the force with reactions is M^1/2 [(1 - Q Q') M^-1/2 f - Q R^-T h]; positions and velocities are moved back onto
//! the constraints along M^-1/2 Q. Along a chain of bodies every operation costs a time proportional to their number.

use super::constraint::{Constraint, first_rows};
use super::envelope_qr::EnvelopeQr;
use super::frame::Placed;
use crate::integrate::Linearised;

/// The ideal joints of an island with `n` coordinates and `m` rows of constraints.
#[derive(Debug, Clone)]
pub struct SparseElimination {
    constraints: Vec<Constraint>,
    /// First row of each.
    first: Vec<usize>,
    /// Q and R.
    pub(super) factors: EnvelopeQr,
    /// Share of each row that is normal to those before it, where they were factored last `(m,)` [1].
    shares: Vec<f64>,
    /// Square roots of the masses `(n,)`.
    root: Vec<f64>,
    /// h, later the multipliers lambda `(m,)`.
    lambda: Vec<f64>,
}

impl SparseElimination {
    /// The elimination of these joints for bodies with the diagonal mass matrix `mass` `(n,)` [kg, kg m^2]; `None` if there are more
    /// rows than coordinates.
    pub(super) fn new(constraints: &[Constraint], mass: &[f64]) -> Option<Self> {
        let (first, m) = first_rows(constraints);
        Some(SparseElimination {
            factors: EnvelopeQr::new(constraints, &first, mass.len(), m)?,
            constraints: constraints.to_vec(),
            first,
            shares: vec![1.0; m],
            root: mass.iter().map(|mass| mass.sqrt()).collect(),
            lambda: vec![0.0; m],
        })
    }

    /// Index into the scene's joints of the joint that row `i` belongs to.
    pub(super) fn scene_joint(&self, i: usize) -> usize {
        self.constraints[self.first.partition_point(|&first| first <= i) - 1].scene_joint
    }

    /// Fills `factors` with the rows G of the constraints, each coordinate k divided by its `weight(k)`.
    pub(super) fn fill(&self, at: Placed, weight: impl Fn(usize) -> f64, factors: &mut EnvelopeQr) {
        fill(&self.constraints, &self.first, at, weight, factors);
    }

    /// Fills Q and R; false if the constraints are dependent here.
    fn factor(&mut self, at: Placed) -> bool {
        let SparseElimination { constraints, first, factors, shares, root, .. } = self;
        fill(constraints, first, at, |k| root[k], factors);
        factors.factor(shares)
    }

    /// Adds the reactions to the applied force `f`; where the constraints are dependent, it is not a number, and the result false.
    pub(super) fn add_reactions(&mut self, at: Placed, f: &mut [f64]) -> bool {
        if !self.factor(at) {
            f.fill(f64::NAN);
            return false;
        }
        for (c, &first) in self.constraints.iter().zip(&self.first) {
            let [a, b] = at.pair(&c.ends);
            let h = c.centripetal(a, b);
            self.lambda[first..first + c.rows()].copy_from_slice(&h[..c.rows()]);
            for (side, end) in c.ends.iter().enumerate() {
                if let Some([_, _, alpha, _]) = at.jet(end.frame) {
                    let (_, rows) = c.position(a, b);
                    for (lambda, row) in self.lambda[first..].iter_mut().zip(&rows[..c.rows()]) {
                        *lambda += row[3 * side + 2] * alpha;
                    }
                }
            }
        }
        // z = R^-T h in the place of h, then lambda = R^-1 (Q' M^-1/2 f + z) and the force left.
        let SparseElimination { factors, root, lambda, .. } = self;
        factors.forward(lambda);
        factors.add_components(f.iter().zip(&*root).map(|(f, root)| f / root), lambda);
        factors.subtract(lambda, |k| root[k], f);
        factors.backward(lambda);
        true
    }

    /// After [`Self::add_reactions`]: stores the multipliers, and adds the reactions on prescribed bodies.
    pub(super) fn store_reactions(&self, at: Placed, to: &mut Linearised) {
        to.lambda.copy_from_slice(&self.lambda);
        let bodies = self.root.len() / 3;
        for (c, &first) in self.constraints.iter().zip(&self.first) {
            let [a, b] = at.pair(&c.ends);
            let (_, rows) = c.position(a, b);
            for (side, end) in c.ends.iter().enumerate().filter(|(_, end)| at.jet(end.frame).is_some()) {
                for (k, on) in to.prescribed[end.frame - bodies].iter_mut().enumerate() {
                    *on -= (0..c.rows()).map(|r| rows[r][3 * side + k] * self.lambda[first + r]).sum::<f64>();
                }
            }
        }
    }

    /// One Newton step of the positions back onto the constraints, dq = -M^-1/2 Q R^-T phi; returns the largest gap before it (angles
    /// times `size`) [m], or `None` if the constraints are dependent here.
    pub(super) fn close_positions(&mut self, at: Placed, size: f64, q: &mut [f64]) -> Option<f64> {
        if !self.factor(at) {
            return None;
        }
        let mut gap: f64 = 0.0;
        for (c, &first) in self.constraints.iter().zip(&self.first) {
            let [a, b] = at.pair(&c.ends);
            let (phi, _) = c.position(a, b);
            self.lambda[first..first + c.rows()].copy_from_slice(&phi[..c.rows()]);
            gap = gap.max(largest_of(c, &phi, size));
        }
        let SparseElimination { factors, root, lambda, .. } = self;
        factors.forward(lambda);
        factors.subtract(lambda, |k| 1.0 / root[k], q);
        Some(gap)
    }

    /// After [`Self::close_positions`] has found no gap: projects the velocities onto the constraints, dv =
    /// -M^-1/2 Q (Q' M^1/2 v + R^-T dphi/dt).
    pub(super) fn close_velocities(&mut self, at: Placed, v: &mut [f64]) {
        for (c, &first) in self.constraints.iter().zip(&self.first) {
            let [a, b] = at.pair(&c.ends);
            let (_, rows) = c.position(a, b);
            for (lambda, row) in self.lambda[first..].iter_mut().zip(&rows[..c.rows()]) {
                let sides = c.ends.iter().enumerate();
                let given =
                    sides.filter_map(|(side, end)| at.jet(end.frame).map(|jet| row[3 * side + 2] * jet[1]));
                *lambda = given.sum();
            }
        }
        let SparseElimination { factors, root, lambda, .. } = self;
        factors.forward(lambda);
        factors.add_components(v.iter().zip(&*root).map(|(v, root)| v * root), lambda);
        factors.subtract(lambda, |k| 1.0 / root[k], v);
    }

    /// Largest gap of a joint (angles times `size`) [m].
    pub(super) fn largest_gap(&self, at: Placed, size: f64) -> f64 {
        let gap = |c: &Constraint| {
            let [a, b] = at.pair(&c.ends);
            largest_of(c, &c.position(a, b).0, size)
        };
        self.constraints.iter().map(gap).fold(0.0, f64::max)
    }
}

/// Largest gap of the joint `c` in these values of its rows (angles times `size`) [m].
fn largest_of(c: &Constraint, phi: &[f64], size: f64) -> f64 {
    let gap = |(k, phi): (usize, &f64)| phi.abs() * if c.is_angle(k) { size } else { 1.0 };
    phi[..c.rows()].iter().enumerate().map(gap).fold(0.0, f64::max)
}

/// Fills `factors` with the rows G of the constraints, each coordinate k divided by its `weight(k)`.
fn fill(
    constraints: &[Constraint],
    first: &[usize],
    at: Placed,
    weight: impl Fn(usize) -> f64,
    factors: &mut EnvelopeQr,
) {
    factors.clear();
    for (c, first) in constraints.iter().zip(first) {
        let [a, b] = at.pair(&c.ends);
        let (_, rows) = c.position(a, b);
        for (r, row) in rows[..c.rows()].iter().enumerate() {
            for (side, end) in c.ends.iter().enumerate().filter(|(_, end)| at.jet(end.frame).is_none()) {
                for k in 0..3 {
                    let coordinate = 3 * end.frame + k;
                    factors.set(first + r, coordinate, row[3 * side + k] / weight(coordinate));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::elimination::Elimination;
    use crate::mechanism::envelope_qr::tests::ladder;
    use crate::mechanism::frame::Frame;

    /// Frames `count` bodies in positions and velocities that follow no rule.
    fn frames(count: usize) -> Vec<Frame> {
        let value = |k: usize| (3.7 * k as f64).sin();
        let frame = |b: usize| {
            let k = 6 * b;
            let q = [b as f64 + value(k), value(k + 1), 2.0 * value(k + 2)];
            Frame::free(&q, &[value(k + 3), value(k + 4), value(k + 5)])
        };
        (0..count).map(frame).collect()
    }

    #[test]
    fn reactions_and_corrections_are_those_of_the_dense_elimination() {
        for windows in [1, 3, 12] {
            let (constraints, bodies) = ladder(windows);
            let (all, jets) = (frames(bodies + 1), [[0.3, 1.2, -0.7, 0.0]]);
            let mass: Vec<f64> = (0..3 * bodies).map(|k| 1.0 + 0.8 * (k as f64).cos()).collect();
            let at = Placed { frames: &all, jets: &jets };
            let force: Vec<f64> = (0..3 * bodies).map(|k| (1.3 * k as f64).sin()).collect();
            let of_all = || (force.clone(), vec![0.0; force.len()], force.clone());

            let mut dense = Elimination::new(constraints.clone(), &mass);
            let (mut f, mut q, mut v) = of_all();
            dense.add_reactions(at, &mut f);
            let (gap, independent) = dense.measure_gaps(at, 1.0);
            assert_eq!(independent, 1.0);
            dense.move_back(1.0, &mut q);
            dense.measure_velocities(at, &v);
            dense.move_back(1.0, &mut v);

            let mut sparse =
                SparseElimination::new(&constraints, &mass).expect("fewer rows than coordinates");
            let (mut sparse_f, mut sparse_q, mut sparse_v) = of_all();
            assert!(sparse.add_reactions(at, &mut sparse_f));
            assert_eq!(sparse.close_positions(at, 1.0, &mut sparse_q), Some(gap));
            sparse.close_velocities(at, &mut sparse_v);
            for (a, b) in [(f, sparse_f), (q, sparse_q), (v, sparse_v)] {
                let size = a.iter().fold(1.0, |size: f64, a| size.max(a.abs()));
                a.iter().zip(&b).for_each(|(a, b)| assert!((a - b).abs() < 1e-11 * size, "{a} against {b}"));
            }
        }
    }

    #[test]
    fn dependent_constraints_have_no_reactions() {
        let (mut constraints, bodies) = ladder(12);
        // In the place of two other joints, so that there are fewer rows than coordinates.
        let twice = constraints[5];
        constraints.truncate(constraints.len() - 2);
        constraints.push(twice);
        let (all, mass) = (frames(bodies + 1), vec![1.0; 3 * bodies]);
        let jets = [[0.0; 4]];
        let at = Placed { frames: &all, jets: &jets };
        let mut joints = SparseElimination::new(&constraints, &mass).expect("fewer rows than coordinates");
        let mut f = vec![0.0; 3 * bodies];
        assert!(!joints.add_reactions(at, &mut f));
        assert!(f[0].is_nan());
    }
}
