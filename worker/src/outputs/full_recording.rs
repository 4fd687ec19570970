//! Forces of all joints over a cycle: their peaks and free flight, and if the cycle is displayed their histories, the motion of all
//! bodies and the energy.

use super::energy::{EnergyLedger, PowerState};
use super::trace::Piece;
use super::{BodyTrack, ForceTrack};
use crate::integrate::Linearised;
use crate::mechanism::Island;
use common::outputs::{BodyMotion, EnergyBalance};
use common::scene::Scene;

/// Recording of all joints of one island over a cycle.
#[derive(Debug, Clone, Default)]
pub struct FullRecording {
    /// One track per joint: those with clearance, the guides, then the ideal ones.
    pub forces: Vec<ForceTrack>,
    /// Time of the last state [s].
    last: Option<f64>,
    /// Everything else, if the cycle is displayed.
    displayed: Option<DisplayedMotion>,
}

/// Motion and energy of one island over a displayed cycle.
#[derive(Debug, Clone, Default)]
struct DisplayedMotion {
    time: Vec<f64>,
    /// States `(steps, n)`.
    q: Vec<f64>,
    v: Vec<f64>,
    ledger: EnergyLedger,
}

impl FullRecording {
    /// An empty recording for the joints of an island, of a cycle that is `displayed` or not.
    pub(crate) fn new(island: &Island, displayed: bool) -> Self {
        let joints = island.all_joints().count();
        FullRecording {
            forces: vec![ForceTrack::default(); joints],
            last: None,
            displayed: displayed.then(DisplayedMotion::default),
        }
    }

    /// True if states are added at which the island has been set.
    pub(crate) fn is_displayed(&self) -> bool {
        self.displayed.is_some()
    }

    /// Adds an accepted state at time `t` [s], at which the island was last linearised.
    pub(crate) fn push(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        let half = self.last.replace(t).map_or(0.0, |last| 0.5 * (t - last));
        let contacts = at.joints.iter().map(|j| (libm::hypot(j.force[0], j.force[1]), j.normal > 0.0));
        let contacts = contacts.chain(at.guides.iter().map(|guide| (guide.force(), guide.deepest() > 0.0)));
        let ideal = island.ideal_forces(at).map(|force| (force, true));
        for (track, (force, touches)) in self.forces.iter_mut().zip(contacts.chain(ideal)) {
            track.push(force, touches, half);
            if self.displayed.is_some() {
                track.keep(t, force);
            }
        }
        if let Some(motion) = &mut self.displayed {
            motion.time.push(t);
            motion.q.extend_from_slice(q);
            motion.v.extend_from_slice(v);
            motion.ledger.push(t, power_state(island, t, v, at));
        }
    }

    /// Energy balance of the cycle, if it is displayed.
    pub(crate) fn balance(&self) -> Option<EnergyBalance> {
        self.displayed.as_ref().map(|motion| motion.ledger.balance())
    }

    /// Motion of the island's bodies at times `at` [s], increasing and within the cycle; empty unless the cycle is displayed.
    pub(crate) fn motion(&self, island: &Island, scene: &Scene, at: &[f64]) -> Vec<BodyMotion> {
        self.displayed.as_ref().map_or_else(Vec::new, |motion| motion.resample(island, scene, at))
    }
}

impl DisplayedMotion {
    /// Motion of the bodies at these times, see [`FullRecording::motion`].
    fn resample(&self, island: &Island, scene: &Scene, at: &[f64]) -> Vec<BodyMotion> {
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
                    Piece::new(&self.time, &value, [rate[j], rate[j + 1]], j).at(t).0
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
    now.lost += at.friction.iter().map(|[force, speed]| force * speed).sum::<f64>();
    for (k, force) in at.joints.iter().enumerate() {
        let joint = &island.joints[k];
        let energy = joint.contact.energy(joint.surfaces(), &island.joint_motion(k), force);
        now.stored += energy.stored;
        now.lost += energy.friction + energy.damping + energy.film;
        now.unphysical += energy.unphysical;
    }
    for guide in &at.guides {
        now.stored += guide.stored;
        now.lost += guide.lost;
    }
    now
}
