//! Steps of the gaps and their control on one coordinate held by a spring and a film: order, closed forms, refusals.

use super::gap_solver::GapSolver;
use super::{IdealMotion, QuasiStaticStepper, Unsuitable};
use crate::integrate::{Band, Dynamics, Linearised, StateObserver, StepControl, StepCounts, Stepped};
use std::f64::consts::TAU;

/// A body of mass `mass` on a point that moves as A sin(omega t): f = -c (v - v_point) - k g (1 + h g^2), with
/// g = q - q_point; the spring is there until `until`.
struct Held {
    mass: [f64; 1],
    film: f64,
    stiffness: f64,
    hardening: f64,
    amplitude: f64,
    until: f64,
    scale: [f64; 1],
}

const OMEGA: f64 = TAU;

impl Held {
    fn new(film: f64, stiffness: f64, hardening: f64) -> Self {
        // A hundredth of the gaps, as in a mechanism the penetrations are of the clearance.
        let scale = [5e-3];
        Held { mass: [2.0], film, stiffness, hardening, amplitude: 0.3, until: f64::INFINITY, scale }
    }

    fn point(&self, t: f64) -> [f64; 3] {
        let (s, c) = (OMEGA * t).sin_cos();
        [self.amplitude * s, OMEGA * self.amplitude * c, -OMEGA * OMEGA * self.amplitude * s]
    }

    /// The point's motion, as the ideal one of the body; 1000 intervals, so that its own error does not show.
    fn ideal(&self) -> IdealMotion {
        IdealMotion::new(1.0, 1, (0..=1000).flat_map(|k| self.point(f64::from(k) / 1000.0)).collect())
    }
}

impl Dynamics for Held {
    fn mass(&self) -> &[f64] {
        &self.mass
    }
    fn force(&mut self, t: f64, q: &[f64], v: &[f64], f: &mut [f64]) {
        let [x, w, _] = self.point(t);
        let g = q[0] - x;
        let spring = if t < self.until { self.stiffness * g * (1.0 + self.hardening * g * g) } else { 0.0 };
        f[0] = -self.film * (v[0] - w) - spring;
    }
    fn linearise(&mut self, t: f64, q: &[f64], v: &[f64], at: &mut Linearised) {
        self.force(t, q, v, &mut at.f);
        let g = q[0] - self.point(t)[0];
        let slope = self.stiffness * (1.0 + 3.0 * self.hardening * g * g);
        at.k[0] = if t < self.until { -slope } else { 0.0 };
        at.d[0] = -self.film;
    }
}

impl Stepped for Held {
    crate::integrate::impact_tests::plain_system!();
    fn on_accepted(&mut self, _q: &[f64], _v: &[f64], _at: &Linearised) {}
    fn scales(&self) -> (&[f64], &[f64]) {
        (&self.scale, &[1.0])
    }
}

/// Gap at t = 0.4 after this many equal steps from rest at t = 0.1, and the last step's error estimate.
fn end(system: &Held, steps: u32) -> (f64, f64) {
    let (ideal, mut gap) = (system.ideal(), GapSolver::new(Linearised::new(0.0, Band::new(1, 0), 0)));
    gap.solve_rest(&mut Held { ..*system }, &ideal, 0.1, &[0.0]).expect("a spring gives rest");
    // Newton's iteration stops at 1e-4 of the scale: now far below every difference looked at.
    let system = &mut Held { scale: [5e-4], ..*system };
    let h = 0.3 / f64::from(steps);
    let mut error = 0.0;
    for k in 1..=steps {
        assert_eq!(gap.try_step(system, &ideal, h), Some(()), "step {k}");
        error = gap.estimate_error(h, &[1.0]);
        gap.accept(0.1 + f64::from(k) * h);
    }
    (gap.past[0][0], error)
}

#[test]
fn order_two_is_observed() {
    // Film over stiffness of a twentieth of the cycle, and of a two-hundredth: of the order of the steps.
    for film in [2.0, 0.2] {
        let system = Held::new(film, 40.0, 1.0);
        let fine = end(&system, 8192).0;
        let error = |steps: u32| (end(&system, steps).0 - fine).abs();
        let order = (error(64) / error(256)).log2() / 2.0;
        assert!((1.8..2.2).contains(&order), "film {film}: observed order {order}");
    }
}

#[test]
fn the_error_estimate_is_of_third_power_and_no_smaller_than_the_error_of_a_step() {
    let system = Held::new(2.0, 40.0, 1.0);
    let order = (end(&system, 64).1 / end(&system, 128).1).log2();
    assert!((2.7..3.3).contains(&order), "observed order {order}");
    // Over the relaxation time of 0.05, a sixth of the span, the steps' errors add up.
    let error = (end(&system, 64).0 - end(&system, 8192).0).abs();
    let estimate = 64.0 / 6.0 * end(&system, 64).1;
    assert!((0.3..3.0).contains(&(estimate / error)), "estimate {estimate}, error {error}");
}

#[test]
fn without_film_the_gap_is_the_equilibrium_at_once() {
    let system = Held::new(0.0, 40.0, 0.0);
    let (gap, error) = end(&system, 30);
    let expected = -system.mass[0] * system.point(0.4)[2] / system.stiffness;
    assert!((gap - expected).abs() < 1e-9, "{gap} against {expected}");
    assert_eq!(error, 0.0, "what is algebraic has no error of the rate");
}

