//! Contact kernel, time steps and whole evaluations of the built-in drive `flapping-wing`.
//!
//! `cargo bench -p worker --bench evaluation`; with `-- contact` and the like only those. The machine's load moves all times:
//! compare within one run. Counted items are force evaluations of one joint, or accepted and refused time steps.

use common::accuracy::{Accuracy, NamedAccuracy};
use common::scene::{ContactLaw, JointKind, Scene, SceneSource, WearingSurfaces};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use worker::bore::Profile;
use worker::contact::{Contact, JointMotion, LawLanes, PolarEccentricity};
use worker::simulate::{
    LaneWidth, SimulateOptions, SimulationInput, simulate, simulate_counted, simulate_side_by_side,
};

fn main() {
    divan::main();
}

fn flapping_wing() -> Scene {
    SceneSource::builtin("flapping-wing").expect("built in").nominal().clone()
}

/// One joint of the drive under this law, on a bore worn 5 um deep on one side.
fn worn_joint(law: ContactLaw) -> (Contact, Profile) {
    let scene = flapping_wing();
    let clearance = scene.joints.iter().find_map(|joint| match &joint.kind {
        JointKind::Clearance(clearance) => Some(clearance.clone()),
        _ => None,
    });
    let mut clearance = clearance.expect("a joint with clearance");
    clearance.contact_law = law;
    let points = clearance.control_points.number();
    let mut profile = Profile::round(clearance.bushing_radius, points);
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / points as f64;
    let depth: Vec<f64> = (0..points).map(|k| 2.5e-6 * (1.0 + angle(k).cos())).collect();
    profile.set_depth(&depth);
    let mut contact = Contact::new(&clearance);
    contact.profile_changed(&profile);
    (contact, profile)
}

/// Motions with penetrations of 0.2 to 2 um all around the bore.
fn motions(profile: &Profile, journal_radius: f64) -> Vec<JointMotion> {
    (0..64)
        .map(|k| {
            let psi = 0.1 * f64::from(k);
            let depth = 0.2e-6 * f64::from(1 + k * 7 % 10);
            let r = profile.radius_at(psi % std::f64::consts::TAU).r - journal_radius + depth;
            let w = [0.01 * psi.sin(), -0.02 * psi.cos()];
            JointMotion {
                e: [r * psi.cos(), r * psi.sin()],
                w,
                omega_journal: 20.0,
                omega_bushing: -5.0,
                turn: 0.0,
            }
        })
        .collect()
}

fn contact_of<const JACOBIAN: bool>(bencher: Bencher, law: ContactLaw) {
    let (contact, profile) = worn_joint(law);
    let motions = motions(&profile, contact.surface().journal_radius);
    let law = LawLanes::new(&contact, (&profile).into(), 0.0);
    bencher.counter(ItemsCount::new(motions.len())).bench_local(|| {
        for motion in &motions {
            let motion = black_box(motion);
            let place = PolarEccentricity::new(motion.e);
            let walls = law.walls(&place, motion.turn);
            // All of it counts as used, or the compiler would leave the derivative out.
            black_box(law.force::<JACOBIAN>((&place, &walls), motion));
        }
    });
}

#[divan::bench(args = [ContactLaw::LocalHertz, ContactLaw::Foundation])]
fn contact_force(bencher: Bencher, law: ContactLaw) {
    contact_of::<false>(bencher, law);
}

#[divan::bench(args = [ContactLaw::LocalHertz, ContactLaw::Foundation])]
fn contact_force_and_derivative(bencher: Bencher, law: ContactLaw) {
    contact_of::<true>(bencher, law);
}

/// The unworn drive without wear: a cycle to settle, one to measure, and what its stated error takes; the counted
/// steps say what one of them costs.
#[divan::bench(args = ["draft", "balanced"], sample_count = 5, sample_size = 1)]
fn unworn_cycles(bencher: Bencher, preset: &str) {
    let accuracy = Accuracy::by_name(preset).expect("a preset");
    let mut scene = flapping_wing();
    for joint in &mut scene.joints {
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            clearance.wear_coefficient = 0.0;
        }
    }
    let steps = simulate_counted(&scene, &accuracy, SimulateOptions::default()).1;
    bencher
        .counter(ItemsCount::new(steps))
        .bench_local(|| simulate(black_box(&scene), &accuracy, SimulateOptions::default()));
}

/// A whole life of the drive.
#[divan::bench(args = ["draft", "balanced"], sample_count = 3, sample_size = 1)]
fn evaluation(bencher: Bencher, preset: &str) {
    let accuracy = Accuracy::by_name(preset).expect("a preset");
    let scene = flapping_wing();
    let steps = simulate_counted(&scene, &accuracy, SimulateOptions::default()).1;
    bencher
        .counter(ItemsCount::new(steps))
        .bench_local(|| simulate(black_box(&scene), &accuracy, SimulateOptions::default()));
}

