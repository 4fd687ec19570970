//! Normal forces of ideal joints that hold with the friction that follows from them.
//!
//! With the multipliers lambda_0 `(m,)` without friction, those p_k `(m,)` of a unit friction force in joint k, the ratios c_k = F_T / N of
//! friction to normal force [1] and the normal forces N_k as functions of the two multipliers of their joint (`coupling.rs`),
//!
//!   lambda = lambda_0 - sum_k p_k c_k x_k,  x_k = N_k(lambda),
//!
//! as many equations as joints with friction. They are solved by Newton's method from x = 0, with the matrix
//! A = 1 + (dN_j/dlambda p_k c_k)_jk, until x and N(lambda) agree to 1e-12 of the largest normal force. N_k is a norm: where the matrix
//! (N_j(p_k) |c_k|)_jk has a spectral radius below one, x -> N(lambda(x)) is a contraction in a weighted largest norm, so that
//! there is one solution, and the leading minors of A are positive. Random systems with a spectral radius of 0.99 took at most 8 steps.
//!
//! Beyond that there may be no solution, or several. A solution counts only if all pivots of A are positive, as they are along the way
//! on which friction grows from zero; with one joint, where x - N(lambda(x)) is concave, Newton's method from zero finds the end of that
//! way if it has one. Without such a solution there is no balance: the mechanism locks itself.
//!
//! # Source
//! Solvability with friction in ideal joints: Fraczek, Wojtyra (2011), Mechanism and Machine Theory 46, 312-334; Genot, Brogliato
//! (1999), European Journal of Mechanics A/Solids 18, 653-677. Newton's method for functions with corners: Qi, Sun (1993),
//! Mathematical Programming 58, 353-367.

use super::sliding::normal_force;
use crate::integrate::{Band, Layout, factor, solve};
use crate::lanes::Real;

/// Most steps of Newton's method.
const MOST_STEPS: usize = 12;
/// Accepted difference of x and N(lambda), over the largest normal force [1].
const TOLERANCE: f64 = 1e-12;
/// Normal force below which all counts as nothing [N].
const SMALLEST: f64 = 1e-200;

/// One joint in these equations.
#[derive(Debug, Clone)]
pub struct RubbingJoint<R> {
    /// First of the two multipliers of the joint.
    pub row: usize,
    /// Inverse of half the length of a guide, by which the normal force N follows from them [1/m]; `None` for a pin.
    pub per_half: Option<R>,
    /// Ratio c of friction to normal force [1].
    pub ratio: R,
    /// Normal force x [N].
    pub normal: R,
    /// Derivative of N to the two multipliers `(2,)` [1, 1/m].
    pub slopes: [R; 2],
}

/// The equations of all joints with friction of an island, or of one island per lane.
#[derive(Debug, Clone)]
pub struct FrictionBalance<R = f64> {
    /// The joints with friction.
    pub joints: Vec<RubbingJoint<R>>,
    /// Number of multipliers m.
    m: usize,
    /// Multipliers lambda_0 without friction `(m,)`.
    pub lambda: Vec<R>,
    /// Multipliers p_k of unit friction forces `(joints, m)`.
    pub influence: Vec<R>,
    /// Layout of the matrix A, and its factors.
    layout: Band,
    matrix: Vec<R>,
    /// Differences x - N, or another column `(joints,)`.
    pub column: Vec<R>,
}

impl<R: Real> FrictionBalance<R> {
    /// Space for `joints` among `m` multipliers; `like` sets the number of lanes.
    pub(super) fn new(joints: Vec<RubbingJoint<R>>, m: usize, like: R) -> Self {
        let (zero, count) = (like.zero(), joints.len());
        let layout = Band::new(count, count);
        FrictionBalance {
            joints,
            m,
            lambda: vec![zero; m],
            influence: vec![zero; count * m],
            matrix: vec![zero; layout.len()],
            column: vec![zero; count],
            layout,
        }
    }

