//! Elimination of an island's ideal joints: the equations of motion keep the form M qdd = f, with the joints' reactions part of f.
//!
//! M a + G' lambda = f and G a + h = 0, with the diagonal mass matrix M [kg, kg m^2], the accelerations a `(n,)`, the derivative G
//! `(m, n)` of the constraints to the coordinates, the multipliers lambda `(m,)` [N, N m] and the centripetal part h `(m,)` (accelerations
//! of prescribed bodies included). With G M^-1/2 = R' Q', Q `(n, m)` orthonormal and R `(m, m)` upper triangular, and z = R^-T h, the force
//! with reactions is
//!
//! f - G' lambda = M^1/2 [(1 - Q Q') M^-1/2 f - Q z]:
//!
//! the part of f in the null space of the constraints, and the part that keeps them closed. No product G M^-1 G' is formed, so that bodies
//! almost without inertia do no harm. The exact derivatives follow from the same Q and R: for a column x of coordinates, rates or time, f is
//! replaced by df/dx - d(G' lambda)/dx and h by d(G a + h)/dx. Positions and velocities that the integration lets drift off the constraints
//! are moved back along M^-1/2 Q.
//!
//! Valid where the rows of G are independent: dependent ones are reported. One source serves one island and one per SIMD lane.
//!
//! # Source
//! Udwadia, Kalaba (1992), Proc. R. Soc. Lond. A 439, 407-410 (the force with reactions; here the
//! pseudo-inverse is Q R^-T). QR factors for constrained mechanisms: Kim, Vanderploeg (1986), J. Mech. Trans.
//! Autom. Des. 108, 183-188. Null space method: Benzi, Golub, Liesen (2005), Acta Numerica 14, 1-137.
//! Coordinate projection: Eich (1993), SIAM J. Numer. Anal. 30, 1467-1482.

use super::constraint::{Constraint, first_rows};
use super::coupling::JointInput;
use super::frame::{Frame, Placed};
use super::joint_friction::JointFriction;
use super::orthonormal::OrthonormalRows;
use crate::integrate::Linearised;
use crate::lanes::{Lanewise, Real};

/// The ideal joints of an island with `n` coordinates and `m` rows of constraints, or of one island per lane.
#[derive(Debug, Clone)]
pub struct Elimination<R = f64> {
    /// The ideal joints as constraints.
    pub constraints: Vec<Constraint<R>>,
    /// What constraints are given, by their index, one per lane.
    inputs: Vec<(usize, Vec<JointInput>)>,
    /// First row of each.
    pub(super) first: Vec<usize>,
    /// Number of coordinates n.
    n: usize,
    /// Number of rows m.
    pub(crate) rows: usize,
    /// Values phi of the constraints, or another column `(m,)`.
    pub(super) phi: Vec<R>,
    /// Q and R.
    pub(super) factors: OrthonormalRows<R>,
    /// h, later the multipliers lambda `(m,)`.
    pub(super) lambda: Vec<R>,
    /// Derivatives of G a + h `(m, n)`.
    c: Vec<R>,
    /// Friction of the joints.
    pub(crate) friction: JointFriction<R>,
}

impl Elimination {
    /// The elimination for an island with the diagonal mass matrix `mass` `(n,)` [kg, kg m^2].
    pub(crate) fn new(constraints: Vec<Constraint>, mass: &[f64]) -> Self {
        let root = mass.iter().map(|mass| mass.sqrt()).collect();
        Self::with_roots(constraints, root, 0.0)
    }

    /// The constraints and the number of their rows alone, without space for factors and derivatives.
    pub(crate) fn without_factors(constraints: Vec<Constraint>) -> Self {
        let none = Self::with_roots(vec![], vec![], 0.0);
        let (first, rows) = first_rows(&constraints);
        Elimination { constraints, first, rows, ..none }
    }

    /// The elimination with what constraints of these indices are given.
    pub(crate) fn with_inputs(mut self, inputs: Vec<(usize, JointInput)>) -> Self {
        self.inputs = inputs.into_iter().map(|(joint, input)| (joint, vec![input])).collect();
        self
    }

