//! The flapping-wing drive at the edges of its model, both contact laws: every case agrees with half the step within its
//! stated error, or says why it has no result.
//!
//! Refused, and why:
//! - a wall of 10 um under tenfold wear: worn through, as it should be;
//! - no damping and no friction: nothing ends the rattling after the start, the bound of steps does;
//! - a clearance of 1 um with tenfold modulus and a friction of 0.5: the journal chatters around the bore, likewise,
//!   and under `foundation` masses x 0.01 with tenfold modulus at 6 r/min;
//! - `foundation` with a friction of 0.5, tenfold wear and a jump of 8000 cycles: the chatter takes all steps.

use common::accuracy::Accuracy;
use common::failure::SimulationFailure;
use common::scene::{ContactLaw, SceneSource};
use worker::extremes::{Outcome, Row, cases, run_all};

/// What a refused case may have cost, in time steps of the nominal one.
const NOMINAL_TIMES: u64 = 10;

/// Cases of `foundation` that agree too, but cost as much as all others together; `coordinator extremes` runs them.
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

/// What every table must fulfil; `agreeing` cases come to their end.
fn check(rows: &[Row], agreeing: usize) {
    let unsound: Vec<_> = rows.iter().filter(|row| !row.outcome.is_sound()).collect();
    assert!(unsound.is_empty(), "{unsound:#?}");
    assert_eq!(rows.iter().filter(|row| row.outcome == Outcome::Agrees).count(), agreeing);
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
    check(&rows(ContactLaw::LocalHertz, &Accuracy::balanced()), 21);
}

#[test]
fn foundation_is_sound_at_its_extremes() {
    check(&rows(ContactLaw::Foundation, &Accuracy::draft()), 16);
}
