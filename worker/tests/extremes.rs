//! The flapping-wing drive at the edges of its model, both contact laws: every case agrees with half the step within its
//! stated error, or says why it has no result.
//!
//! Refused, within a bound of 100 000 steps a cycle that keeps this test short, and why:
//! - a wall of 10 um under tenfold wear: worn through, as it should be;
//! - no damping and no friction: nothing ends the rattling after the start, the bound of steps does;
//! - a clearance of 1 um with tenfold modulus and a friction of 0.5: the journal chatters around the bore, likewise,
//!   and under `foundation` masses x 0.01 with tenfold modulus at 6 r/min;
//! - `foundation` with a friction of 0.5, tenfold wear and a jump of 8000 cycles: the chatter takes all steps.

use cases::{Case, cases};
use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{ContactLaw, JointKind, SceneSource};
use outcome::{Outcome, Row, run_all};

#[path = "../examples/extremes/cases.rs"]
mod cases;
#[path = "../examples/extremes/outcome.rs"]
mod outcome;

/// Bound on the steps of a cycle: a quarter of that of the presets.
const STEPS_BOUND: u64 = 100_000;
/// What a refused case may have cost, in time steps of the nominal one.
const NOMINAL_TIMES: u64 = 10;

/// Cases of `foundation` that agree too, but cost as much as all others together; the example `extremes` runs them.
const LEFT_OUT: [&str; 4] = ["clearance 1 um", "clearance 5 um", "6 r/min", "jump of 100 cycles"];

fn rows(law: ContactLaw, accuracy: &Accuracy) -> Vec<Row> {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    let left_out = |name: &str| law == ContactLaw::Foundation && LEFT_OUT.contains(&name);
    let mut cases = cases(source.nominal(), accuracy);
    cases.retain(|c| c.law == law && !left_out(c.name));
    run_all(&cases, 2, |row| {
        println!("{:?} {}: {:?} {} + {} steps", row.law, row.case, row.outcome, row.steps, row.steps_of_half);
        for c in &row.compared {
            println!(
                "    {} at {}: {:e} +- {:e}, off by {:e}",
                c.output, c.cycles, c.value, c.error, c.difference
            );
        }
    })
}

/// Largest difference over the stated error [1]. Stated errors are to hold twice for 95 % of all values; of the extremes one under
/// `foundation` at `draft` (masses x 100, whose rockers vibrate) exceeds its stated error by a factor of 1.07.
const LARGEST_SHARE: f64 = 1.25;

/// What every table must fulfil; `agreeing` cases come to their end.
fn check(rows: &[Row], agreeing: usize) {
    let agrees = |row: &&Row| match row.outcome {
        Outcome::Agrees => true,
        Outcome::Disagrees => row.compared.iter().all(|c| c.difference <= LARGEST_SHARE * c.error),
        Outcome::Refused(_) | Outcome::Unconfirmed(_) => false,
    };
    let unsound: Vec<_> = rows.iter().filter(|row| !row.outcome.is_sound() && !agrees(row)).collect();
    assert!(unsound.is_empty(), "{unsound:#?}");
    assert_eq!(rows.iter().filter(agrees).count(), agreeing);
    let of = |name: &str| rows.iter().find(|row| row.case == name).expect("a case of the table");
    // Wear beyond half the wall is simulated, wear through it is not.
    let depth = of("wear x 10, wall of 30 um").depth.expect("simulated");
    assert!(depth > 15e-6 && depth < 30e-6, "{depth}");
    match &of("wear x 10, wall of 10 um").outcome {
        Outcome::Refused(SimulationFailure::WornThrough { cycle, joint, depth, wall }) => {
            assert!(*cycle > 0 && !joint.is_empty() && depth >= wall && *wall == 10e-6);
        }
        other => panic!("{other:?}"),
    }
    // A bounded number of steps, and where, when and why.
    let nominal = of("nominal").steps;
    assert!(nominal > 0);
    for row in rows {
        let Outcome::Refused(failure) = &row.outcome else { continue };
        assert!(row.steps <= NOMINAL_TIMES * nominal, "{}: {} steps against {nominal}", row.case, row.steps);
        match failure {
            SimulationFailure::TooManySteps { time, joint: Some(joint), .. }
            | SimulationFailure::StepTooSmall { time, joint: Some(joint), .. }
            | SimulationFailure::OutOfRange { time, joint, .. } => {
                assert!(time.is_finite() && !joint.is_empty(), "{failure}");
            }
            SimulationFailure::WearStep { joint, .. } | SimulationFailure::WornThrough { joint, .. } => {
                assert!(!joint.is_empty(), "{failure}");
            }
            other => panic!("{}: {other:?}", row.case),
        }
    }
}