    /// N_k(p_k) |c_k|: how much the friction of joint `k` amplifies its own normal force [1].
    #[inline(always)]
    pub(super) fn amplification(&self, k: usize) -> R {
        let joint = &self.joints[k];
        let own = &self.influence[k * self.m + joint.row..][..2];
        normal_force(joint.per_half, [own[0], own[1]]).0 * joint.ratio.abs()
    }

    /// Multipliers of joint `k` at the normal forces x `(2,)`.
    #[inline(always)]
    fn multipliers(&self, k: usize) -> [R; 2] {
        let row = self.joints[k].row;
        let mut lambda = [self.lambda[row], self.lambda[row + 1]];
        for j in 0..self.joints.len() {
            let friction = self.joints[j].ratio * self.joints[j].normal;
            for r in 0..2 {
                lambda[r] = lambda[r].minus_product(self.influence[j * self.m + row + r], friction);
            }
        }
        lambda
    }

    /// Solves for the normal forces and leaves the factors of A. Returns one, zero in lanes where no solution was found.
    #[inline(always)]
    pub(super) fn solve(&mut self) -> R {
        let zero = self.lambda[0].zero();
        let (one, count) = (zero.like(1.0), self.joints.len());
        for joint in &mut self.joints {
            joint.normal = zero;
        }
        let mut steps = 0;
        loop {
            let (mut difference, mut largest) = (zero, zero.like(SMALLEST));
            for k in 0..count {
                let lambda = self.multipliers(k);
                let joint = &mut self.joints[k];
                let (normal, slopes) = normal_force(joint.per_half, lambda);
                let off = joint.normal - normal;
                joint.slopes = slopes;
                self.column[k] = off;
                // What is not a number must not count as below the tolerance.
                difference = off.abs().larger(difference) + off * zero;
                largest = largest.larger(normal).larger(joint.normal);
            }
            self.fill_matrix(one);
            let sound = factor(&mut self.matrix, &self.layout, zero);
            let solved = difference.below(largest * TOLERANCE);
            let open = R::select(solved, zero, one);
            if steps == MOST_STEPS || !R::any(zero.below(open)) {
                let mut regular = zero.below(sound);
                for k in 0..count {
                    regular = R::both(regular, zero.below(self.matrix[self.layout.index(k, k)]));
                }
                return R::select(R::both(solved, regular), one, zero);
            }
            solve(&self.matrix, &self.layout, &mut self.column);
            for k in 0..count {
                // Lanes that are solved keep their state while others go on.
                let joint = &mut self.joints[k];
                joint.normal = R::select(solved, joint.normal, joint.normal - self.column[k]);
            }
            steps += 1;
        }
    }

    /// Fills the matrix A at the slopes of the joints.
    #[inline(always)]
    fn fill_matrix(&mut self, one: R) {
        let (zero, m) = (one.zero(), self.m);
        for j in 0..self.joints.len() {
            let (row, slopes) = (self.joints[j].row, self.joints[j].slopes);
            for k in 0..self.joints.len() {
                let influence = &self.influence[k * m + row..k * m + row + 2];
                let product = (slopes[0] * influence[0]).plus_product(slopes[1], influence[1]);
                let diagonal = if j == k { one } else { zero };
                self.matrix[self.layout.index(j, k)] = diagonal.plus_product(product, self.joints[k].ratio);
            }
        }
    }

