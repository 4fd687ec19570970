//! Largest accelerations, and impacts, of one island over a cycle and over its part after the start: what [`super::Recorder`] keeps of every
//! state without a history.
//!
//! # Accelerations
//! At the end of every time step the forces on the body give the acceleration of its centre of mass a [m/s^2] and its angular
//! acceleration alpha [rad/s^2]; a point at the distance r [m] from that centre, turned with the body, has
//!
//!   a_P = a + alpha x r - omega^2 r.
//!
//! The outputs are the largest |a_P| and the largest |alpha|. They contain the vibrations of the contacts: where the time steps pass
//! over these, two step lengths give different values, and the stated error is large.
//!
//! Source:
//! Acceleration of a point of a rigid body: Goldstein, Poole, Safko, Classical Mechanics (2002), chapter 4.
//!
//! # Impacts
//! An impact is the beginning of a contact after free flight: the penetration delta [m] is positive at the end of a time step and was
//! not at the end of the step before. Its energy [J] is the kinetic energy of the approach,
//!
//!   E = m_eff v_n^2 / 2,
//!
//! with the speed of approach v_n [m/s] along the contact's normal at the end of free flight, and the mass m_eff [kg] with which the
//! mechanism resists an impulse along that normal (`Island::effective_mass`). It is what a plastic impact without friction dissipates;
//! with a coefficient of restitution e, (1 - e^2) E is lost. Contacts that last through the cycle have no impacts.
//!
//! In a guide with clearance every corner of the slider that begins to touch is an impact, with its own speed of approach and effective mass
//! (`effective_mass.rs`); both corners of a face within one time step are one impact, with the means of both.
//!
//! Source:
//! Lankarani, Nikravesh (1990), A contact force model with hysteresis damping for impact analysis of multibody systems, Journal of
//! Mechanical Design 112, 369-376: energy of the approach and loss (1 - e^2). Transition from free flight to contact: Flores, Ambrosio,
//! Claro, Lankarani (2008), Kinematics and Dynamics of Multibody Systems with Imperfect Joints, chapter 3.

use crate::contact::PADS;
use crate::integrate::{Dynamics, Linearised};
use crate::mechanism::{End, Frame, Island, TimedState};
use crate::plane::length;
use common::scene::{Attachment, OutputKind, Scene};

/// Impacts of one joint over a cycle so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ImpactCount {
    /// Number of impacts [1].
    pub number: u32,
    /// Sum of their energies [J].
    pub energy: f64,
    /// Energy of the hardest one [J].
    pub hardest: f64,
}

/// Largest value over a cycle, and over its part after the start.
pub(super) type Largest = [f64; 2];

/// Adds a value at an instant that is `later` than the start.
#[inline(always)]
pub(super) fn push_largest([whole, after]: &mut Largest, value: f64, later: bool) {
    *whole = whole.max(value);
    if later {
        *after = after.max(value);
    }
}

/// Peaks of the requested accelerations, and the impacts of the joints with clearance and the guides if they are requested.
#[derive(Debug, Clone, Default)]
pub struct Peaks {
    /// Requested points with their place on the island, and their largest acceleration so far [m/s^2].
    accelerations: Vec<(Attachment, End, Largest)>,
    /// Requested bodies of the scene, their index in the island, and their largest angular acceleration so far [rad/s^2].
    angular: Vec<(usize, usize, Largest)>,
    /// Impacts of the joints with clearance and of the guides.
    impacts: Option<ImpactRecording>,
}

/// Impacts of every joint with clearance, then of every guide.
#[derive(Debug, Clone, Default)]
struct ImpactRecording {
    /// Impacts so far, of the whole cycle and after its start `(joints + guides, 2)`.
    counts: Vec<[ImpactCount; 2]>,
    /// Velocity of the journal's centre against the bushing's in the bushing's frame at the last state, if that was one of free flight
    /// `(joints,)` [m/s].
    flight: Vec<Option<[f64; 2]>>,
    /// Speed at which each corner of a slider approached its guide at the last state, if that was one of free flight `(guides, 4)` [m/s].
    corners: Vec<[Option<f64>; PADS]>,
}

