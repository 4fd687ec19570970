//! Progress of one system through a span of time, its counts, and what can end it early.
//!
//! [`super::Stepper`] (one system) and [`super::LaneStepper`] (one system per SIMD lane) leave every decision about a step to
//! [`SpanProgress`]: its length, whether it is accepted, and when the integration gives up.
//!
//! # Length of the steps
//! Length of the time steps: as long as the local error allows, with one tolerance for the whole cycle.
//!
//! A step of length h has an estimated error e, divided by its tolerance [1]. The embedded estimate grows as h^4
//! ([`super::Rosenbrock`]), hence the next length is
//!
//! - h clamp(0.9 e^(-1/4), 0.3, 3) after an accepted step (e <= 1), at most the largest step;
//! - h clamp(0.9 e^(-1/4), 0.1, 0.5) after a refused step, h / 10 if e is not finite.
//!
//! Under `local-hertz` the error stays near its bound through the whole cycle, with some seven steps a period of the softest
//! contact vibration (6 to 9 kHz in the flapping-wing drive), though only a fifth of the cycle lets that vibration grow: its damping is
//! 2 to 6 % of critical elsewhere and falls below 1 % there, late in life. A tolerance loosened in proportion to the rate at which
//! perturbations die (from the eigenvalues of the linearised island, 40 to 100 times a cycle) saved 30 to 50 % of the steps and
//! left the wear and the early life unchanged; but it displaced the asymmetry from 48 000 cycles on by 2 to 50 % of its limit,
//! because the weakly damped part of the cycle amplifies the errors of the long steps. The tolerance is therefore constant within a cycle; early
//! cycles of a life may have a looser one (`simulate/longer_steps.rs`).
//!
//! # Source
//! Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I (1993), section II.4.

use crate::lanes::{Real, lanewise};
use std::ops::Range;

/// Work done in one or more spans of time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StepCounts {
    /// Number of accepted steps.
    pub steps: u64,
    /// Number of refused steps.
    pub rejected: u64,
    /// Evaluations of the force, with or without derivatives.
    pub forces: u64,
    /// Largest distance by which an ideal joint drifted open in one step, before it was closed again [m].
    pub drift: f64,
    /// Number of steps through positions in which the constraints of ideal joints are dependent.
    pub passages: u64,
}

impl StepCounts {
    /// Adds the counts of another span.
    pub(crate) fn add(&mut self, other: &StepCounts) {
        self.steps += other.steps;
        self.rejected += other.rejected;
        self.forces += other.forces;
        self.drift = self.drift.max(other.drift);
        self.passages += other.passages;
    }
}

/// Reason why an integration stopped before the end of its span. Joints are indices into the island's joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum IntegrationError {
    /// The step fell below its lower bound.
    StepTooSmall {
        /// Time of the last accepted state [s].
        time: f64,
        /// Length of the step to try next [s].
        step: f64,
        /// Estimated error of the last step over its tolerance, finite [1].
        error: f64,
        /// Joint with the largest error, if one can be named.
        joint: Option<usize>,
    },
    /// The number of steps reached its bound.
    TooManySteps {
        /// Time of the last accepted state [s].
        time: f64,
        /// Bound on the accepted steps.
        bound: u64,
        /// Joint with the largest error, if one can be named.
        joint: Option<usize>,
    },
    /// The penetration of a joint left the range of its contact law.
    OutOfRange {
        /// Time of the state [s].
        time: f64,
        /// Joint that left the range.
        joint: usize,
        /// Penetration there [m].
        penetration: f64,
    },
    /// A slider stands out of its guide.
    LeftGuide {
        /// Time of the state [s].
        time: f64,
        /// Index into the island's guides.
        guide: usize,
        /// Length by which it stands out [m].
        distance: f64,
    },
    /// The constraints of the ideal joints became linearly dependent. Holds the time of the state [s].
    Singular(f64),
    /// The motion cannot be continued through a position in which the constraints of the ideal joints are dependent.
    Branching {
        /// Time of the last accepted state [s].
        time: f64,
        /// Ideal joint that depends on the others there, an index into the scene's joints.
        joint: usize,
    },
    /// The reactions of the ideal joints do not balance their friction.
    SelfLocking {
        /// Time of the last state at which they did, or of the state at which they did not [s].
        time: f64,
        /// Ideal joint that locks itself, by index into the island's constraints.
        joint: usize,
    },
    /// The state or the force is not finite. Holds the time of the state [s].
    NotFinite(f64),
}

