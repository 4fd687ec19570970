//! Velocities at the start of the motion, from those that the scene gives.
//!
//! The motion of a free body is that of its reference point, u `(2,)` [m/s], and its angular velocity w [rad/s]: the quantities for which a
//! scene gives start values. Those given hold. The others, x, are as near to zero as drives and joints admit, in the metric of mass and moment
//! of inertia,
//!
//!   minimise the sum over the free bodies of m |u|^2 + I w^2 over x, subject to (dphi/dq) qd = -dphi/dt,
//!
//! which depends neither on the place nor on the direction of the whole. A value that is given counts as held if the joints admit it to 1e-6
//! of the largest speed; the projection onto the joints afterwards moves it by no more.
//!
//! # Source
//! Equality-constrained least squares by least-norm solution: Golub, Van Loan (2013), Matrix Computations, section 6.2. Consistent initial
//! velocities of mechanisms: Nikravesh (1988), Computer-Aided Analysis of Mechanical Systems.

use super::closure::{Closure, Gaps, least_norm};
use super::frame::Frame;
use crate::extremum::largest;
use crate::plane::left;
use common::failure::SimulationFailure;
use common::scene::Motion;
use nalgebra::DVector;

/// Velocities that the joints do not admit, over the largest velocity, up to which a value that is given holds: digits that people write [1].
const HELD: f64 = 1e-6;

/// A free body at the start.
struct StartBody {
    /// Index into the scene's bodies.
    body: usize,
    /// Its first coordinate.
    first: usize,
    /// Vector from its reference point to its centre of mass, turned by a quarter, in global axes `(2,)` [m].
    turned: [f64; 2],
    /// Mass [kg] and moment of inertia [kg m^2].
    inertia: [f64; 2],
}

