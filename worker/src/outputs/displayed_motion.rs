//! Motion and joint forces of one island over a displayed cycle, interpolated to its displayed times as the states of the integrator
//! arrive: only the last two of these are held, whatever the number of time steps. Positions lie on the cubic with the positions and velocities
//! of both states, velocities are its slope, whose error is of third order in the step, and forces lie on a straight line.
//!
//! # Source
//! Cubic Hermite interpolation: de Boor, A Practical Guide to Splines (1978), chapter IV.
//!
//! # Energy
//! Energy balance of a cycle: powers integrated over the time steps by the trapezoidal rule.
//!
//! input + unphysical = change of the stored energy + dissipated [J], up to the error of the integration. Stored are the kinetic
//! energy and the potentials of springs, gravity and contacts; unphysical is the work of elastic contact forces without potential.
//!
//! Source:
//! Power theorem of mechanics: Goldstein, Poole, Safko, Classical Mechanics (2002), chapter 1.
//!
//! # Full recording
//! Forces of all joints over a cycle: their peaks and free flight, and if the cycle is displayed their histories, the motion of all
//! bodies and the energy.

use super::ForceTrack;
use super::trace::{Piece, share_of};
use crate::contact::{GuideReaction, JointForce};
use crate::integrate::Linearised;
use crate::mechanism::Island;
use common::outputs::{BodyMotion, EnergyBalance};
use common::scene::Scene;

/// One state of the island.
#[derive(Debug, Clone, Default)]
struct DisplayedState {
    time: f64,
    /// Positions and velocities `(n,)` [m, rad], [m/s, rad/s].
    q: Vec<f64>,
    v: Vec<f64>,
    /// Force magnitude of each joint [N], then the moment on each prescribed body [N m] `(joints + prescribed,)`.
    force: Vec<f64>,
    powers: Powers,
}

/// Motion, joint forces and energy of one island over a displayed cycle.
#[derive(Debug, Clone, Default)]
pub struct DisplayedMotion {
    /// Displayed times, increasing [s].
    at: Vec<f64>,
    /// The last state and the one before it.
    last: DisplayedState,
    before: DisplayedState,
    /// Number of states so far.
    states: usize,
    /// Positions `(shown, n)` [m, rad], velocities `(shown, n)` [m/s, rad/s], and forces and moments
    /// `(shown, joints + prescribed)` [N, N m] at the first displayed times.
    q: Vec<f64>,
    v: Vec<f64>,
    force: Vec<f64>,
    /// Energy balance so far.
    pub balance: EnergyBalance,
}

impl DisplayedMotion {
    /// Without states, to be displayed `at` these times [s].
    pub(super) fn new(at: Vec<f64>) -> Self {
        DisplayedMotion { at, ..DisplayedMotion::default() }
    }

    /// Adds the state `q`, `v` `(n,)` at `time` [s] with the `forces` of the joints [N], then the moments on the prescribed bodies [N m], and
    /// the powers of the island.
    pub(super) fn push(
        &mut self,
        time: f64,
        [q, v]: [&[f64]; 2],
        forces: impl Iterator<Item = f64>,
        powers: Powers,
    ) {
        std::mem::swap(&mut self.before, &mut self.last);
        let DisplayedState { time: last, q: last_q, v: last_v, force, powers: last_powers } = &mut self.last;
        (*last, *last_powers) = (time, powers);
        for (to, from) in [(last_q, q), (last_v, v)] {
            to.clear();
            to.extend_from_slice(from);
        }
        force.clear();
        force.extend(forces);
        self.states += 1;
        if self.states > 1 {
            self.add_step();
        }
        self.interpolate(time);
    }

    /// Adds the step between the last two states to the balance, by the trapezoidal rule.
    fn add_step(&mut self) {
        let (from, to) = (&self.before, &self.last);
        let half = 0.5 * (to.time - from.time);
        let [input, lost, unphysical, gross] = [1, 2, 3, 4].map(|k| half * (from.powers[k] + to.powers[k]));
        let stored = to.powers[0] - from.powers[0];
        self.balance.input += input;
        self.balance.dissipated += lost;
        self.balance.unphysical += unphysical;
        self.balance.stored += stored;
        self.balance.turnover += gross + lost.abs() + unphysical.abs() + stored.abs();
    }