impl IntegrationError {
    /// Adds the joint with the largest error to the errors that name one.
    pub(crate) fn with_joint(self, responsible: Option<usize>) -> Self {
        match self {
            IntegrationError::StepTooSmall { time, step, error, .. } => {
                IntegrationError::StepTooSmall { time, step, error, joint: responsible }
            }
            IntegrationError::TooManySteps { time, bound, .. } => {
                IntegrationError::TooManySteps { time, bound, joint: responsible }
            }
            other => other,
        }
    }
}

/// Time reached in a span, with the step control and the counts of this span; in lanes those of one system each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpanProgress<R = f64> {
    /// Time reached [s].
    pub time: R,
    /// End of the span [s].
    pub end: R,
    /// Length of the steps.
    pub control: StepControl<R>,
    /// Number of accepted steps in this span, a whole number as the next two.
    pub steps: R,
    /// Number of refused steps.
    pub rejected: R,
    /// Evaluations of the force, with or without derivatives.
    pub forces: R,
    /// Largest distance by which an ideal joint drifted open in one step [m].
    pub drift: R,
}

lanewise!(numbers SpanProgress { time, end, control, steps, rejected, forces, drift });

impl SpanProgress {
    /// The start of a span of time [s].
    pub(crate) fn new(span: Range<f64>, control: StepControl) -> Self {
        let (time, end) = (span.start, span.end);
        SpanProgress { time, end, control, steps: 0.0, rejected: 0.0, forces: 0.0, drift: 0.0 }
    }

    /// Work done in this span.
    pub(crate) fn counts(&self) -> StepCounts {
        StepCounts {
            steps: self.steps as u64,
            rejected: self.rejected as u64,
            forces: self.forces as u64,
            drift: self.drift,
            passages: 0,
        }
    }

    /// True if the end of the span is reached.
    #[inline]
    pub(crate) fn is_complete(&self) -> bool {
        self.time >= self.end
    }

    /// Checks that another step is allowed.
    ///
    /// # Errors
    /// [`IntegrationError::TooManySteps`] without a joint.
    pub(crate) fn check_bound(&self) -> Result<(), IntegrationError> {
        let bound = self.control.bound;
        if self.steps < bound {
            return Ok(());
        }
        Err(IntegrationError::TooManySteps { time: self.time, bound: bound as u64, joint: None })
    }

    /// The next step would be below its bound, after one refused with this error over its tolerance [1].
    pub(crate) fn too_small(&self, error: f64) -> IntegrationError {
        let (error, step) = (error.min(f64::MAX), self.control.step);
        IntegrationError::StepTooSmall { time: self.time, step, error, joint: None }
    }
}

impl<R: Real> SpanProgress<R> {
    /// Length of the step to try [s].
    #[inline(always)]
    pub(crate) fn next_step(&self) -> R {
        self.control.next(self.end - self.time)
    }

    /// Accepts or refuses a step of length `h` [s] whose estimated error over its tolerance is `error` [1] (infinite if the
    /// step has no finite one), and adapts the length of the next step; `ratio` is the [`step_ratio`](super::step_ratio) of this error.
    /// Only lanes where `tried` is one change. Returns one, else zero, lane by lane: where the state at the end of the step is the
    /// new state, and where the step is refused and the next one would be below its bound.
    #[inline(always)]
    pub(crate) fn decide(&mut self, tried: R, h: R, error: R, ratio: R) -> [R; 2] {
        let (zero, one) = (h.zero(), h.like(1.0));
        let accepted = R::select(one.below(error), zero, tried);
        let refused = tried - accepted;
        let (is_accepted, is_refused) = (zero.below(accepted), zero.below(refused));
        let reached = R::select(h.below(self.end - self.time), self.time + h, self.end);
        self.time = R::select(is_accepted, reached, self.time);
        self.steps += accepted;
        self.rejected += refused;
        let step = R::select(is_accepted, self.control.lengthened(h, ratio), self.control.step);
        self.control.step = R::select(is_refused, self.control.shortened(h, ratio), step);
        let too_small = R::select(self.control.step.below(self.control.smallest), refused, zero);
        [accepted, too_small]
    }
}

