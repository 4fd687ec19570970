//! Everything of a cycle that is displayed: forces of all joints, motion of all bodies, energy.

use super::energy::{EnergyLedger, PowerState};
use super::trace::cubic;
use super::{BodyTrack, ForceTrack};
use crate::integrate::Linearised;
use crate::mechanism::Island;
use common::outputs::{BodyMotion, EnergyBalance};
use common::scene::Scene;

/// Recording of everything of one island over a cycle.
#[derive(Debug, Clone, Default)]
pub struct FullRecording {
    /// One track per joint: those with clearance, then the ideal ones.
    pub forces: Vec<ForceTrack>,
    time: Vec<f64>,
    /// States `(steps, n)`.
    q: Vec<f64>,
    v: Vec<f64>,
    ledger: EnergyLedger,
}

impl FullRecording {
    /// An empty recording for the joints of an island.
    pub(crate) fn new(island: &Island) -> Self {
        let joints = island.joints.len() + island.constraints().len();
        FullRecording { forces: vec![ForceTrack::default(); joints], ..FullRecording::default() }
    }

    /// Adds an accepted state at time `t` [s], at which the island was last linearised.
    pub(crate) fn push(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        let half = self.time.last().map_or(0.0, |last| 0.5 * (t - last));
        let contacts = at.joints.iter().map(|j| (libm::hypot(j.force[0], j.force[1]), j.normal > 0.0));
        let ideal = island.ideal_forces(at).map(|force| (force, true));
        for (track, (force, touches)) in self.forces.iter_mut().zip(contacts.chain(ideal)) {
            track.push(t, force, touches, half);
        }
        self.time.push(t);
        self.q.extend_from_slice(q);
        self.v.extend_from_slice(v);
        self.ledger.push(t, power_state(island, t, v, at));
    }

    /// Energy balance of the cycle.
    pub(crate) fn balance(&self) -> EnergyBalance {
        self.ledger.balance()
    }

    /// Motion of the island's bodies at times `at` [s], increasing and within the cycle.
    pub(crate) fn motion(&self, island: &Island, scene: &Scene, at: &[f64]) -> Vec<BodyMotion> {
        let n = island.coordinates();
        let column =
            |states: &[f64], k: usize| -> Vec<f64> { states.iter().skip(k).step_by(n).copied().collect() };
        let along = |k: usize| -> Vec<f64> {
            let (value, rate) = (column(&self.q, k), column(&self.v, k));
            let mut j = 0;
            at.iter()
                .map(|&t| {
                    while j + 2 < self.time.len() && self.time[j + 1] < t {
                        j += 1;
                    }
                    cubic(&self.time, &value, [rate[j], rate[j + 1]], j, t).0
                })
                .collect()
        };
        let motion = |(slot, &body): (usize, &usize)| {
            let centre = scene.bodies[body].motion.base_point();
            let [x, y, angle] = [0, 1, 2].map(|k| along(3 * slot + k));
            // From the centre of mass back to the body's own origin.
            let position = x.iter().zip(&y).zip(&angle).map(|((x, y), angle)| {
                let (s, c) = libm::sincos(*angle);
                [x - c * centre[0] + s * centre[1], y - s * centre[0] - c * centre[1]]
            });
            let track = BodyTrack {
                time: self.time.clone(),
                omega: column(&self.v, 3 * slot + 2),
                ..BodyTrack::default()
            };
            BodyMotion {
                body: scene.bodies[body].name.clone(),
                position: position.collect(),
                speed: track.speed_at(at),
                angle,
            }
        };
        island.bodies.iter().enumerate().map(motion).collect()
    }
}

/// Energies and powers of an island at the state it was last linearised at.
fn power_state(island: &Island, t: f64, v: &[f64], at: &Linearised) -> PowerState {
    let loads = island.load_power(t, v);
    let drives: f64 =
        at.prescribed.iter().zip(island.prescribed_speeds()).map(|(f, omega)| -f[2] * omega).sum();
    let mut now =
        PowerState { stored: loads.stored, input: drives + loads.driving, lost: loads.lost, unphysical: 0.0 };
    for (k, force) in at.joints.iter().enumerate() {
        let joint = &island.joints[k];
        let energy = joint.contact.energy(&joint.profile, &island.joint_motion(k), force);
        now.stored += energy.stored;
        now.lost += energy.friction + energy.damping + energy.film;
        now.unphysical += energy.unphysical;
    }
    now
}
