//! Derivatives of the generalised forces, of one pair of bodies and of whole islands, against central
//! differences.

use crate::bore::Profile;
use crate::contact::{Contact, JointForce, Journal, LawLanes, Surfaces};
use crate::integrate::{Dynamics, StepControl, StepCounts, Stepped, Stepper};
use crate::mechanism::joint::{Blocks, PairMotion, PairSlopes, pair_force};
use crate::mechanism::{End, Frame, Island, WearingPair, ideal_cycle, islands};
use common::scene::*;
use std::f64::consts::TAU;

fn flapping_wing(law: ContactLaw) -> Scene {
    let mut scene = SceneSource::builtin("flapping-wing").expect("it is built in").nominal().clone();
    for joint in &mut scene.joints {
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            clearance.contact_law = law;
        }
    }
    scene
}

fn clearance(scene: &Scene) -> &Clearance {
    match &scene.joints[0].kind {
        JointKind::Clearance(clearance) => clearance,
        _ => panic!("the scene has clearance joints only"),
    }
}

fn worn_depth() -> Vec<f64> {
    (0..36).map(|i| 6e-6 * (1.0 + (TAU * f64::from(i) / 36.0 - 1.0).cos())).collect()
}

/// Largest difference between a matrix and its differences, each relative to the largest entry of its row
/// among the columns of the same unit (lengths, angles), or to a share of the largest of the whole matrix:
/// coordinates that ideal joints determine have rows of rounding alone.
fn worst(rows: usize, exact: impl Fn(usize, usize) -> f64, columns_found: &[Vec<f64>]) -> f64 {
    let columns = columns_found.len();
    let difference = |r: usize, c: usize| columns_found[c][r];
    let entries = (0..rows).flat_map(|r| (0..columns).map(move |c| (r, c)));
    let floor = 1e-4 * entries.fold(0.0_f64, |a, (r, c)| a.max(exact(r, c).abs()));
    let mut worst: f64 = 0.0;
    for r in 0..rows {
        for keep in [[true, true, false], [false, false, true]] {
            let same: Vec<usize> = (0..columns).filter(|c| keep[c % 3]).collect();
            let scale = same.iter().fold(floor, |a, &c| a.max(exact(r, c).abs()));
            for &c in &same {
                let off = (exact(r, c) - difference(r, c)).abs();
                worst = worst.max(off / scale);
            }
        }
    }
    worst
}

const ARM_I: [f64; 2] = [0.012, -0.004];
const ARM_J: [f64; 2] = [-0.02, 0.007];

/// A joint by itself.
struct Alone {
    contact: Contact,
    profile: Profile,
    journal: Option<Journal>,
}

impl Alone {
    /// Generalised forces on bodies in these frames.
    fn pair_force<const JACOBIAN: bool>(
        &self,
        i: &Frame,
        j: &Frame,
    ) -> ([f64; 6], JointForce, PairSlopes<f64>) {
        let surfaces = Surfaces { bore: &self.profile, journal: self.journal.as_ref() };
        let law = LawLanes::new(&self.contact, surfaces, 0.0);
        let ends = [End { frame: 0, arm: ARM_I }, End { frame: 1, arm: ARM_J }];
        let pair = PairMotion::new(ends, i, j);
        pair_force::<f64, JACOBIAN>(&law, &pair, &law.walls(&pair.place, pair.motion.turn), i, j)
    }
}