/// `error`, or infinity where it is not a number, so that a comparison with a bound refuses it.
#[inline]
pub(crate) fn nan_as_infinite(error: f64) -> f64 {
    // A comparison with NaN is false.
    if error <= f64::MAX { error } else { f64::INFINITY }
}

/// The coordinate with the largest of these errors of position and velocity `(n,)`, each over its scale.
pub(crate) fn worst_coordinate(
    errors: impl Iterator<Item = (f64, f64)>,
    (scale_q, scale_v): (&[f64], &[f64]),
) -> Option<usize> {
    let scaled = errors.zip(scale_q.iter().zip(scale_v)).map(|((q, v), (scale_q, scale_v))| {
        let error = (q / scale_q).abs().max((v / scale_v).abs());
        if error.is_finite() { error } else { f64::INFINITY }
    });
    scaled.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
}

/// Bounds of the steps of one island, and the step to try next; in lanes those of one island each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepControl<R = f64> {
    /// Tolerance of the local error, in the scales of the system [1].
    pub tolerance: R,
    /// Largest step [s].
    pub largest: R,
    /// Smallest step [s].
    pub smallest: R,
    /// Bound on the accepted steps of one span, a whole number.
    pub bound: R,
    /// Step to try next [s].
    pub step: R,
}

lanewise!(numbers StepControl { tolerance, largest, smallest, bound, step });

/// First step after a start or a jump of the system, as a share of the largest step [1].
const FIRST_STEP: f64 = 1e-2;

impl StepControl {
    /// Steps between `smallest` and `largest` [s], at most `bound` accepted ones a span, with local errors up to `tolerance`.
    pub fn new(tolerance: f64, largest: f64, smallest: f64, bound: u64) -> Self {
        StepControl { tolerance, largest, smallest, bound: bound as f64, step: largest * FIRST_STEP }
    }

    /// Shortens the next step after a discontinuous change of the system, e.g. of a bore.
    pub(crate) fn after_jump(&mut self) {
        self.step = self.largest * FIRST_STEP;
    }
}

impl<R: Real> StepControl<R> {
    /// The step to try, or what the time `left` in the span allows [s]: the last two steps of a span share it equally, so that no sliver
    /// remains.
    #[inline(always)]
    pub(crate) fn next(&self, left: R) -> R {
        let shared = R::select(left.below(self.step * 2.0), left * 0.5, self.step);
        R::select(self.step.below(left), shared, left)
    }

    /// The next step after an accepted one of length `h` [s] with this [`step_ratio`]. A step cut short by the end of a span does
    /// not lengthen it.
    #[inline(always)]
    pub(crate) fn lengthened(&self, h: R, ratio: R) -> R {
        let growth = ratio.larger(h.like(0.3)).smaller(h.like(3.0));
        let next = (h * growth).smaller(self.largest);
        let shorter = R::select(growth.below(h.like(1.0)), next, self.step);
        R::select(h.below(self.step), shorter, next)
    }

    /// The next step after a refused one of length `h` [s] with this [`step_ratio`].
    #[inline(always)]
    pub(crate) fn shortened(&self, h: R, ratio: R) -> R {
        h * ratio.larger(h.like(0.1)).smaller(h.like(0.5))
    }
}

/// Ratio 0.9 e^(-1/4) of the length wanted to that of a step with the error over tolerance e = `error` [1], before its bounds; zero if e is
/// infinite.
#[inline(always)]
pub(crate) fn step_ratio<R: Real>(error: R) -> R {
    error.like(0.9) / error.larger(error.like(1e-6)).sqrt().sqrt()
}

/// Ratio 0.9 e^(-1/5) for an explicit step of fifth order, whose estimate grows as h^5, as [`step_ratio`] is for the others. (With that one, every
/// second step of a long motion was refused.)
#[inline]
pub(crate) fn projected_step_ratio(error: f64) -> f64 {
    0.9 * libm::pow(error.max(1e-6), -0.2)
}
