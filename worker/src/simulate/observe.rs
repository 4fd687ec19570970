//! What an evaluation shows of the cycle just measured.

use super::moving::Moving;
use super::run::Run;
use crate::mechanism::{ExternalLoads, Prescribed};
use crate::outputs::{
    BodyTrack, Compared, ForceTrack, MomentTrack, PointTrack, Shown, largest_difference, largest_torque,
    together,
};
use common::outputs::{BodyMotion, BodyTrace, CycleHistory, EnergyBalance};
use common::scene::{Attachment, Motion, OutputKind, SignedBody};
use std::borrow::Cow;

/// Points per cycle of the histories shown.
const SHOWN: usize = 1000;

/// What is shown of the first cycle, by joint in the scene's order.
pub struct FirstSeen {
    /// The cycle itself, if it was asked for.
    pub cycle: Option<CycleHistory>,
    /// Largest force of every joint [N].
    pub peaks: Vec<(String, f64)>,
    /// Share of the cycle in free flight of every joint with clearance [1].
    pub free_flight: Vec<(String, f64)>,
    /// Energy, if the cycle was asked for.
    pub energy: Option<EnergyBalance>,
}

impl Run<'_> {
    /// Outputs that come from the motion of the cycle just measured; zero in the place of the others.
    pub fn motion_outputs(&self) -> Vec<f64> {
        let differ = |compared, a: &SignedBody, b: &SignedBody| {
            largest_difference(compared, &self.track(a), a.sign, &self.track(b), b.sign)
        };
        let value = |kind: &OutputKind| match kind {
            OutputKind::LargestWear { .. } | OutputKind::External { .. } => 0.0,
            OutputKind::AngularVelocityDifference { a, b } => differ(Compared::Speed, a, b),
            OutputKind::AngleDifference { a, b } => differ(Compared::Angle, a, b),
            OutputKind::PeakJointForce { joints } => {
                let peak =
                    |&joint: &usize| self.islands.iter().find_map(|m| m.recorder.peak(&m.island, joint));
                joints.iter().filter_map(peak).fold(0.0, f64::max)
            }
            OutputKind::PositionError { at } => self.position_error(at),
            OutputKind::DrivingTorque { body } => self.driving_torque(*body),
        };
        self.scene.outputs.iter().map(|o| value(&o.kind)).collect()
    }

    /// Motion of a body over the cycle: as recorded, or as prescribed.
    fn track(&self, body: &SignedBody) -> Cow<'_, BodyTrack> {
        if let Some(recorded) = self.islands.iter().find_map(|m| m.recorder.body(&m.island, body.body)) {
            return Cow::Borrowed(recorded);
        }
        let mut track = BodyTrack::default();
        if let Some(motion) = Prescribed::from_body(&self.scene.bodies[body.body]) {
            for t in self.shown_times() {
                let [angle, omega, alpha, _] = motion.jet(t);
                track.push(t, angle, omega, alpha);
            }
        }
        Cow::Owned(track)
    }

    /// Largest distance of a point from its place on the ideal mechanism [m].
    fn position_error(&self, at: &Attachment) -> f64 {
        let recorded = self.islands.iter().find_map(|m| m.recorder.point(at));
        let ideal: Option<&PointTrack> =
            self.ideal_paths.iter().find(|(place, _)| place == at).map(|(_, path)| path);
        recorded.zip(ideal).map_or(0.0, |(recorded, ideal)| recorded.largest_distance(ideal))
    }

    /// Largest torque that a driven body needs [N m].
    fn driving_torque(&self, body: usize) -> f64 {
        let Some(motion) = Prescribed::from_body(&self.scene.bodies[body]) else { return 0.0 };
        let moments: Vec<&MomentTrack> =
            self.islands.iter().filter_map(|m| m.recorder.moment(&m.island, body)).collect();
        let outer = ExternalLoads::new(self.scene, body);
        let inertia = match &self.scene.bodies[body].motion {
            Motion::Driven { inertia, .. } => *inertia,
            _ => None,
        };
        let own = |t: f64| {
            let inertial = inertia.map_or(0.0, |of| {
                let [x, y] = of.centre_of_mass;
                let centre = motion.frame(t).turn([x, y]);
                let weight =
                    of.mass * (centre[0] * self.scene.gravity[1] - centre[1] * self.scene.gravity[0]);
                (of.inertia + of.mass * (x * x + y * y)) * motion.jet(t)[2] - weight
            });
            inertial - outer.moment(t)
        };
        largest_torque(&moments, &self.shown_times(), own)
    }

    fn shown_times(&self) -> Vec<f64> {
        (0..=SHOWN).map(|k| self.scene.life.period * k as f64 / SHOWN as f64).collect()
    }

    /// Energy of the cycle just measured, which was recorded to be shown.
    pub fn energy(&self) -> EnergyBalance {
        together(self.islands.iter().filter_map(|m| m.recorder.shown.as_ref()).map(Shown::balance))
    }

    /// What the cycle just measured shows, which was recorded to be shown.
    pub fn first_seen(&self, with_cycle: bool) -> FirstSeen {
        let period = self.scene.life.period;
        let of = |value: &dyn Fn(&ForceTrack) -> f64| self.shown_joints(|track| value(track));
        let clearance = |name: &str| {
            let has = |m: &Moving| m.island.joints.iter().any(|j| j.name == name);
            self.islands.iter().any(has)
        };
        let mut free_flight = of(&|f| f.free / period);
        free_flight.retain(|(name, _)| clearance(name));
        FirstSeen {
            cycle: with_cycle.then(|| self.shown_cycle()),
            peaks: of(&|f| f.peak()),
            free_flight,
            energy: with_cycle.then(|| self.energy()),
        }
    }

    /// Motion and joint forces of the cycle just measured, which was recorded to be shown.
    pub fn shown_cycle(&self) -> CycleHistory {
        let time = self.shown_times();
        let mut bodies: Vec<BodyTrace> = Vec::new();
        for output in &self.scene.outputs {
            if let OutputKind::AngularVelocityDifference { a, b } | OutputKind::AngleDifference { a, b } =
                &output.kind
            {
                for body in [a, b] {
                    if bodies.iter().any(|t| t.label == body.label) {
                        continue;
                    }
                    let (angle, speed) = self.track(body).resample(&time);
                    bodies.push(BodyTrace {
                        label: body.label.clone(),
                        angle: angle.into_iter().map(|x| x * body.sign).collect(),
                        speed: speed.into_iter().map(|x| x * body.sign).collect(),
                    });
                }
            }
        }
        let joint_force = self.shown_joints(|track| track.resample(&time));
        CycleHistory { bodies, motion: self.motion(&time), joint_force, time }
    }

    /// Motion of every body that moves, in the scene's order.
    fn motion(&self, time: &[f64]) -> Vec<BodyMotion> {
        let mut found: Vec<BodyMotion> = Vec::new();
        for m in &self.islands {
            found.extend(m.recorder.shown.iter().flat_map(|s| s.motion(&m.island, self.scene, time)));
        }
        for body in &self.scene.bodies {
            if let (Motion::Driven { position, .. }, Some(motion)) =
                (&body.motion, Prescribed::from_body(body))
            {
                found.push(BodyMotion {
                    body: body.name.clone(),
                    position: vec![*position; time.len()],
                    angle: time.iter().map(|&t| motion.angle(t)).collect(),
                    speed: time.iter().map(|&t| motion.jet(t)[1]).collect(),
                });
            }
        }
        found.sort_by_key(|motion| self.scene.bodies.iter().position(|b| b.name == motion.body));
        found
    }

    /// A value per joint from its force, which was recorded to be shown, in the scene's order.
    fn shown_joints<T>(&self, value: impl Fn(&ForceTrack) -> T) -> Vec<(String, T)> {
        let mut all: Vec<(usize, T)> = Vec::new();
        for m in &self.islands {
            let contacts = m.island.joints.iter().map(|j| j.scene_joint);
            let joints = contacts.chain(m.island.constraints().iter().map(|c| c.scene_joint));
            let tracks = m.recorder.shown.iter().flat_map(|shown| &shown.forces);
            all.extend(joints.zip(tracks).map(|(joint, track)| (joint, value(track))));
        }
        all.sort_by_key(|(joint, _)| *joint);
        all.into_iter().map(|(joint, value)| (self.scene.joints[joint].name.clone(), value)).collect()
    }
}