impl Closure<'_> {
    /// Velocities at the closed position `q` of time zero `(n,)`.
    ///
    /// # Errors
    /// [`SimulationFailure::StartVelocity`] for the first value given, in the order of the bodies, that drives, joints and the values before it
    /// do not admit.
    pub(crate) fn start_velocity(&self, q: &DVector<f64>) -> Result<DVector<f64>, SimulationFailure> {
        let starts = self.starts(q);
        let given = self.given(&starts);
        // Velocities that joints and drives determine are those of the ideal motion, to the last bit.
        if given.iter().all(Option::is_none) && self.is_determined(q) {
            return Ok(self.velocity(0.0, q));
        }
        let gaps = self.gaps(0.0, q);
        let (found, open) = self.nearest(&gaps, &starts, &given);
        if !self.holds(&gaps, &starts, &found, open) {
            return Err(self.unheld(&gaps, &starts, &given));
        }
        let v = of_centres(&starts, found);
        let open = &gaps.jacobian * self.to_lengths(v.clone()) + &gaps.rate;
        Ok(v - self.to_coordinates(least_norm(&gaps.jacobian, &open)))
    }

    fn starts(&self, q: &DVector<f64>) -> Vec<StartBody> {
        let bodies = self.scene.bodies.iter().zip(&self.first).enumerate();
        let start = |(body, (of_scene, first)): (usize, (&common::scene::Body, &Option<usize>))| {
            let first = (*first)?;
            let Motion::Free { mass, inertia, centre_of_mass, .. } = of_scene.motion else { return None };
            let frame = Frame::free(&[q[first], q[first + 1], q[first + 2]], &[0.0; 3]);
            Some(StartBody {
                body,
                first,
                turned: left(frame.turn(centre_of_mass)),
                inertia: [mass, inertia],
            })
        };
        bodies.filter_map(start).collect()
    }

    /// (u_x, u_y, w) of every free body as far as the scene gives them `(n,)`.
    fn given(&self, starts: &[StartBody]) -> Vec<Option<f64>> {
        let mut given = vec![None; self.n];
        for start in starts {
            if let Motion::Free { start_velocity, start_speed, .. } = self.scene.bodies[start.body].motion {
                (0..2).for_each(|k| given[start.first + k] = start_velocity.map(|u| u[k]));
                given[start.first + 2] = start_speed;
            }
        }
        given
    }

    /// (u, w) of all free bodies `(n,)` nearest to zero for those `given`, and the largest velocity of a gap that they leave [m/s].
    fn nearest(&self, gaps: &Gaps, starts: &[StartBody], given: &[Option<f64>]) -> (DVector<f64>, f64) {
        // Derivatives to (u, w), those to coordinates as lengths before: v = u + w turned.
        let mut to_motion = gaps.jacobian.clone();
        let heaviest = largest(starts.iter().map(|start| start.inertia[0]));
        let mut weight = vec![1.0; self.n];
        for StartBody { first, turned, inertia: [mass, inertia], .. } in starts {
            let unit = self.unit[first + 2];
            let [x, y, angle] = [0, 1, 2].map(|k| to_motion.column(first + k).clone_owned());
            to_motion.set_column(first + 2, &(angle * unit + x * turned[0] + y * turned[1]));
            let [of_velocity, of_speed] = [mass / heaviest, inertia / heaviest].map(f64::sqrt);
            weight[*first..first + 3].copy_from_slice(&[of_velocity, of_velocity, of_speed]);
        }
        let mut found = DVector::from_iterator(self.n, given.iter().map(|given| given.unwrap_or(0.0)));
        let open = -(&to_motion * &found + &gaps.rate);
        let sought: Vec<usize> = (0..self.n).filter(|&k| given[k].is_none()).collect();
        let mut weighted = to_motion.select_columns(&sought);
        for (mut column, &k) in weighted.column_iter_mut().zip(&sought) {
            column /= weight[k];
        }
        let x = least_norm(&weighted, &open);
        // Refined once: products of the rows lose digits.
        let x = &x + least_norm(&weighted, &(&open - &weighted * &x));
        let left = (&weighted * &x - &open).amax();
        sought.iter().zip(x.iter()).for_each(|(&k, x)| found[k] = x / weight[k]);
        (found, left)
    }

    /// Whether the velocity of a gap `open` [m/s] that the velocities (u, w) `found` `(n,)` leave is rounding, or digits not given.
    fn holds(&self, gaps: &Gaps, starts: &[StartBody], found: &DVector<f64>, open: f64) -> bool {
        let fastest = self.largest(&of_centres(starts, found.clone()));
        open <= HELD * fastest.max(gaps.rate.amax())
    }

    /// The failure for the first value `given` that drives, joints and those before it do not admit.
    fn unheld(&self, gaps: &Gaps, starts: &[StartBody], given: &[Option<f64>]) -> SimulationFailure {
        let mut held = vec![None; self.n];
        let of_bodies = starts.iter().flat_map(|start| (0..3).map(move |k| (start, k)));
        let mut failure = None;
        for (start, k, value) in of_bodies.filter_map(|(s, k)| Some((s, k, given[s.first + k]?))) {
            let (before, _) = self.nearest(gaps, starts, &held);
            held[start.first + k] = Some(value);
            let key = ["start_velocity.x", "start_velocity.y", "start_speed"][k];
            failure = Some(SimulationFailure::StartVelocity {
                key: format!("bodies.{}.{key}", self.scene.bodies[start.body].name),
                given: value,
                needed: before[start.first + k],
            });
            let (found, open) = self.nearest(gaps, starts, &held);
            if !self.holds(gaps, starts, &found, open) {
                break;
            }
        }
        failure.expect("all that is given together does not hold")
    }
}

/// Velocities of the centres of mass and angular velocities `(n,)` from (u, w) `(n,)`.
fn of_centres(starts: &[StartBody], mut motion: DVector<f64>) -> DVector<f64> {
    for StartBody { first, turned, .. } in starts {
        let speed = motion[first + 2];
        (0..2).for_each(|k| motion[first + k] += speed * turned[k]);
    }
    motion
}
