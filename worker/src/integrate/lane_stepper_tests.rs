//! Two steppers integrate the dynamics: `Stepper` one island, `LaneStepper` many islands at once. They must take the same decisions.

use super::{
    Band, Dynamics, IntegrationError, LaneStepper, Linearised, StateObserver, StepControl, StepCounts,
    Stepped, SteppedLanes, Stepper,
};
use std::ops::Range;

/// A mass between two walls that repel it by K x^1.5, driven by cos(5 t): steps are refused at every impact.
struct Bouncing;

const STIFFNESS: f64 = 1e6;
const GAP: f64 = 0.01;

impl Dynamics for Bouncing {
    fn mass(&self) -> &[f64] {
        &[0.1]
    }
    fn force(&mut self, t: f64, q: &[f64], _v: &[f64], f: &mut [f64]) {
        let depth = (q[0].abs() - GAP).max(0.0);
        f[0] = (5.0 * t).cos() - STIFFNESS * depth.powf(1.5).copysign(q[0]);
    }
    fn linearise(&mut self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised) {
        self.force(t, q, v, &mut at.f);
        at.k[0] = -1.5 * STIFFNESS * (q[0].abs() - GAP).max(0.0).sqrt();
        at.ft[0] = -5.0 * (5.0 * t).sin();
    }
}

impl Stepped for Bouncing {
    crate::integrate::impact_tests::plain_system!();
    fn on_accepted(&mut self, _q: &[f64], _v: &[f64], _at: &Linearised) {}
    fn scales(&self) -> (&[f64], &[f64]) {
        (&[1e-4], &[1.0])
    }
}

impl SteppedLanes<f64> for Bouncing {
    fn is_constrained(&self) -> bool {
        false
    }
    fn begins_contacts(&self) -> bool {
        false
    }
    fn begun(&mut self, _before: &Linearised, _h: f64, _t: f64, _q: &[f64], _v: &[f64]) -> f64 {
        0.0
    }
    fn on_accepted(&mut self, _at: &Linearised) {}
    fn close(&mut self, _t: f64, wanted: f64, _q: &mut [f64], _v: &mut [f64]) -> [f64; 2] {
        [0.0, wanted]
    }
    fn inverse_scales(&self) -> &[(f64, f64)] {
        &[(1.0 / 1e-4, 1.0)]
    }
}

/// Accepted states (t, q, qd).
#[derive(Debug, Default, PartialEq)]
struct Accepted(Vec<[f64; 3]>);

impl StateObserver<Bouncing> for Accepted {
    fn observe(&mut self, _system: &Bouncing, t: f64, q: &[f64], v: &[f64], _at: &Linearised) {
        self.0.push([t, q[0], v[0]]);
    }
}

type Run = (Accepted, StepCounts, StepControl, Result<(), IntegrationError>);

fn by_stepper(span: Range<f64>, control: StepControl) -> Run {
    let mut stepper = Stepper::new(Linearised::new(0.0, Band::new(1, 0), 0), control);
    let (mut accepted, mut counts) = (Accepted::default(), StepCounts::default());
    let result = stepper.run(&mut Bouncing, span, &mut [0.0], &mut [0.5], &mut accepted, &mut counts);
    (accepted, counts, stepper.control, result)
}

fn by_lane(span: Range<f64>, control: StepControl) -> Run {
    let mut stepper = LaneStepper::new(0.0, Linearised::new(0.0, Band::new(1, 0), 0), control.largest);
    stepper.load_state(0, &[0.0], &[0.5]);
    stepper.start(0, span, control);
    let mut accepted = Accepted::default();
    loop {
        stepper.try_steps(&mut Bouncing);
        if stepper.fresh == 1.0 {
            accepted.0.push([stepper.progress.time, stepper.q[0], stepper.v[0]]);
        }
        let stopped = stepper.finish_round(0.0);
        if let Some(result) = stepper.outcome(0, std::iter::empty()) {
            assert!(stopped);
            let progress = stepper.stop(0);
            return (accepted, progress.counts(), progress.control, result);
        }
        assert!(!stopped);
    }
}

#[test]
fn one_lane_takes_the_decisions_of_the_stepper_for_one_system() {
    let control = StepControl::new(1e-3, 0.01, 1e-9, 100_000);
    let one = by_stepper(0.0..1.0, control);
    let lane = by_lane(0.0..1.0, control);
    assert!(one.1.rejected > 10 && one.3.is_ok(), "{:?}", one.1);
    assert_eq!(lane, one);
}

#[test]
fn both_steppers_stop_at_the_same_step_for_the_same_reason() {
    let few = StepControl::new(1e-3, 0.01, 1e-9, 20);
    let coarse = StepControl::new(1e-3, 0.01, 1e-3, 100_000);
    for control in [few, coarse] {
        let (one, lane) = (by_stepper(0.0..1.0, control), by_lane(0.0..1.0, control));
        assert!(one.3.is_err());
        assert_eq!((lane.0, lane.2, lane.3), (one.0, one.2, one.3));
    }
}
