//! Verifications of a simulator in closed form.

use super::{
    Campaign, Observed, Plan, Problem, Settings, SimulatedPoint, StoredOutcome, completed, verify,
    verify_study,
};
use crate::statistics::design::Population;
use crate::statistics::surrogate::Kernel;
use common::scene::{Scene, SceneSource};

fn scene() -> Scene {
    let text = "scene = { name = \"s\" }\nsimulator = { program = [\"s\"] }\n\
        life = { cycles = 50, checkpoint_every = 10 }\n\
        outputs = [{ name = \"a\" }, { name = \"b\" }]\n\
        limit_states = [{ name = \"high\", output = \"a\", threshold = 5 },\n\
        { name = \"low\", output = \"b\", threshold = -5, fails = \"below\" }]\n\
        variables = [{ name = \"x\", mean = 0, std = 1 }, { name = \"y\", mean = 0, std = 1 }]";
    SceneSource::parse(text, "s").unwrap().nominal().clone()
}

/// High fails earlier with x + 0.1 x y, low with y; at nine tenths of the life on average.
fn simulated(sample: Vec<f64>) -> SimulatedPoint {
    let (x, y) = (sample[0], sample[1]);
    let life = |bend: f64| (1..=5).map(|n| 5.0 * f64::from(n) / 4.5 + 0.5 * bend).collect::<Vec<f64>>();
    let low = life(y - 0.3 * x).into_iter().map(|value| -value).collect();
    SimulatedPoint { sample, observed: Observed::exact(vec![life(x + 0.1 * x * y), low]) }
}

fn settings(scene: &Scene) -> Settings {
    let mut settings = Settings::from(scene);
    (settings.initial, settings.batch, settings.max_evaluations) = (20, 4, 60);
    settings.forms.kernel = Some(Kernel::Gaussian);
    settings
}

fn samples(scene: &Scene, count: usize) -> Vec<SimulatedPoint> {
    let population = Population::draw(&Problem::from_scene(scene).inputs, count, scene.study.seed);
    (0..count).map(|j| simulated(population.physical(j))).collect()
}

#[test]
fn surrogates_agree_with_simulations_of_what_they_learned_and_not_with_others() {
    let scene = scene();
    let settings = settings(&scene);
    let all = samples(&scene, 1000);
    let (learned, unseen) = all.split_at(40);
    let found = verify(&scene, &settings, learned, unseen).unwrap();
    assert_eq!((found.learned_from, found.points, found.curves.len()), (40, 960, 3));
    assert!(found.surrogates.iter().all(|surrogate| surrogate.q2 > 0.9999), "{:?}", found.surrogates);
    assert!(found.largest_difference() < 3e-3, "{found:?}");
    // R of high at the checkpoint before its mean life: P(x + 0.1 x y < 1.11), counted.
    let row = found.rows.iter().find(|row| row.cycles == 40).unwrap();
    let safe = |point: &&SimulatedPoint| {
        40.0 / 9.0 + 0.5 * (point.sample[0] + 0.1 * point.sample[0] * point.sample[1]) < 5.0
    };
    assert_eq!(row.simulated[0], unseen.iter().filter(safe).count() as f64 / 960.0);
    assert!(row.simulated[2] < row.simulated[0].min(row.simulated[1]));

    // Simulations of something else: every value a third of a standard deviation higher.
    let mut others = unseen.to_vec();
    others
        .iter_mut()
        .for_each(|point| point.observed.histories[0].iter_mut().for_each(|value| *value += 0.17));
    let found = verify(&scene, &settings, learned, &others).unwrap();
    let row = found.rows.iter().find(|row| row.cycles == 40).unwrap();
    let difference = row.predicted[0] - row.simulated[0];
    assert!(difference > 0.03 && difference > 5.0 * row.standard_error[0], "{row:?}");
}

#[test]
fn issue_a_study_is_judged_by_the_surrogates_it_ended_with() {
    let scene = scene();
    let settings = settings(&scene);
    let mut stored = Vec::new();
    let learned = Campaign::new(Problem::from_scene(&scene), Plan::new(&settings, &scene))
        .learn_from(
            |x| {
                let point = simulated(x.to_vec());
                let complete = completed(&scene, std::slice::from_ref(&point)).swap_remove(0);
                stored.push(StoredOutcome { sample: point.sample, outcome: Ok(point.observed) });
                Ok(complete)
            },
            |_| {},
        )
        .unwrap();
    let unseen = samples(&scene, 300);
    let found = verify_study(&scene, &settings, &stored, &unseen).unwrap().unwrap();
    // Exploring results that confirmed the surrogates are in none of them.
    let own = &learned.assessment.surrogates;
    assert_eq!(found.learned_from, own[0].model.points());
    let q2 = own[0].leave_one_out.iter().map(|l| l.q2).fold(1.0, f64::min);
    assert_eq!(found.surrogates[0].q2_leave_one_out.to_bits(), q2.to_bits());
    // Of an interrupted study those of its last round, and of a foreign one none.
    assert!(verify_study(&scene, &settings, &stored[..30], &unseen).unwrap().is_some());
    stored[5].sample[0] += 1e-9;
    assert!(verify_study(&scene, &settings, &stored, &unseen).unwrap().is_none());
}