    /// Adds the displayed times after the last state, which rounding alone can leave.
    pub(super) fn finish(&mut self) {
        self.interpolate(f64::INFINITY);
    }

    /// Adds the displayed times up to `end` [s], from the last two states.
    fn interpolate(&mut self, end: f64) {
        let DisplayedMotion { at, last, before, states, q, v, force, .. } = self;
        let n = last.q.len();
        if *states < 2 || n == 0 {
            return;
        }
        let time = [before.time, last.time];
        for &t in at[q.len() / n..].iter().take_while(|t| **t <= end) {
            let share = share_of(time, t);
            let along = |from: f64, to: f64| from + share * (to - from);
            for k in 0..n {
                let value = [before.q[k], last.q[k]];
                let (position, velocity) = Piece::new(&time, &value, [before.v[k], last.v[k]], 0).at(t);
                q.push(position);
                v.push(velocity);
            }
            force.extend(before.force.iter().zip(&last.force).map(|(from, to)| along(*from, *to)));
        }
    }

    /// Force magnitude of a joint at the displayed times [N]; with the prescribed bodies counted after the joints, the moment on one [N m].
    pub(crate) fn force(&self, joint: usize) -> Vec<f64> {
        column(&self.force, joint, self.last.force.len()).collect()
    }

    /// Motion of the island's bodies at the displayed times.
    pub(crate) fn bodies(&self, island: &Island, scene: &Scene) -> Vec<BodyMotion> {
        let n = island.coordinates();
        let motion = |(slot, &body): (usize, &usize)| {
            let centre = scene.bodies[body].motion.base_point();
            let [x, y, angle] = [0, 1, 2].map(|k| column(&self.q, 3 * slot + k, n));
            let angle: Vec<f64> = angle.collect();
            // From the centre of mass back to the body's own origin.
            let position = x.zip(y).zip(&angle).map(|((x, y), angle)| {
                let (s, c) = libm::sincos(*angle);
                [x - c * centre[0] + s * centre[1], y - s * centre[0] - c * centre[1]]
            });
            BodyMotion {
                body: scene.bodies[body].name.clone(),
                position: position.collect(),
                speed: column(&self.v, 3 * slot + 2, n).collect(),
                angle,
            }
        };
        island.bodies.iter().enumerate().map(motion).collect()
    }
}

/// Column `k` of `rows` of the length `n`.
fn column(rows: &[f64], k: usize, n: usize) -> impl Iterator<Item = f64> {
    rows.iter().skip(k).step_by(n.max(1)).copied()
}

/// At one instant the energy of an island, kinetic and of springs, gravity and contacts [J], and the powers of drives and of loads without
/// potential, lost, and of elastic contact forces that no potential accounts for, and the sum of the sizes of the powers of drives and loads [W].
type Powers = [f64; 5];

/// Sum of the balances of several islands.
pub(crate) fn sum_of_islands(balances: impl Iterator<Item = EnergyBalance>) -> EnergyBalance {
    balances.fold(EnergyBalance::default(), |a, b| EnergyBalance {
        input: a.input + b.input,
        stored: a.stored + b.stored,
        dissipated: a.dissipated + b.dissipated,
        unphysical: a.unphysical + b.unphysical,
        turnover: a.turnover + b.turnover,
    })
}

/// Recording of all joints of one island over a cycle.
#[derive(Debug, Clone, Default)]
pub struct FullRecording {
    /// One track per joint: those with clearance, the guides, then the ideal ones.
    pub forces: Vec<ForceTrack>,
    /// Time of the last state [s].
    last: Option<f64>,
    /// Everything else, if the cycle is displayed.
    pub displayed: Option<DisplayedMotion>,
}

