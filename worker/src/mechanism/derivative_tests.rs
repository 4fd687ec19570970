//! Derivatives of the generalised forces, of one pair of bodies and of whole islands, against central differences.

use super::joint::pair_force;
use super::{Frame, Island, ideal_cycle, islands};
use crate::bore::Profile;
use crate::contact::Contact;
use crate::integrate::{Advance, AdvanceStats, Dynamics, Linearised};
use common::scene::{Clearance, ContactLaw, JointKind, Scene, SceneSource};
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

/// Largest difference between a matrix and its differences, each relative to the largest entry of its row among
/// the columns of the same unit (lengths, angles).
fn worst(rows: usize, exact: impl Fn(usize, usize) -> f64, columns_found: &[Vec<f64>]) -> f64 {
    let columns = columns_found.len();
    let difference = |r: usize, c: usize| columns_found[c][r];
    let mut worst: f64 = 0.0;
    for r in 0..rows {
        for (angles, keep) in [(false, [true, true, false]), (true, [false, false, true])] {
            let same: Vec<usize> = (0..columns).filter(|c| keep[c % 3]).collect();
            let scale = same.iter().fold(0.0_f64, |a, &c| a.max(exact(r, c).abs()));
            for &c in &same {
                let off = (exact(r, c) - difference(r, c)).abs();
                assert!(scale > 0.0 || off == 0.0, "row {r}, angles {angles}");
                worst = if scale > 0.0 { worst.max(off / scale) } else { worst };
            }
        }
    }
    worst
}

#[test]
fn pair_derivatives_agree_with_differences() {
    const ARM_I: [f64; 2] = [0.012, -0.004];
    const ARM_J: [f64; 2] = [-0.02, 0.007];
    for law in [ContactLaw::LocalHertz, ContactLaw::Foundation] {
        let scene = flapping_wing(law);
        let clearance = clearance(&scene);
        let mut profile = Profile::round(clearance.bushing_radius, 36);
        profile.set_depth(&worn_depth());
        let mut contact = Contact::of(clearance);
        contact.profile_changed(&profile);
        let force = |q: &[f64; 6], v: &[f64; 6]| {
            let (i, j) = (Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..]));
            pair_force::<false>(&contact, &profile, &i, ARM_I, &j, ARM_J).f
        };
        for k in 0..12 {
            // The journal's centre at a chosen eccentricity in the bushing's frame.
            let x = f64::from(k);
            let psi = 0.2 + TAU * x / 12.0;
            let reach = profile.at(psi).r - clearance.journal_radius + 1e-7 * (1.0 + x % 4.0);
            let bushing = [0.003, -0.002, 0.7 * x];
            let j = Frame::free(&bushing, &[0.0; 3]);
            let centre = j.point([ARM_J[0] + reach * psi.cos(), ARM_J[1] + reach * psi.sin()]);
            let angle = 1.0 - 0.4 * x;
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
                pair_force::<true>(&contact, &profile, &i, ARM_I, &j, ARM_J)
            };
            assert!(exact.joint.normal > 0.0);
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
            let k_off = worst(6, |r, c| exact.k[r][c], &differences([2e-10, 2e-8], false));
            let d_off = worst(6, |r, c| exact.d[r][c], &differences([1e-7, 1e-5], true));
            assert!(k_off < 2e-5 && d_off < 2e-5, "{law:?} at {psi}: {k_off} {d_off}");
        }
    }
}

/// An island of the flapping-wing with worn bores, at a few times of a cycle when all its joints are in contact.
fn states(scene: &Scene, island: &mut Island) -> Vec<(f64, Vec<f64>, Vec<f64>)> {
    for joint in &mut island.joints {
        joint.set_depth(&worn_depth());
    }
    let pose = ideal_cycle(scene, 2, &mut 0).expect("the linkage closes").swap_remove(0);
    let pick = |from: &[Option<[f64; 3]>]| -> Vec<f64> {
        island.bodies.iter().flat_map(|&b| from[b].expect("free")).collect()
    };
    let (mut q, mut v) = (pick(&pose.q), pick(&pose.v));
    let period = scene.life.period;
    let (n, joints) = (island.coordinates(), island.joints.len());
    let mut advance = Advance::new(n, joints, 1e-2, period / 250.0, period * 1e-9, 100_000);
    let mut t = 0.0;
    [0.37, 0.55, 0.8]
        .iter()
        .map(|share| {
            let end = share * period;
            let mut stats = AdvanceStats::default();
            advance.run(island, t..end, &mut q, &mut v, &mut (), &mut stats).expect("integrated");
            t = end;
            (t, q.clone(), v.clone())
        })
        .collect()
}

#[test]
fn island_derivatives_agree_with_differences() {
    for law in [ContactLaw::LocalHertz, ContactLaw::Foundation] {
        let scene = flapping_wing(law);
        for mut island in islands(&scene).expect("all joints have clearance") {
            for (t, q, v) in states(&scene, &mut island) {
                let n = island.coordinates();
                let mut at = Linearised::new(n, island.joints.len());
                island.linearise(t, &q, &v, &mut at);
                assert!(at.joints.iter().all(|j| j.normal > 0.0), "a joint is in free flight at {t}");
                let force = |t: f64, q: &[f64], v: &[f64]| {
                    let mut f = vec![0.0; n];
                    island.force(t, q, v, &mut f);
                    f
                };
                assert_eq!(force(t, &q, &v), at.f);
                let column = |c: usize, of_rates: bool| -> Vec<f64> {
                    let h = match (of_rates, c % 3 == 2) {
                        (false, false) => 2e-10,
                        (false, true) => 1e-8,
                        (true, false) => 1e-7,
                        (true, true) => 1e-5,
                    };
                    let shifted = |h: f64| {
                        let (mut q, mut v) = (q.clone(), v.clone());
                        if of_rates {
                            v[c] += h
                        } else {
                            q[c] += h
                        }
                        force(t, &q, &v)
                    };
                    shifted(h).iter().zip(shifted(-h)).map(|(f, g)| (f - g) / (2.0 * h)).collect()
                };
                let k: Vec<_> = (0..n).map(|c| column(c, false)).collect();
                let d: Vec<_> = (0..n).map(|c| column(c, true)).collect();
                let k_off = worst(n, |r, c| at.k[r * n + c], &k);
                let d_off = worst(n, |r, c| at.d[r * n + c], &d);
                assert!(k_off < 2e-5 && d_off < 2e-5, "{law:?} at {t}: {k_off} {d_off}");
                let h = 5e-10;
                let (after, before) = (force(t + h, &q, &v), force(t - h, &q, &v));
                let scale = at.ft.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                assert!(scale > 0.0, "the crank moves one journal");
                for i in 0..n {
                    let off = ((after[i] - before[i]) / (2.0 * h) - at.ft[i]).abs() / scale;
                    assert!(off < 2e-5, "{law:?} at {t}, row {i}: {off}");
                }
            }
        }
    }
}