    /// This elimination in every lane; `like` sets the number of lanes.
    pub(crate) fn in_lanes<R: Real>(&self, like: R) -> Elimination<R> {
        let constraints = self.constraints.iter().map(|c| c.in_lanes(like)).collect();
        let root = self.factors.root.iter().map(|root| root.in_lanes(like)).collect();
        let inputs = self.inputs.iter().map(|(joint, input)| (*joint, vec![input[0].clone(); R::LANES]));
        Elimination { inputs: inputs.collect(), ..Elimination::with_roots(constraints, root, like) }
    }

    /// Writes the constants of this elimination into lane `lane` of `to`, an elimination of the same topology.
    pub(crate) fn write_lane<R: Real>(&self, lane: usize, to: &mut Elimination<R>) {
        for (to, from) in to.constraints.iter_mut().zip(&self.constraints) {
            from.write_lane::<R>(lane, to);
        }
        for ((_, to), (_, from)) in to.inputs.iter_mut().zip(&self.inputs) {
            to[lane].clone_from(&from[0]);
        }
        to.friction.update(&to.constraints);
        to.factors.set_lane(lane, &self.factors);
    }

    /// Whether both join the same bodies by the same kinds of joints.
    pub(crate) fn has_same_topology(&self, other: &Self) -> bool {
        let mut pairs = self.constraints.iter().zip(&other.constraints);
        self.constraints.len() == other.constraints.len() && pairs.all(|(a, b)| a.has_same_topology(b))
    }
}

impl<R: Real> Elimination<R> {
    /// The elimination for masses with the square roots `root` `(n,)`; `like` sets the number of lanes.
    fn with_roots(constraints: Vec<Constraint<R>>, root: Vec<R>, like: R) -> Self {
        let (zero, n) = (like.zero(), root.len());
        let (first, m) = first_rows(&constraints);
        Elimination {
            friction: JointFriction::new(&constraints, &first, m, like),
            constraints,
            inputs: vec![],
            first,
            n,
            rows: m,
            phi: vec![zero; m],
            factors: OrthonormalRows::new(m, root, like),
            lambda: vec![zero; m],
            c: vec![zero; m * n],
        }
    }

    /// Evaluates what joints are given at time `t` [s] and these frames.
    #[inline(always)]
    pub(crate) fn update_inputs(&mut self, t: R, frames: &[Frame<R>]) {
        for (joint, inputs) in &self.inputs {
            let c = &mut self.constraints[*joint];
            let angle = frames[c.ends[1].frame].angle;
            for (lane, input) in inputs.iter().enumerate() {
                input.jet(t.lane(lane), angle.lane(lane)).write_lane::<R>(lane, &mut c.input);
            }
        }
    }

    /// Power of the joints that are given functions of time, for the multipliers `lambda` `(m,)` [W].
    pub(crate) fn driving_power(&self, lambda: &[R]) -> R {
        let mut power = self.factors.apart.zero();
        for (joint, c) in self.constraints.iter().enumerate() {
            if let Some([rate, _]) = c.over_time() {
                power += lambda[self.first[joint]] * rate;
            }
        }
        power
    }

    /// Fills phi, Q and R. Returns one, zero in lanes where the constraints are dependent.
    #[inline(always)]
    pub(super) fn factor(&mut self, at: Placed<R>) -> R {
        let like = self.factors.apart;
        like.apart((self, at))
    }