#[test]
fn local_hertz_is_sound_at_its_extremes() {
    check(&rows(ContactLaw::LocalHertz, &Accuracy { steps_bound: STEPS_BOUND, ..Accuracy::balanced() }), 21);
}

#[test]
fn foundation_is_sound_at_its_extremes() {
    check(&rows(ContactLaw::Foundation, &Accuracy { steps_bound: STEPS_BOUND, ..Accuracy::draft() }), 16);
}

/// The drive with this friction coefficient, wear coefficients times `wear` and blocks of `jump` cycles, at inputs that
/// differ by some 1e-13: its output depends on details of the bores, and each of them is another sample of it.
fn neighbours(friction: f64, wear: f64, jump: u32, count: usize) -> Vec<Case> {
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    let accuracy = Accuracy { cycle_jump: jump, ..Accuracy::balanced() };
    let neighbour = |k: usize| {
        let mut scene = source.nominal().clone();
        scene.life.cycles = jump.max(4000);
        for joint in &mut scene.joints {
            if let JointKind::Clearance(clearance) = &mut joint.kind {
                clearance.bushing_radius *= 1.0 + k as f64 * 1e-13;
                clearance.friction = friction;
                clearance.wear_coefficient *= wear;
            }
        }
        Case { name: "neighbour", law: ContactLaw::LocalHertz, scene, accuracy }
    };
    (0..count).map(neighbour).collect()
}

/// Number of `count` such inputs with a value off by more than stated, and how many stated errors the worst one is off.
/// Prints a row of the table.
fn inputs_off(friction: f64, wear: f64, jump: u32, count: usize) -> (usize, f64) {
    let rows = run_all(&neighbours(friction, wear, jump, count), 2, |_| ());
    let refused = rows.iter().filter(|row| matches!(row.outcome, Outcome::Refused(_))).count();
    let off = rows.iter().filter(|row| !row.outcome.is_sound()).count();
    let shares = rows.iter().flat_map(|row| &row.compared).map(|c| c.difference / c.error);
    let largest = shares.fold(0.0, f64::max);
    println!("| {friction:.3} | x {wear:.2} | {jump} | {off} of {} | {largest:.2} |", count - refused);
    (off, largest)
}

/// Of a motion that repeats itself on given bores, whose asymmetry depends on their details.
#[test]
fn stated_errors_hold_for_an_erratic_output() {
    let (off, largest) = inputs_off(0.5, 10.0, 8000, 2);
    assert!(off == 0 && largest > 0.1, "{off} {largest}");
}

#[test]
#[ignore = "some minutes; prints the table validation/erratic-outputs.csv"]
fn stated_errors_of_erratic_outputs_hold_for_neighbouring_inputs() {
    let chosen = [
        (0.5, 1.0, 4000),
        (0.5, 10.0, 8000),
        (0.3, 1.0, 4000),
        (0.4, 3.0, 2000),
        (0.4, 10.0, 8000),
        (0.7, 5.0, 8000),
    ];
    println!(
        "| friction | wear coefficient | blocks [cycles] | inputs off by more than stated | largest share |"
    );
    println!("|---|---|---|---|---|");
    let off: usize =
        chosen.iter().map(|&(friction, wear, jump)| inputs_off(friction, wear, jump, 16).0).sum();
    assert!(off * 20 <= chosen.len() * 16, "{off}");
    // Spread evenly over three intervals (a sequence of Roberts); none of them was used for any choice.
    let (draws, count) = (30, 8);
    let mut rows = vec![];
    for k in 1..=draws {
        let [friction, wear, jump] =
            [0.8191725, 0.6710436, 0.5497005].map(|step: f64| (k as f64 * step).fract());
        let jump = [2000, 4000, 8000][(3.0 * jump) as usize];
        rows.push(inputs_off(0.2 + 0.6 * friction, 10f64.powf(wear), jump, count));
    }
    let off: usize = rows.iter().map(|row| row.0).sum();
    println!(
        "{off} of {}, at most {:.2} stated errors",
        draws * count,
        rows.iter().fold(0.0, |a, r| r.1.max(a))
    );
    assert!(off * 20 <= draws * count, "{off}");
}