impl Peaks {
    /// Peaks of what is `requested` of an island.
    pub(crate) fn new(island: &Island, scene: &Scene, requested: &RecordingRequest) -> Self {
        let slot = |body: usize| island.bodies.iter().position(|&b| b == body);
        let point = |place: &Attachment| {
            let end = End { frame: slot(place.body)?, arm: scene.arm(place) };
            Some((*place, end, Largest::default()))
        };
        let angular = |&body: &usize| Some((body, slot(body)?, Largest::default()));
        let (joints, guides) = (island.joints.len(), island.guides.len());
        Peaks {
            accelerations: requested.accelerations.iter().filter_map(point).collect(),
            angular: requested.angular_accelerations.iter().filter_map(angular).collect(),
            impacts: requested.impacts.then(|| ImpactRecording {
                counts: vec![[ImpactCount::default(); 2]; joints + guides],
                flight: vec![None; joints],
                corners: vec![[None; PADS]; guides],
            }),
        }
    }

    /// Removes the recording, for a new cycle.
    pub(crate) fn clear(&mut self) {
        self.accelerations.iter_mut().for_each(|(.., peak)| *peak = [0.0; 2]);
        self.angular.iter_mut().for_each(|(.., peak)| *peak = [0.0; 2]);
        if let Some(impacts) = &mut self.impacts {
            impacts.counts.fill([ImpactCount::default(); 2]);
            impacts.flight.fill(None);
            impacts.corners.fill([None; PADS]);
        }
    }

    /// True if anything is kept.
    pub(crate) fn any(&self) -> bool {
        self.impacts.is_some() || !self.accelerations.is_empty() || !self.angular.is_empty()
    }

    /// True if [`Self::push`] reads the forces of the joints.
    pub(crate) fn needs_joint_forces(&self) -> bool {
        self.impacts.is_some()
    }

    /// Leaves what comes after the start of the cycle.
    pub(super) fn drop_start(&mut self) {
        self.accelerations.iter_mut().for_each(|(.., peak)| peak[0] = peak[1]);
        self.angular.iter_mut().for_each(|(.., peak)| peak[0] = peak[1]);
        if let Some(impacts) = &mut self.impacts {
            impacts.counts.iter_mut().for_each(|[whole, later]| *whole = *later);
        }
    }

    /// Adds the accepted state `now`, which is `later` than the start of the cycle.
    pub(crate) fn push(&mut self, island: &Island, now: TimedState, later: bool, at: &Linearised) {
        let (_, q, v) = now;
        let acceleration = |k: usize| at.f[k] / island.mass()[k];
        for (_, End { frame, arm }, peak) in &mut self.accelerations {
            let k = 3 * *frame;
            let body = Frame::free(&q[k..k + 3], &v[k..k + 3]);
            let [rx, ry] = body.turn(*arm);
            let (alpha, turning) = (acceleration(k + 2), body.omega * body.omega);
            let ax = acceleration(k) - alpha * ry - turning * rx;
            let ay = acceleration(k + 1) + alpha * rx - turning * ry;
            push_largest(peak, libm::hypot(ax, ay), later);
        }
        for (_, slot, peak) in &mut self.angular {
            push_largest(peak, acceleration(3 * *slot + 2).abs(), later);
        }
        if let Some(impacts) = &mut self.impacts {
            impacts.push(island, now, later, at);
        }
    }

    /// Largest acceleration of a point, if it is on this island and requested [m/s^2].
    pub(crate) fn acceleration(&self, at: &Attachment) -> Option<f64> {
        self.accelerations.iter().find(|(place, ..)| place == at).map(|(.., peak)| peak[0])
    }

    /// Largest angular acceleration of a body of the scene, if it is in this island and requested [rad/s^2].
    pub(crate) fn angular_acceleration(&self, body: usize) -> Option<f64> {
        self.angular.iter().find(|(of, ..)| *of == body).map(|(.., peak)| peak[0])
    }

    /// Impacts of a joint of the scene, if it is in this island and they are requested.
    pub(crate) fn impacts(&self, island: &Island, joint: usize) -> Option<ImpactCount> {
        let place = island.contacts().position(|scene_joint| scene_joint == joint)?;
        self.impacts.as_ref().map(|impacts| impacts.counts[place][0])
    }
}

