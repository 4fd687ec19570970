//! The nominal mechanism in motion: where its bodies stand over a cycle, and its journals in their bores.

use common::outputs::{BodyMotion, CycleHistory};
use common::scene::{Attachment, Body, Joint, JointKind, Motion, Scene};

/// Bodies and joints of the scene, by its numbering.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mechanism {
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Joints.
    pub joints: Vec<Joint>,
}

/// A place and an angle: position `(2,)` [m], angle [rad].
pub type Pose = ([f64; 2], f64);

impl Mechanism {
    /// Of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self { bodies: scene.bodies.clone(), joints: scene.joints.clone() }
    }

    /// Where a body stands at instant `k` of a cycle; `None` if the cycle does not tell.
    pub fn pose(&self, cycle: &CycleHistory, body: usize, k: usize) -> Option<Pose> {
        let of = self.bodies.get(body)?;
        if of.motion == Motion::Fixed {
            return Some(([0.0; 2], 0.0));
        }
        let motion: &BodyMotion = cycle.motion.iter().find(|motion| motion.body == of.name)?;
        Some((*motion.position.get(k)?, *motion.angle.get(k)?))
    }

    /// Where a point of a body is at instant `k`.
    pub fn place(&self, cycle: &CycleHistory, at: &Attachment, k: usize) -> Option<[f64; 2]> {
        let ([x, y], angle) = self.pose(cycle, at.body, k)?;
        let (sin, cos) = angle.sin_cos();
        let [a, b] = at.position;
        Some([x + cos * a - sin * b, y + sin * a + cos * b])
    }

    /// From the bushing's centre to the journal's at instant `k`, in the bushing body's frame [m].
    pub fn orbit_at(&self, cycle: &CycleHistory, joint: &Joint, k: usize) -> Option<[f64; 2]> {
        let (journal, bushing) =
            (self.place(cycle, &joint.journal, k)?, self.place(cycle, &joint.bushing, k)?);
        let (sin, cos) = self.pose(cycle, joint.bushing.body, k)?.1.sin_cos();
        let [x, y] = [journal[0] - bushing[0], journal[1] - bushing[1]];
        Some([cos * x + sin * y, cos * y - sin * x])
    }

    /// The same over a whole cycle `(n, 2)` [m]; `None` for an ideal joint, or if the cycle does not tell the motion of
    /// both bodies.
    pub fn orbit(&self, cycle: &CycleHistory, joint: &Joint) -> Option<Vec<[f64; 2]>> {
        if !matches!(joint.kind, JointKind::Clearance(_)) || cycle.time.is_empty() {
            return None;
        }
        (0..cycle.time.len()).map(|k| self.orbit_at(cycle, joint, k)).collect()
    }

    /// Where a body meets others: the places of its joints in its own frame, without repetition; of one that moves its
    /// named points too, and its pivot if it is driven `(p, 2)` [m].
    pub fn outline(&self, body: usize) -> Vec<[f64; 2]> {
        let of = &self.bodies[body];
        let pivot = matches!(of.motion, Motion::Driven { .. }).then_some([0.0; 2]);
        let points = of.points.iter().filter(|_| of.motion != Motion::Fixed).map(|point| point.position);
        let ends = self.joints.iter().flat_map(|joint| [joint.journal, joint.bushing]);
        let mut outline: Vec<[f64; 2]> = Vec::new();
        for at in
            pivot.into_iter().chain(ends.filter(|end| end.body == body).map(|end| end.position)).chain(points)
        {
            if !outline.iter().any(|p| (p[0] - at[0]).hypot(p[1] - at[1]) < 1e-9) {
                outline.push(at);
            }
        }
        outline
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presentation::report::synthetic;

    #[test]
    fn the_orbit_is_told_in_the_frame_of_the_bushing() {
        let mechanism = Mechanism::of(&synthetic::scene());
        let cycle = synthetic::first_cycle();
        for joint in &mechanism.joints {
            let orbit = mechanism.orbit(&cycle, joint).unwrap();
            for (k, [x, y]) in orbit.iter().enumerate() {
                let [ex, ey] = synthetic::eccentricity(cycle.time[k]);
                assert!((x - ex).hypot(y - ey) < 1e-12, "joint {}, {k}: {x} {y}", joint.name);
            }
        }
        let mut unknown = cycle.clone();
        unknown.motion.pop();
        assert_eq!(mechanism.orbit(&unknown, &mechanism.joints[0]), None);
    }

    #[test]
    fn a_driven_body_reaches_from_its_pivot() {
        let mechanism = Mechanism::of(&synthetic::scene());
        assert_eq!(mechanism.outline(1)[0], [0.0; 2]);
        assert_eq!(mechanism.outline(1).len(), 7);
        assert_eq!(mechanism.outline(2).len(), 6);
    }
}