#[test]
fn pair_derivatives_agree_with_differences() {
    for (law, wears) in ContactLaw::ALL.into_iter().flat_map(|law| [false, true].map(|wears| (law, wears))) {
        let scene = flapping_wing(law);
        let clearance = clearance(&scene);
        let mut profile = Profile::round(clearance.bushing_radius, 36);
        profile.set_depth(&worn_depth());
        let mut contact = Contact::new(clearance);
        contact.profile_changed(&profile);
        let journal = wears.then(|| {
            let mut journal = contact.new_journal(36);
            journal.set_depth(&worn_depth().into_iter().rev().collect::<Vec<_>>());
            journal
        });
        let joint = Alone { contact, profile, journal };
        let force = |q: &[f64; 6], v: &[f64; 6]| {
            let (i, j) = (Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..]));
            joint.pair_force::<false>(&i, &j).0
        };
        for k in 0..12 {
            // The journal's centre at a chosen eccentricity in the bushing's frame.
            let x = f64::from(k);
            let psi = 0.2 + TAU * x / 12.0;
            let bushing = [0.003, -0.002, 0.7 * x];
            let angle = 1.0 - 0.4 * x;
            let radius = joint
                .journal
                .as_ref()
                .map_or(clearance.journal_radius, |journal| journal.radius_at(psi - (angle - bushing[2])).r);
            let reach = joint.profile.radius_at(psi).r - radius + 1e-7 * (1.0 + x % 4.0);
            let j = Frame::free(&bushing, &[0.0; 3]);
            let centre = j.point([ARM_J[0] + reach * psi.cos(), ARM_J[1] + reach * psi.sin()]);
            let arm = Frame::free(&[0.0, 0.0, angle], &[0.0; 3]).turn(ARM_I);
            let q = [centre[0] - arm[0], centre[1] - arm[1], angle, bushing[0], bushing[1], bushing[2]];
            // Turning together about the bushing's centre, but for a few millimetres per second.
            let (omega, aj) = (3.0 * (x + 1.0).sin(), j.turn(ARM_J));
            let (vi, vj) = ([-omega * arm[1], omega * arm[0]], [-omega * aj[1], omega * aj[0]]);
            let slip = 2.0 * (1.3 * x).cos();
            let v = [
                2e-3 - vi[0] - slip * -arm[1],
                -1e-3 - vi[1] - slip * arm[0],
                omega + slip,
                -vj[0],
                -vj[1],
                omega,
            ];
            let exact = {
                let (i, j) = (Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..]));
                joint.pair_force::<true>(&i, &j)
            };
            assert!(exact.1.normal > 0.0);
            let differences = |step: [f64; 2], of_rates: bool| -> Vec<Vec<f64>> {
                (0..6)
                    .map(|c| {
                        let h = step[usize::from(c % 3 == 2)];
                        let (mut a, mut b) = ([q, v], [q, v]);
                        a[usize::from(of_rates)][c] += h;
                        b[usize::from(of_rates)][c] -= h;
                        let (f, g) = (force(&a[0], &a[1]), force(&b[0], &b[1]));
                        f.iter().zip(g).map(|(f, g)| (f - g) / (2.0 * h)).collect()
                    })
                    .collect()
            };
            let blocks = [
                [exact.2.block::<0, 0>(), exact.2.block::<0, 1>()],
                [exact.2.block::<1, 0>(), exact.2.block::<1, 1>()],
            ];
            let entry = |rates: usize, r: usize, c: usize| blocks[r / 3][c / 3][rates][r % 3][c % 3];
            let k_off = worst(6, |r, c| entry(0, r, c), &differences([2e-10, 2e-8], false));
            let d_off = worst(6, |r, c| entry(1, r, c), &differences([1e-7, 1e-5], true));
            assert!(k_off < 2e-5 && d_off < 2e-5, "{law:?}, {wears}, at {psi}: {k_off} {d_off}");
        }
    }
}

/// An island of the flapping-wing with worn bores, at a few times of a cycle when all its joints are in
/// contact.
pub(super) fn states(scene: &Scene, island: &mut Island) -> Vec<(f64, Vec<f64>, Vec<f64>)> {
    for joint in &mut island.joints {
        let depth = worn_depth().into_iter().cycle().take(joint.depths());
        joint.set_depth(&depth.collect::<Vec<_>>());
    }
    let pose = ideal_cycle(scene, 2, &mut 0).expect("the linkage closes").swap_remove(0);
    let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
        island.bodies.iter().flat_map(|&b| from[b].expect("free")).collect()
    };
    let (mut q, mut v) = (pick(&pose.q), pick(&pose.v));
    let period = scene.life.period;
    let control = StepControl::new(1e-2, period / 250.0, period * 1e-9, 100_000);
    let mut stepper = Stepper::new(island.linearised(), control);
    let mut t = 0.0;
    [0.37, 0.55, 0.8]
        .iter()
        .map(|share| {
            let end = share * period;
            let mut counts = StepCounts::default();
            stepper.run(island, t..end, &mut q, &mut v, &mut (), &mut counts).expect("integrated");
            t = end;
            (t, q.clone(), v.clone())
        })
        .collect()
}