impl FullRecording {
    /// An empty recording for the joints of an island, of a cycle that is displayed at the times `shown` [s] or not at all.
    pub(crate) fn new(island: &Island, shown: Option<Vec<f64>>) -> Self {
        let joints = island.all_joints().count();
        FullRecording {
            forces: vec![ForceTrack::default(); joints],
            last: None,
            displayed: shown.map(DisplayedMotion::new),
        }
    }

    /// Adds an accepted state at time `t` [s], at which the island was last linearised.
    pub(crate) fn push(&mut self, island: &Island, t: f64, q: &[f64], v: &[f64], at: &Linearised) {
        let half = self.last.replace(t).map_or(0.0, |last| 0.5 * (t - last));
        let joint = |j: &JointForce| (libm::hypot(j.force[0], j.force[1]), j.normal > 0.0);
        let guide = |guide: &GuideReaction| (guide.force(), guide.deepest() > 0.0);
        let forces = || {
            let contacts = at.joints.iter().map(joint).chain(at.guides.iter().map(guide));
            contacts.chain(island.ideal_forces(at).map(|force| (force, true)))
        };
        for (track, (force, touches)) in self.forces.iter_mut().zip(forces()) {
            track.push(force.abs(), touches, half);
        }
        if let Some(motion) = &mut self.displayed {
            let moments = at.prescribed.iter().map(|force| force[2]);
            let forces = forces().map(|(force, _)| force).chain(moments);
            motion.push(t, [q, v], forces, powers(island, t, v, at));
        }
    }

    /// Closes the recording at the end of the cycle.
    pub(crate) fn finish(&mut self) {
        self.displayed.iter_mut().for_each(DisplayedMotion::finish);
    }
}

/// Energies and powers of an island at the state it was last linearised at.
fn powers(island: &Island, t: f64, v: &[f64], at: &Linearised) -> Powers {
    let [mut stored, mut lost, driving] = island.load_power(t, v);
    let drives: f64 = at.prescribed.iter().zip(&island.jets).map(|(f, jet)| -f[2] * jet[1]).sum();
    let strokes = island.ideal.driving_power(&at.lambda);
    let (input, gross) = (drives + strokes + driving, drives.abs() + strokes.abs() + driving.abs());
    let mut unphysical = 0.0;
    lost += at.friction.iter().map(|[force, speed]| force * speed).sum::<f64>();
    for (k, force) in at.joints.iter().enumerate() {
        let joint = &island.joints[k];
        let energy = joint.contact.energy(joint.surfaces(), &island.joint_motion(k), force);
        stored += energy.stored;
        lost += energy.friction + energy.damping + energy.film;
        unphysical += energy.unphysical;
    }
    for guide in &at.guides {
        stored += guide.stored;
        lost += guide.lost;
    }
    [stored, input, lost, unphysical, gross]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_between_two_states_are_interpolated_and_the_last_ones_reached() {
        let at: Vec<f64> = (0..=8).map(|k| 0.125 * f64::from(k)).collect();
        let mut shown = DisplayedMotion::new(at.clone());
        // A cubic, and a force that changes evenly; the last state falls short of the end by rounding.
        let (x, speed) = (|t: f64| t * t * (t - 1.0), |t: f64| t * (3.0 * t - 2.0));
        for t in [0.0, 0.0625, 0.4, 0.75, 1.0 - 1e-14] {
            shown.push(t, [&[x(t)], &[speed(t)]], [3.0 * t].into_iter(), [0.0; 5]);
        }
        assert_eq!(shown.q.len(), 8);
        shown.finish();
        assert_eq!(shown.q.len(), at.len());
        for (((q, v), force), t) in shown.q.iter().zip(&shown.v).zip(shown.force(0)).zip(&at) {
            assert!((q - x(*t)).abs() < 1e-12 && (force - 3.0 * t).abs() < 1e-12, "{t}: {q} {force}");
            assert!((v - speed(*t)).abs() < 1e-12, "{t}: {v}");
        }
    }
}