/// Lives of a built-in scene with wear coefficients of their own, under this law if one is given.
fn lives(scene: &str, count: usize, accuracy: &str, law: Option<ContactLaw>) -> Vec<SimulationInput> {
    let source = SceneSource::builtin(scene).expect("built in");
    let NamedAccuracy { accuracy, .. } = accuracy.parse().expect("an accuracy");
    let input = |k: usize| {
        let mut scene = source.nominal().clone();
        for joint in &mut scene.joints {
            if let JointKind::Clearance(clearance) = &mut joint.kind {
                clearance.wear_coefficient *= 0.99 + 0.002 * k as f64;
                clearance.contact_law = law.unwrap_or(clearance.contact_law);
            }
        }
        SimulationInput { scene, accuracy, options: SimulateOptions::default() }
    };
    (0..count).map(input).collect()
}

/// Runs these lives in lanes of this width, at most `most` at a time.
fn run(inputs: &[SimulationInput], width: LaneWidth, most: usize) {
    let mut inputs = inputs.iter().cloned();
    simulate_side_by_side(width, most, &mut || inputs.next().map(Ok), &mut |_, found, _| {
        black_box(found.expect("the drive can be simulated"));
    });
}

/// Eight lives: one after the other, or side by side, each in lanes of one number or as wide as the processor has them.
fn eight(bencher: Bencher, how: &str, law: ContactLaw) {
    const BATCH: usize = 8;
    let width = match how.split_once(", ") {
        Some((_, "1 lane")) => LaneWidth::Holding(1),
        Some(_) => LaneWidth::Holding(4),
        None => LaneWidth::Widest,
    };
    let most = if how.starts_with("one") { 1 } else { BATCH };
    let inputs = lives("flapping-wing", BATCH, "balanced", Some(law));
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| run(&inputs, width, most));
}

#[divan::bench(
    args = [
        "one by one, 1 lane",
        "one by one, 4 lanes",
        "one by one",
        "side by side, 1 lane",
        "side by side, 4 lanes",
        "side by side",
    ],
    sample_count = 2,
    sample_size = 1
)]
fn batch_of_eight(bencher: Bencher, how: &str) {
    eight(bencher, how, ContactLaw::LocalHertz);
}

#[divan::bench(
    args = ["side by side, 1 lane", "side by side, 4 lanes", "side by side"],
    sample_count = 2,
    sample_size = 1
)]
fn batch_of_eight_under_foundation(bencher: Bencher, how: &str) {
    eight(bencher, how, ContactLaw::Foundation);
}

/// Eight lives side by side at the accuracy that a scene asks for, and at other ones.
#[divan::bench(
    args = [
        "flapping-wing draft",
        "flapping-wing balanced",
        "flapping-wing balanced+jump-2000",
        "flapping-wing reference",
        "four-bar balanced",
        "slider-crank balanced",
    ],
    sample_count = 2,
    sample_size = 1
)]
fn batch_at_accuracy(bencher: Bencher, scene_and_accuracy: &str) {
    const BATCH: usize = 8;
    let (scene, accuracy) = scene_and_accuracy.split_once(' ').expect("a scene and an accuracy");
    let inputs = lives(scene, BATCH, accuracy, None);
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| run(&inputs, LaneWidth::Widest, BATCH));
}

/// The same at the accuracy of the drive's scene under `foundation`.
#[divan::bench(args = ["balanced", "balanced+jump-2000"], sample_count = 1, sample_size = 1)]
fn batch_under_foundation_at_accuracy(bencher: Bencher, accuracy: &str) {
    const BATCH: usize = 8;
    let inputs = lives("flapping-wing", BATCH, accuracy, Some(ContactLaw::Foundation));
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| run(&inputs, LaneWidth::Widest, BATCH));
}

/// The drive with the surfaces of its joints that wear, under either law: what a journal that wears costs.
#[divan::bench(
    args = [
        "bushing, local-hertz",
        "both, local-hertz",
        "bushing, foundation",
        "both, foundation",
    ],
    sample_count = 1,
    sample_size = 1
)]
fn batch_by_wearing_surfaces(bencher: Bencher, surfaces_and_law: &str) {
    const BATCH: usize = 8;
    let surfaces =
        if surfaces_and_law.starts_with("both") { WearingSurfaces::Both } else { WearingSurfaces::Bushing };
    let law = if surfaces_and_law.ends_with("foundation") {
        ContactLaw::Foundation
    } else {
        ContactLaw::LocalHertz
    };
    let mut inputs = lives("flapping-wing", BATCH, "balanced+jump-2000", Some(law));
    for joint in inputs.iter_mut().flat_map(|input| &mut input.scene.joints) {
        if let JointKind::Clearance(clearance) = &mut joint.kind {
            clearance.wears = surfaces;
        }
    }
    bencher.counter(ItemsCount::new(BATCH)).bench_local(|| run(&inputs, LaneWidth::Widest, BATCH));
}