/// Derivatives of the whole island at a state against central differences, with steps for lengths, angles,
/// their rates and time; each within `bound` of the largest of its row (column, for time).
pub(super) fn check(
    island: &Island,
    (t, q, v): &(f64, Vec<f64>, Vec<f64>),
    steps: [f64; 5],
    bound: f64,
    case: &str,
) {
    let n = island.coordinates();
    let mut at = island.linearised();
    island.clone().linearise(*t, q, v, &mut at);
    // Nothing of an earlier linearisation is left.
    let mut again = at.clone();
    [&mut again.k, &mut again.d].into_iter().for_each(|entries| entries.fill(f64::NAN));
    island.clone().linearise(*t, q, v, &mut again);
    assert_eq!((&again.k, &again.d), (&at.k, &at.d));
    let force = |t: f64, q: &[f64], v: &[f64]| {
        let mut f = vec![0.0; n];
        island.clone().force(t, q, v, &mut f);
        f
    };
    assert_eq!(force(*t, q, v), at.f);
    let column = |c: usize, of_rates: bool| -> Vec<f64> {
        let h = steps[2 * usize::from(of_rates) + usize::from(c % 3 == 2)];
        let shifted = |h: f64| {
            let mut state = [q.clone(), v.clone()];
            state[usize::from(of_rates)][c] += h;
            force(*t, &state[0], &state[1])
        };
        shifted(h).iter().zip(shifted(-h)).map(|(f, g)| (f - g) / (2.0 * h)).collect()
    };
    let k: Vec<_> = (0..n).map(|c| column(c, false)).collect();
    let d: Vec<_> = (0..n).map(|c| column(c, true)).collect();
    let k_off = worst(n, |r, c| at.k[r * n + c], &k);
    let d_off = worst(n, |r, c| at.d[r * n + c], &d);
    assert!(k_off < bound && d_off < bound, "{case} at {t}: {k_off} {d_off}");
    let h = steps[4];
    let (after, before) = (force(t + h, q, v), force(t - h, q, v));
    let scale = at.ft.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(scale > 0.0, "a driven body moves a joint");
    for i in 0..n {
        let off = ((after[i] - before[i]) / (2.0 * h) - at.ft[i]).abs() / scale;
        assert!(off < bound, "{case} at {t}, row {i}: {off}");
    }
}

#[test]
fn island_derivatives_agree_with_differences() {
    let both = |law| {
        let mut scene = flapping_wing(law);
        for joint in &mut scene.joints {
            if let JointKind::Clearance(clearance) = &mut joint.kind {
                clearance.wears = WearingSurfaces::Both;
            }
        }
        scene
    };
    for (law, scene) in
        ContactLaw::ALL.into_iter().flat_map(|law| [(law, flapping_wing(law)), (law, both(law))])
    {
        for mut island in islands(&scene).expect("all joints have clearance") {
            for state in states(&scene, &mut island) {
                let mut at = island.linearised();
                island.clone().linearise(state.0, &state.1, &state.2, &mut at);
                assert!(at.joints.iter().all(|j| j.normal > 0.0), "a joint is in free flight");
                check(&island, &state, [2e-10, 1e-8, 1e-7, 1e-5, 5e-10], 3e-5, &format!("{law:?}"));
            }
        }
    }
}

fn at(body: usize, position: [f64; 2]) -> Attachment {
    Attachment { body, position }
}

