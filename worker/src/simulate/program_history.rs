//! The cycle of a program as it is displayed: forces and relative angles of its joints, and places of their journals, between its instants by
//! straight lines. The motion of bodies, contact arcs and energies are not known.

use crate::outputs::sample_times;
use common::external::{CycleContacts, JointCycle, slopes};
use common::outputs::{BodyTrace, CycleHistory, JournalPath};
use common::scene::Scene;

/// The history of a cycle from the contacts of the joints of these names. Times count from the first instant of any joint.
pub(super) fn cycle_history(scene: &Scene, joints: &[(&String, &JointCycle)]) -> CycleHistory {
    let time = sample_times(scene);
    let start = joints.iter().map(|(_, cycle)| cycle.time[0]).fold(f64::INFINITY, f64::min);
    let mut history = CycleHistory { time, ..CycleHistory::default() };
    for &(name, cycle) in joints {
        // Interval of the instants and share of it, by time.
        let place = |time: &f64| {
            let (of, time) = (&cycle.time, start + time);
            let k = of.partition_point(|at| *at <= time).clamp(1, of.len() - 1) - 1;
            (k, ((time - of[k]) / (of[k + 1] - of[k])).clamp(0.0, 1.0))
        };
        let places: Vec<(usize, f64)> = history.time.iter().map(place).collect();
        let line = |[from, to]: [f64; 2], share: f64| from + share * (to - from);
        let values = |of: &[f64]| -> Vec<f64> {
            places.iter().map(|&(k, share)| line([of[k], of[k + 1]], share)).collect()
        };
        let pairs = |of: &[[f64; 2]]| -> Vec<[f64; 2]> {
            let at = |&(k, share): &(usize, f64)| [0, 1].map(|i| line([of[k][i], of[k + 1][i]], share));
            places.iter().map(at).collect()
        };
        history.joint_force.push((name.clone(), values(&cycle.normal)));
        let (force, angle, eccentricity) = match &cycle.contacts {
            CycleContacts::Bore { force, angle, eccentricity } => (force, angle, eccentricity),
            CycleContacts::Guide { position, .. } => {
                history.slider_position.push((name.clone(), values(position)));
                continue;
            }
        };
        let eccentricity = eccentricity.as_deref().map(pairs).unwrap_or_default();
        history.journals.push(JournalPath { joint: name.clone(), force: pairs(force), eccentricity });
        history.bodies.extend(angle.as_ref().map(|angle| BodyTrace {
            label: name.clone(),
            angle: values(angle),
            speed: values(&slopes(&cycle.time, angle)),
        }));
    }
    history
}
