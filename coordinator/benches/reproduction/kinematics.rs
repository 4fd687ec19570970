//! What the kinematics of the linkage with clearance and wear can give for the difference of the wings' angular velocities.
//!
//! Links without mass, journals that keep contact: in every joint the journal lies off the bushing's centre by a rest offset, in the
//! direction of the joint's force. A rod between the two is longer by the offsets of its joints if it is pulled, and shorter
//! if it is pushed; the rocker's hinge gives way against its force. The wings' speeds follow from the closure of each side
//!
//!   |O - x5 d + b u(phi) - P(theta)| = L - sign (x1 + x3),
//!
//! with the crank pin P, the frame pin O, the rocker's direction u and its length b to the rod, the direction d of the force of the
//! frame pin on the rocker, and the sign of the load, positive upwards.

use common::scene::{JointKind, Scene};
use std::f64::consts::TAU;

/// Crank angles of one turn at which the speeds are compared.
const ANGLES: usize = 1440;

/// Lengths of the linkage [m] and its speed [rad/s].
#[derive(Debug, Clone, Copy)]
pub struct Linkage {
    pub crank: f64,
    pub rod: f64,
    pub front: f64,
    pub rear: f64,
    pub pivot: [f64; 2],
    pub speed: f64,
    /// Direction of the load on the wings: 1 upwards, -1 downwards.
    pub load: f64,
}

/// One side at a crank angle.
struct Side {
    /// Angle of the rocker, wing up [rad].
    angle: f64,
    /// Angle of the rod from its lower joint to its upper one, from +x [rad].
    rod: f64,
    /// Change of the angle for an offset of the rod's joints, and for one of the frame joint [rad/m].
    by_rod: f64,
    by_pivot: f64,
    /// Directions of the contacts in the frame of the rocker [rad], in the joint with the rod and in that with the frame.
    contact: [f64; 2],
}

impl Linkage {
    /// The linkage of the drive.
    pub fn of(scene: &Scene, load: f64) -> Option<Self> {
        let point = |body: &str, name: &str| {
            let body = scene.bodies.iter().find(|other| other.name == body)?;
            Some(body.points.iter().find(|other| other.name == name)?.position)
        };
        Some(Self {
            crank: point("crank", "pin")?[0],
            rod: point("right_rod", "rocker_pin")?[0],
            front: -point("right_rocker", "rod_pin")?[0],
            rear: point("right_rocker", "wing")?[0],
            pivot: point("frame", "right_pin")?,
            speed: TAU / scene.life.period,
            load,
        })
    }

    /// One side, 1 right and -1 left, with rest offsets of its joints at crank pin, rod pin and frame pin [m].
    fn side(&self, side: f64, theta: f64, offsets: [f64; 3], guess: f64) -> Side {
        let free = self.closed(side, theta, self.rod, [0.0; 2], guess);
        let [crank_pin, rod_pin, frame_pin] = offsets;
        let give = free.2.map(|d| -frame_pin * d);
        let rod = self.rod - self.load * (crank_pin + rod_pin);
        let (angle, ..) = self.closed(side, theta, rod, give, free.0);
        let (_, n, d, across) = free;
        let body = side * angle;
        // The journal of the rod pushes the rocker along the rod if the load is upwards.
        let along = [self.load * n[0], self.load * n[1]];
        Side {
            angle,
            rod: n[1].atan2(n[0]),
            by_rod: -self.load / (self.front * across),
            by_pivot: (n[0] * d[0] + n[1] * d[1]) / (self.front * across),
            contact: [along[1].atan2(along[0]) - body, d[1].atan2(d[0]) - body],
        }
    }

    /// Closure by Newton's method: angle, direction of the rod, direction of the force of the frame pin on the rocker, and the change of
    /// the distance between the pins per angle and length of the rocker.
    fn closed(
        &self,
        side: f64,
        theta: f64,
        rod: f64,
        give: [f64; 2],
        guess: f64,
    ) -> (f64, [f64; 2], [f64; 2], f64) {
        let from = [
            side * self.pivot[0] + give[0] - self.crank * theta.cos(),
            self.pivot[1] + give[1] - self.crank * theta.sin(),
        ];
        let mut angle = guess;
        let mut end = ([0.0; 2], [0.0; 2], 0.0);
        for _ in 0..50 {
            let (u, turning) = ([-side * angle.cos(), -angle.sin()], [side * angle.sin(), -angle.cos()]);
            let rod_vector = [from[0] + self.front * u[0], from[1] + self.front * u[1]];
            let distance = rod_vector[0].hypot(rod_vector[1]);
            let n = rod_vector.map(|x| x / distance);
            let across = n[0] * turning[0] + n[1] * turning[1];
            let step = (distance - rod) / (self.front * across);
            angle -= step;
            end = (n, u, across);
            if step.abs() < 1e-14 {
                break;
            }
        }
        let (n, u, across) = end;
        // The moments of rod and load about the hinge balance: front u x (rod force) n = rear u x (load).
        let rod_force = self.rear * u[0] * self.load / (self.front * (u[0] * n[1] - u[1] * n[0]));
        let reaction = [-rod_force * n[0], -(rod_force * n[1] + self.load)];
        let size = reaction[0].hypot(reaction[1]);
        (angle, n, reaction.map(|x| x / size), across)
    }