/// A crank of varying speed, a rod, a slider on an inclined line, an arm hinged to the slider, a weight fixed
/// to the arm: every kind of ideal joint and of load.
pub(super) fn everything() -> Scene {
    let mut scene = SceneSource::builtin("four-bar").expect("it is built in").nominal().clone();
    let free = |x: f64, y: f64, angle: f64, mass: f64| Motion::Free {
        mass,
        inertia: 1e-3 * mass,
        centre_of_mass: [0.02, -0.004],
        start_position: [x, y],
        start_angle: angle,
        start_velocity: None,
        start_speed: None,
    };
    let body = |name: &str, motion| Body { name: name.into(), motion, points: vec![] };
    let speed = Table { at: vec![0.0, 0.02, 0.04, 0.1], value: vec![90.0, 140.0, 110.0, 90.0], repeat: true };
    let drive = Drive::Speed { start_angle: 0.3, table: speed };
    scene.bodies = vec![
        body("frame", Motion::Fixed),
        body("crank", Motion::Driven { position: [0.0, 0.01], drive, inertia: None }),
        body("rod", free(0.05, 0.02, 0.0, 0.2)),
        body("slider", free(0.16, 0.02, 0.2, 0.3)),
        body("arm", free(0.16, 0.02, 1.0, 0.1)),
        body("weight", free(0.2, 0.1, 1.3, 0.15)),
    ];
    let joint = |name: &str, journal, bushing, kind| Joint {
        name: name.into(),
        journal,
        bushing,
        kind,
        friction: None,
    };
    let slide = JointKind::Prismatic { axis: 0.2, angle: 0.2 };
    scene.joints = vec![
        joint("crank", at(1, [0.05, 0.0]), at(2, [0.0, 0.0]), JointKind::Revolute),
        joint("rod", at(2, [0.12, 0.0]), at(3, [0.0, 0.0]), JointKind::Revolute),
        joint("slider", at(3, [0.0, 0.0]), at(0, [0.1, 0.01]), slide),
        joint("arm", at(4, [0.0, 0.0]), at(3, [0.01, 0.01]), JointKind::Revolute),
        joint("weight", at(5, [0.0, 0.0]), at(4, [0.09, 0.0]), JointKind::Fixed { angle: 0.3 }),
    ];
    let name = String::new;
    let over_time = Table { at: vec![0.0, 0.03, 0.06, 0.1], value: vec![2.0, 9.0, -4.0, 2.0], repeat: true };
    let over_angle = Table { at: vec![0.0, 2.0, 4.0, TAU], value: vec![0.1, -0.2, 0.5, 0.1], repeat: true };
    let factor = Table { at: vec![0.0, 0.03, 0.06, 0.1], value: vec![0.5, 2.0, 0.0, 0.5], repeat: true };
    let direction = [0.6, 0.8];
    let curve = |over, table: &Table| Curve { over, table: table.clone() };
    scene.loads = vec![
        Load::Spring {
            name: name(),
            a: at(4, [0.03, 0.02]),
            b: at(2, [0.03, 0.0]),
            stiffness: 300.0,
            damping: 2.0,
            free_length: 0.05,
        },
        Load::TorsionSpring { name: name(), a: 4, b: 3, stiffness: 0.7, damping: 0.01, free_angle: 0.5 },
        Load::VariableForce {
            name: name(),
            at: at(5, [0.0, 0.03]),
            direction,
            size: curve(Over::Time, &over_time),
        },
        Load::VariableTorque { name: name(), body: 5, torque: curve(Over::Angle(2), &over_angle) },
        Load::VariableTorque { name: name(), body: 4, torque: curve(Over::Angle(1), &over_angle) },
        Load::Motor { name: name(), body: 4, stall_torque: 0.3, no_load_speed: 40.0 },
        Load::DirectionalSpring {
            name: name(),
            at: at(5, [0.01, 0.0]),
            anchor: at(3, [0.0, 0.0]),
            direction,
            stiffness: 50.0,
            free_length: 0.01,
        },
        Load::ConstantForce { name: name(), at: at(3, [0.01, 0.02]), force: [-3.0, 1.0] },
        Load::Drag {
            name: name(),
            at: at(5, [0.02, -0.03]),
            direction,
            linear: 0.3,
            quadratic: 0.8,
            flow: 0.5,
            factor: Some(curve(Over::Angle(3), &factor)),
        },
        Load::RotationalDrag {
            name: name(),
            body: 4,
            linear: 1e-4,
            quadratic: 2e-4,
            factor: Some(curve(Over::Time, &factor)),
        },
    ];
    scene.gravity = [0.0, -9.81];
    (scene.outputs, scene.limit_states, scene.variables) = (vec![], vec![], vec![]);
    scene.life = Life { period: 0.1, cycles: 1, checkpoint_every: 1, settle_cycles: 0, turn_of: None };
    scene
}

#[test]
fn derivatives_with_ideal_joints_and_every_load_agree_with_differences() {
    let scene = everything();
    let mut found = islands(&scene).expect("it is modelled");
    let [island] = found.as_mut_slice() else { panic!("one island") };
    assert_eq!((island.coordinates(), island.ideal.rows), (12, 11));
    for state in states(&scene, island) {
        check(island, &state, [1e-7, 1e-6, 1e-5, 1e-4, 1e-6], 1e-4, "everything");
    }
}

#[test]
fn ideal_joints_stay_closed() {
    let scene = everything();
    let mut found = islands(&scene).expect("it is modelled");
    let [island] = found.as_mut_slice() else { panic!("one island") };
    for (t, q, v) in states(&scene, island) {
        let (mut closed_q, mut closed_v) = (q.clone(), v.clone());
        let drift = island.close(t, &mut closed_q, &mut closed_v).expect("it can be closed");
        assert!(drift < 1e-14, "{drift} m at {t}");
        for (a, b) in v.iter().zip(&closed_v) {
            assert!((a - b).abs() < 1e-10, "{a} against {b}");
        }
    }
}