/// Largest difference to a closed form over the states seen.
struct Against<F: Fn(f64) -> f64> {
    form: F,
    point: fn(&Held, f64) -> [f64; 3],
    system: Held,
    off: f64,
    seen: u64,
}

impl<F: Fn(f64) -> f64> StateObserver<Held> for Against<F> {
    fn observe(&mut self, _system: &Held, t: f64, q: &[f64], _v: &[f64], _at: &Linearised) {
        self.off = self.off.max((q[0] - (self.point)(&self.system, t)[0] - (self.form)(t)).abs());
        self.seen += 1;
    }
}

fn control(tolerance: f64, largest: f64) -> StepControl {
    StepControl::new(tolerance, largest, 1e-9, 10_000)
}

#[test]
fn the_settled_cycle_is_that_of_the_closed_form() {
    let mut system = Held::new(2.0, 40.0, 0.0);
    // c g' + k g = m A omega^2 sin(omega t).
    let (c, k) = (system.film, system.stiffness);
    let force = system.mass[0] * system.amplitude * OMEGA * OMEGA;
    let (size, lag) = (force / k.hypot(c * OMEGA), (c * OMEGA).atan2(k));
    let mut off = |tolerance: f64| {
        let mut stepper = QuasiStaticStepper::new(
            system.ideal(),
            Linearised::new(0.0, Band::new(1, 0), 0),
            control(tolerance, 0.1),
        );
        let mut stats = StepCounts::default();
        // After ten relaxation times of 0.05 the start is forgotten to 5e-5.
        stepper.start(&mut system, -0.5, &[0.0], &mut stats).expect("a spring gives rest");
        stepper.run(&mut system, 0.0, &mut (), &mut stats).expect("run up");
        let form = |t: f64| size * (OMEGA * t - lag).sin();
        let before = stats.steps;
        let mut observer =
            Against { form, point: Held::point, system: Held::new(c, k, 0.0), off: 0.0, seen: 0 };
        stepper.run(&mut system, 1.0, &mut observer, &mut stats).expect("a cycle");
        assert_eq!(observer.seen, stats.steps - before + 1, "both ends and every step are seen");
        assert!(stats.forces > stats.steps);
        observer.off / size
    };
    // The local error is of third order, its sum over the relaxation time of second: 100^(2/3) = 21.5.
    let (coarse, fine) = (off(0.1), off(0.001));
    assert!(coarse < 5e-3, "off by {coarse}");
    assert!((15.0..35.0).contains(&(coarse / fine)), "100 times tighter gains {}", coarse / fine);
}

#[test]
fn a_gap_that_nothing_holds_is_refused() {
    let mut system = Held::new(0.0, 40.0, 0.0);
    let mut stats = StepCounts::default();
    let mut stepper =
        QuasiStaticStepper::new(system.ideal(), Linearised::new(0.0, Band::new(1, 0), 0), control(1.0, 0.01));
    system.until = 0.35;
    stepper.start(&mut system, 0.1, &[0.0], &mut stats).expect("held at first");
    match stepper.run(&mut system, 1.0, &mut (), &mut stats) {
        Err(Unsuitable::LostHold { time, step }) => {
            assert!((time - 0.35).abs() < 1e-6 && step < 1e-9, "at {time}, step {step}");
        }
        other => panic!("{other:?}"),
    }
    assert!(stats.rejected > 10, "every refusal is counted: {}", stats.rejected);
    let lost = stepper.start(&mut system, 0.4, &[0.0], &mut stats);
    assert_eq!(lost, Err(Unsuitable::NoRest(0.4)));
}

#[test]
fn a_film_alone_holds_a_gap() {
    let mut system = Held::new(2.0, 40.0, 0.0);
    system.until = 0.35;
    let mut stats = StepCounts::default();
    let mut stepper = QuasiStaticStepper::new(
        system.ideal(),
        Linearised::new(0.0, Band::new(1, 0), 0),
        control(1e-3, 0.01),
    );
    stepper.start(&mut system, 0.1, &[0.0], &mut stats).expect("held at first");
    stepper.run(&mut system, 1.0, &mut (), &mut stats).expect("the film goes on holding");
    // From there on c g' = m A omega^2 sin(omega t), and what a step misses is never made good: of the two-step
    // formula's error half as much again comes with the next step.
    let (start, before) = (stepper.solver.past[0][0], stats.steps);
    stepper.run(&mut system, 1.25, &mut (), &mut stats).expect("the film goes on holding");
    let off = stepper.solver.past[0][0] - start - system.mass[0] * system.amplitude * OMEGA / system.film;
    let allowed = 1.5 * (stats.steps - before) as f64 * 1e-3 * system.scale[0];
    assert!(off.abs() < allowed, "off by {off}, allowed {allowed}");
}

#[test]
fn the_bound_on_steps_holds() {
    let mut system = Held::new(2.0, 40.0, 0.0);
    let few = StepControl { bound: 5.0, ..control(1.0, 0.01) };
    let mut stepper = QuasiStaticStepper::new(system.ideal(), Linearised::new(0.0, Band::new(1, 0), 0), few);
    let mut stats = StepCounts::default();
    stepper.start(&mut system, 0.0, &[0.0], &mut stats).expect("a spring gives rest");
    let stopped = stepper.run(&mut system, 1.0, &mut (), &mut stats);
    assert!(matches!(stopped, Err(Unsuitable::TooManySteps(_))) && stats.steps == 5, "{stopped:?}");
}