impl ImpactRecording {
    fn push(&mut self, island: &Island, now: TimedState, later: bool, at: &Linearised) {
        for (joint, force) in at.joints.iter().enumerate() {
            let touches = force.penetration > 0.0;
            let flight = self.flight[joint].take();
            if !touches {
                self.flight[joint] = Some(island.relative_velocity(joint, now));
            } else if let Some(before) = flight {
                // The direction of the contact, or before any force acts that of the eccentricity.
                let pressed = length(force.direction) > 0.0;
                let direction = if pressed { force.direction } else { unit(at.e[joint]) };
                let speed = before[0] * direction[0] + before[1] * direction[1];
                let mass = island.effective_mass(joint, direction, now);
                add(&mut self.counts[joint], 0.5 * mass * speed * speed, later);
            }
        }
        for guide in 0..island.guides.len() {
            let corners = island.guide_corners(guide, now);
            let flights = &mut self.corners[guide];
            let faces = corners.chunks(PADS / 2).zip(flights.chunks_mut(PADS / 2));
            for (corners, flights) in faces {
                // Both corners of a face that strike within a step are one impact, of its middle.
                let (mut struck, mut approach, mut gradient) = (0.0, 0.0, [0.0; 6]);
                for ((overlap, rate, slope), flight) in corners.iter().zip(flights) {
                    if *overlap <= 0.0 {
                        *flight = Some(*rate);
                    } else if let Some(speed) = flight.take() {
                        struck += 1.0;
                        approach += speed;
                        gradient.iter_mut().zip(slope).for_each(|(sum, part)| *sum += part);
                    }
                }
                if struck > 0.0 {
                    let (speed, along) = (approach / struck, gradient.map(|sum| sum / struck));
                    let mass = island.guide_mass(guide, along, now);
                    let counts = &mut self.counts[island.joints.len() + guide];
                    add(counts, 0.5 * mass * speed * speed, later);
                }
            }
        }
    }
}

/// Adds an impact of this energy [J] to the counts of the whole cycle and, if it is `later`, to that after its start.
fn add(counts: &mut [ImpactCount; 2], energy: f64, later: bool) {
    for count in &mut counts[..if later { 2 } else { 1 }] {
        count.number += 1;
        count.energy += energy;
        count.hardest = count.hardest.max(energy);
    }
}

/// A vector over its length; zero if it is zero.
fn unit(x: [f64; 2]) -> [f64; 2] {
    let size = length(x);
    if size > 0.0 { x.map(|x| x / size) } else { x }
}

/// Quantities to record over every measured cycle.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RecordingRequest {
    /// Bodies of the scene whose angle and angular velocity are recorded.
    pub bodies: Vec<usize>,
    /// Points whose path is recorded.
    pub points: Vec<Attachment>,
    /// Points whose path on the mechanism with ideal joints is needed.
    pub ideal_points: Vec<Attachment>,
    /// Bodies of the scene whose angle on the mechanism with ideal joints is needed.
    pub ideal_bodies: Vec<usize>,
    /// Points whose largest acceleration is recorded.
    pub accelerations: Vec<Attachment>,
    /// Bodies of the scene whose largest angular acceleration is recorded.
    pub angular_accelerations: Vec<usize>,
    /// Driven bodies of the scene on which the moment of joints and loads is recorded.
    pub driven: Vec<usize>,
    /// Outputs that are a backlash, for which the influence of the joints is needed, in the mechanism with ideal joints.
    pub backlashes: Vec<OutputKind>,
    /// True if the largest force of every joint is recorded.
    pub peak_forces: bool,
    /// True if the impacts of every joint with clearance are recorded.
    pub impacts: bool,
}

impl RecordingRequest {
    /// True if the motion of the mechanism with ideal joints is needed.
    pub(crate) fn needs_ideal_motion(&self) -> bool {
        !(self.ideal_points.is_empty() && self.ideal_bodies.is_empty() && self.backlashes.is_empty())
    }
}