    /// Turns the column from rates dN/dlambda dlambda of the normal forces at constant x into those of x, with the factors of A.
    #[inline(always)]
    pub(super) fn solve_column(&mut self) {
        solve(&self.matrix, &self.layout, &mut self.column);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joints with random influence, scaled to the spectral radius `radius` of (N_j(p_k) |c_k|), at random multipliers of any size.
    fn random(joints: usize, radius: f64, seed: &mut u64) -> FrictionBalance {
        let mut draw = || {
            *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (*seed >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let joint = |k: usize| RubbingJoint {
            row: 2 * k,
            per_half: (!k.is_multiple_of(2)).then_some(2.0 / 0.5),
            ratio: 1.0,
            normal: 0.0,
            slopes: [0.0; 2],
        };
        let mut balance = FrictionBalance::new((0..joints).map(joint).collect(), 2 * joints, 0.0);
        balance.lambda.iter_mut().for_each(|x| *x = draw() * 10_f64.powf(3.0 * draw()));
        balance.influence.iter_mut().for_each(|x| *x = draw());
        // The spectral radius by the power method.
        let m = balance.m;
        let entry = |balance: &FrictionBalance, j: usize, k: usize| {
            let joint = &balance.joints[j];
            normal_force(joint.per_half, [0, 1].map(|r| balance.influence[k * m + joint.row + r])).0
        };
        let (mut x, mut found) = (vec![1.0; joints], 0.0);
        for _ in 0..300 {
            let product = |j: usize| -> f64 { (0..joints).map(|k| entry(&balance, j, k) * x[k]).sum() };
            let next: Vec<f64> = (0..joints).map(product).collect();
            found = next.iter().copied().fold(0.0, f64::max);
            x = next.iter().map(|x| x / found).collect();
        }
        balance.joints.iter_mut().for_each(|joint| joint.ratio = draw().signum() * radius / found);
        balance
    }

    #[test]
    fn whatever_contracts_is_solved() {
        let mut seed = 1;
        for radius in [0.1, 0.5, 0.9, 0.99] {
            for joints in (1..=8).cycle().take(400) {
                let mut balance = random(joints, radius, &mut seed);
                assert_eq!(balance.solve(), 1.0, "{joints} joints at {radius}");
                let largest = balance.joints.iter().fold(0.0_f64, |a, joint| a.max(joint.normal));
                for k in 0..joints {
                    let joint = &balance.joints[k];
                    let off = (normal_force(joint.per_half, balance.multipliers(k)).0 - joint.normal).abs();
                    assert!(off <= 1e-12 * largest && joint.normal >= 0.0, "{off} of {largest}");
                }
            }
        }
    }

    /// One guide with the force `lambda` without friction and `amplification` = p c.
    fn guide(lambda: f64, amplification: f64) -> (f64, f64) {
        let per_half = Some(2.0 / 0.1);
        let joint = RubbingJoint { row: 0, per_half, ratio: amplification, normal: 0.0, slopes: [0.0; 2] };
        let mut balance = FrictionBalance::new(vec![joint], 2, 0.0);
        balance.lambda.copy_from_slice(&[lambda, 0.0]);
        balance.influence.copy_from_slice(&[1.0, 0.0]);
        (balance.solve(), balance.joints[0].normal)
    }

    #[test]
    fn a_guide_has_its_closed_form_and_locks_itself_beyond_one() {
        for (lambda, a) in [(3.0, 0.4), (3.0, -0.4), (-3.0, 0.4), (-3.0, -0.9), (2.0, 0.0), (0.0, 0.7)] {
            // x = |lambda - a x| with the sign of lambda, since |a| < 1.
            let exact = f64::abs(lambda) / (1.0 + a * f64::signum(lambda));
            let (balanced, x) = guide(lambda, a);
            assert!(balanced == 1.0 && (x - exact).abs() < 1e-14 * (1.0 + exact), "{x} against {exact}");
        }
        // No solution, or two, of which 1 / (1 + 4) goes over into that without friction.
        for (lambda, a) in [(-1.0, 1.5), (1.0, -1.5), (1.0, -1.0), (f64::NAN, 0.2), (1.0, f64::NAN)] {
            assert_eq!(guide(lambda, a).0, 0.0, "{lambda} {a}");
        }
        assert_eq!(guide(1.0, 4.0), (1.0, 0.2));
    }
}