    /// What [`Self::factor`] does.
    #[inline(always)]
    pub(super) fn factor_rows(&mut self, at: Placed<R>) -> R {
        self.factors.clear();
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c.ends);
            let (phi, rows) = c.position(a, b);
            for r in 0..c.rows() {
                self.phi[first + r] = phi[r];
                for side in 0..2 {
                    let frame = c.ends[side].frame;
                    if at.jet(frame).is_some() {
                        continue;
                    }
                    for k in 0..3 {
                        self.factors.set(first + r, 3 * frame + k, rows[r][3 * side + k]);
                    }
                }
            }
        }
        self.factors.orthonormalise()
    }

    /// Adds the reactions and the friction of the joints to the applied force `f`; where they do not exist, the force is not a number.
    /// Returns one, else zero: where the constraints are independent, and where reactions and friction balance each other.
    #[inline(always)]
    pub(crate) fn add_reactions(&mut self, at: Placed<R>, f: &mut [R]) -> [R; 2] {
        let like = self.factors.apart;
        like.apart((self, at, f))
    }

    /// What [`Self::add_reactions`] does.
    #[inline(always)]
    pub(super) fn balance(&mut self, at: Placed<R>, f: &mut [R]) -> [R; 2] {
        let independent = self.factor(at);
        let zero = independent.zero();
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c.ends);
            let h = c.centripetal(a, b);
            self.lambda[first..first + c.rows()].copy_from_slice(&h[..c.rows()]);
            for side in 0..2 {
                if let Some(jet) = at.jet(c.ends[side].frame) {
                    let (_, rows) = c.position(a, b);
                    for r in 0..c.rows() {
                        self.lambda[first + r] =
                            self.lambda[first + r].plus_product(rows[r][3 * side + 2], jet[2]);
                    }
                }
            }
        }
        // z = R^-T h in the place of h, then lambda = R^-1 (Q' M^-1/2 f + z) and the force left.
        self.factors.forward(&mut self.lambda, 1);
        self.factors.add_forces(f, &mut self.lambda, 1);
        let mut balanced = zero.like(1.0);
        if self.friction.count() > 0 {
            balanced = self.friction.add(at, &self.constraints, &self.factors, f, &mut self.lambda);
        }
        self.factors.subtract_reactions(&self.lambda, f, 1);
        self.factors.backward(&mut self.lambda);
        let nothing = zero.like(f64::NAN);
        let exists = R::both(zero.below(independent), zero.below(balanced));
        for k in 0..f.len() {
            f[k] = R::select(exists, f[k], nothing);
        }
        [independent, balanced]
    }

    /// After [`Self::add_reactions`] to `to.f`: turns the derivatives of the applied force in `to` into those
    /// of the force with reactions, stores the multipliers, and adds the reactions on prescribed bodies.
    #[inline(always)]
    pub(crate) fn reduce_derivatives(&mut self, at: Placed<R>, to: &mut Linearised<R>) {
        let n = self.n;
        to.lambda.copy_from_slice(&self.lambda);
        self.explicit_reaction_terms(at, to);
        let Elimination { constraints, factors, friction, .. } = self;
        if friction.count() > 0 {
            friction.add_derivatives(at, constraints, factors, to);
        }
        // The accelerations are those with reactions, the same for both.
        let like = self.factors.apart;
        for (rates, slopes) in [(false, &mut to.k), (true, &mut to.d)] {
            like.apart((&mut *self, at, to.f.as_slice(), rates));
            like.apart((&mut *self, at, slopes.as_mut_slice(), n));
        }
        self.time_derivative(at, &to.f);
        self.reduce::<true>(at, &mut to.ft, 1);
    }

    /// Turns the derivatives `x` `(n, columns)` of the applied force and those of G a + h, which are c or with `TIME` phi, into those of the
    /// force with reactions and friction.
    #[inline(always)]
    pub(super) fn reduce<const TIME: bool>(&mut self, at: Placed<R>, x: &mut [R], columns: usize) {
        let Elimination { constraints, factors, friction, c, phi, .. } = self;
        let c = if TIME { phi } else { c };
        factors.forward(c, columns);
        factors.add_forces(x, c, columns);
        if friction.count() > 0 {
            friction.reduce(at, constraints, c, x, columns);
        }
        factors.subtract_reactions(c, x, columns);
    }

    /// Subtracts d(G' lambda)/dx, and the reactions on prescribed bodies.
    #[inline(always)]
    fn explicit_reaction_terms(&self, at: Placed<R>, to: &mut Linearised<R>) {
        let n = self.n;
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c.ends);
            let lambda = &self.lambda[first..first + c.rows()];
            let derivative = c.reaction_derivative(a, b, lambda);
            let (_, rows) = c.position(a, b);
            for side in 0..2 {
                let frame = c.ends[side].frame;
                if at.jet(frame).is_some() {
                    let on = &mut to.prescribed[frame - n / 3];
                    for k in 0..3 {
                        for r in 0..c.rows() {
                            on[k] = on[k].minus_product(rows[r][3 * side + k], lambda[r]);
                        }
                    }
                    continue;
                }
                for r in 0..3 {
                    let row = 3 * frame + r;
                    for other in 0..2 {
                        let to_frame = c.ends[other].frame;
                        let entries = &derivative[3 * side + r];
                        match at.jet(to_frame) {
                            Some(jet) => {
                                to.ft[row] = to.ft[row].minus_product(entries[3 * other + 2], jet[1]);
                            }
                            None => {
                                for k in 0..3 {
                                    to.k[row * n + 3 * to_frame + k] -= entries[3 * other + k];
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    /// Accelerations of the pair that a constraint joins `(6,)`, at the force with reactions `f`.
    #[inline(always)]
    fn accelerations(&self, c: &Constraint<R>, at: Placed<R>, f: &[R]) -> [R; 6] {
        let mut a = [f[0].zero(); 6];
        for side in 0..2 {
            let frame = c.ends[side].frame;
            match at.jet(frame) {
                Some(jet) => a[3 * side + 2] = jet[2],
                None => {
                    for k in 0..3 {
                        let coordinate = 3 * frame + k;
                        a[3 * side + k] = self.factors.acceleration(coordinate, f[coordinate]);
                    }
                }
            }
        }
        a
    }

    /// Fills c with the derivatives of G a + h to the coordinates, or to their rates.
    #[inline(always)]
    pub(super) fn derive_constraints(&mut self, at: Placed<R>, f: &[R], rates: bool) {
        let n = self.n;
        self.c.fill(f[0].zero());
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            let [a, b] = at.pair(&c.ends);
            let (to_q, to_v) = c.acceleration_derivatives(a, b, &self.accelerations(&c, at, f));
            let rows = if rates { &to_v } else { &to_q };
            for side in 0..2 {
                let frame = c.ends[side].frame;
                if at.jet(frame).is_some() {
                    continue;
                }
                for r in 0..c.rows() {
                    for k in 0..3 {
                        self.c[(first + r) * n + 3 * frame + k] = rows[r][3 * side + k];
                    }
                }
            }
        }
    }

    /// Fills phi with the derivative of G a + h to time through the prescribed bodies.
    #[inline(always)]
    fn time_derivative(&mut self, at: Placed<R>, f: &[R]) {
        self.phi.fill(f[0].zero());
        for joint in 0..self.constraints.len() {
            let (first, c) = (self.first[joint], self.constraints[joint]);
            if let Some([_, of_acceleration]) = c.over_time() {
                self.phi[first] += of_acceleration;
            }
            if at.jet(c.ends[0].frame).is_none() && at.jet(c.ends[1].frame).is_none() {
                continue;
            }
            let [a, b] = at.pair(&c.ends);
            let (_, g) = c.position(a, b);
            let (to_q, to_v) = c.acceleration_derivatives(a, b, &self.accelerations(&c, at, f));
            for side in 0..2 {
                if let Some([_, omega, alpha, jerk]) = at.jet(c.ends[side].frame) {
                    let k = 3 * side + 2;
                    for r in 0..c.rows() {
                        let phi = &mut self.phi[first + r];
                        *phi = phi
                            .plus_product(to_q[r][k], *omega)
                            .plus_product(to_v[r][k], *alpha)
                            .plus_product(g[r][k], *jerk);
                    }
                }
            }
        }
    }
}