    /// Both sides over a turn, right and left `(2)(ANGLES,)`.
    fn turn(&self, offsets: &[f64; 6]) -> [Vec<Side>; 2] {
        [(1.0, [0, 2, 4]), (-1.0, [1, 3, 5])].map(|(side, joints)| {
            let mut guess = 0.0;
            let mut sides = Vec::with_capacity(ANGLES);
            // A start away from the solution converges within the first angles, which are passed twice.
            for k in (ANGLES - 20..ANGLES).chain(0..ANGLES) {
                let theta = TAU * k as f64 / ANGLES as f64;
                sides.push(self.side(side, theta, joints.map(|joint| offsets[joint]), guess));
                guess = sides[sides.len() - 1].angle;
            }
            sides.split_off(20)
        })
    }

    /// Angles over a turn of the rod of a side, or of its rocker, from its axis to +x [rad].
    pub fn body_angles(&self, side: f64, rod: bool) -> Vec<f64> {
        let [right, left] = self.turn(&[0.0; 6]);
        let of = |here: &Side| if rod { here.rod } else { side * here.angle };
        (if side > 0.0 { right } else { left }).iter().map(of).collect()
    }

    /// Largest angular velocity of a rocker [rad/s].
    pub fn fastest(&self) -> f64 {
        let angle: Vec<f64> = self.turn(&[0.0; 6])[0].iter().map(|side| side.angle).collect();
        (0..ANGLES).map(|k| self.rate(&angle, k).abs()).fold(0.0, f64::max)
    }

    /// Largest difference of the angular velocities of the wings over a turn [rad/s], for rest offsets of the six joints [m].
    pub fn difference(&self, offsets: &[f64; 6]) -> f64 {
        let [right, left] = self.turn(offsets);
        let angle: Vec<f64> = right.iter().zip(&left).map(|(right, left)| right.angle - left.angle).collect();
        let rate = |k: usize| self.rate(&angle, k);
        (0..ANGLES).map(|k| rate(k).abs()).fold(0.0, f64::max)
    }

    /// Bound of the change of that difference [rad/s] if the rest offset of every joint grows by 0 to `growth` [m], whatever the
    /// shape of the bores: a spline through control points at the distance `spacing` [rad] has a slope of at most 2 growth / spacing.
    pub fn bound(&self, offsets: &[f64; 6], growth: f64, spacing: f64) -> f64 {
        let sides = self.turn(offsets);
        let of = |sides: &[Side], k: usize| {
            let rate = |f: &dyn Fn(&Side) -> f64| {
                let [before, after] = [ANGLES - 1, 1].map(|d| f(&sides[(k + d) % ANGLES]));
                wrapped(after - before) / (2.0 * TAU / ANGLES as f64)
            };
            let here = &sides[k];
            // Joint at the crank pin: the force stays on the line of the rod, so that its offset does not change over a turn.
            let moving = [rate(&|side| side.contact[0]), rate(&|side| side.contact[1])];
            let coefficients = 2.0 * rate(&|side| side.by_rod).abs() + rate(&|side| side.by_pivot).abs();
            let slopes = here.by_rod.abs() * moving[0].abs() + here.by_pivot.abs() * moving[1].abs();
            growth * (coefficients + 2.0 / spacing * slopes)
        };
        let both = |k: usize| of(&sides[0], k) + of(&sides[1], k);
        self.speed * (0..ANGLES).map(both).fold(0.0, f64::max)
    }

    fn rate(&self, angle: &[f64], k: usize) -> f64 {
        let (after, before) = (angle[(k + 1) % ANGLES], angle[(k + ANGLES - 1) % ANGLES]);
        self.speed * (after - before) / (2.0 * TAU / ANGLES as f64)
    }
}

/// An angle from half a turn back to half a turn ahead; also what is small anyway.
fn wrapped(angle: f64) -> f64 {
    (angle + TAU / 2.0).rem_euclid(TAU) - TAU / 2.0
}

/// Radial clearances of the six joints [m].
pub fn clearances(scene: &Scene) -> [f64; 6] {
    let mut found = [0.0; 6];
    let joints = scene.joints.iter().filter_map(|joint| match &joint.kind {
        JointKind::Clearance(hinge) => Some(hinge.radial_clearance()),
        _ => None,
    });
    found.iter_mut().zip(joints).for_each(|(place, clearance)| *place = clearance);
    found
}
