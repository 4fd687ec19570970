//! Wear step of one joint: integrates dh/dN = rate(h) over a block of cycles by a stabilised explicit method.
//!
//! Second-order Runge-Kutta-Chebyshev method: wear depth h `(points,)` [m], cycles N, wear rate [m/cycle] of
//! `archard.rs` under a frozen contact history. A sub-step of H cycles takes s >= 2 stages, of which s^2
//! grows with H times the spectral radius of -d rate/dh (stable up to about 0.65 s^2); its length follows
//! from the embedded error estimate 0.8 (y0 - y1) + 0.4 H (f0 + f1).
//!
//! The published step is one explicit Euler step over the whole block, h(N + T) = h(N) + T rate(h(N)), without an estimate of its error.
//!
//! The tolerance bounds the sum of the error estimates over the block: a sub-step may use up what earlier
//! ones left of their share, as it must where the wear rate has a kink: where a patch of the contact appears
//! or joins another.
//!
//! # Source
//! Sommeijer, Shampine, Verwer (1998), RKC: an explicit solver for parabolic PDEs, J. Comput. Appl. Math. 88,
//! 315-326; van der Houwen, Sommeijer (1980), ZAMM 60, 479-485. Blocks of cycles under a frozen history: Cui
//! et al. as cited in `archard.rs`.

use super::{NoEquilibrium, WearLaw};
use crate::extremum::largest;
use crate::interpolate::Cubic;
use common::scene::{BlockStep, WearModel};

/// How a wear step advances over a block: by sub-steps whose errors stay within this share of the largest wear that they add [1], or without one by
/// one explicit Euler step.
pub type StepTolerance = Option<f64>;

/// The step of a wear model, whose controlled steps have this relative `tolerance` [1].
pub(crate) fn step_tolerance(model: &WearModel, tolerance: f64) -> StepTolerance {
    (model.explicit_step == BlockStep::Controlled).then_some(tolerance)
}

/// Work counters of one or more wear steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WearStepStats {
    /// Evaluations of the wear rate.
    pub stages: u64,
    /// Sub-steps refused and shortened.
    pub rejected: u64,
    /// Control points held where a sub-step would have given material back, each counted in every such
    /// sub-step.
    pub held: u64,
}

/// Why a wear step has no result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WearStepFailed {
    /// It could not reach its tolerance: the error over its bound.
    Tolerance(f64),
    /// A surface is worn deeper than the model holds: its largest depth and the bound of that `(2,)` [m].
    TooDeep([f64; 2]),
    /// It took more evaluations of the wear rate than [`WearStep::MOST_EVALUATIONS`].
    TooManyStages,
}

impl From<NoEquilibrium> for WearStepFailed {
    fn from(NoEquilibrium(excess): NoEquilibrium) -> Self {
        WearStepFailed::Tolerance(excess.min(f64::MAX))
    }
}

/// Scratch and state of the wear step of one joint; all vectors `(points,)`.
#[derive(Debug, Clone)]
pub struct WearStep {
    /// How it advances; of controlled sub-steps the sum of the errors is bounded, relative to the largest wear they add.
    tolerance: StepTolerance,
    /// Direction of the stiffest mode found so far.
    stiffest: Vec<f64>,
    /// Steps of the power method towards it in the next block.
    power_steps: usize,
    /// Wear rate at both ends of the sub-step, and the depth at its end.
    f0: Vec<f64>,
    f1: Vec<f64>,
    end: Vec<f64>,
}

/// Most stages of one sub-step.
const MOST_STAGES: usize = 50;
/// Sub-steps are at least this fraction of the block: enough for a tolerance of 1e-5 in every built-in scene.
const SMALLEST: f64 = 1.0 / 16384.0;
/// Credit with which a block starts, as a share of the error it is allowed.
const FIRST_CREDIT: f64 = 1.0 / 16.0;
/// Share of the credit that one sub-step may use up.
const SPENDABLE: f64 = 0.5;
/// Displacement by which the stiffness is probed [m]: a tenth of the penetrations and more, so that kinks of
/// the rate are averaged over.
const PROBE: f64 = 1e-8;

impl WearStep {
    /// Most evaluations of the wear rate in one step: some 6 are usual, 560 on average for a crank with three hundred times the modulus of steel
    /// and bronze under `foundation`, the hardest case known to end.
    pub(crate) const MOST_EVALUATIONS: u64 = 2000;

    /// A wear step for `points` control points by a rule, or with control of the errors within a relative tolerance [1].
    pub(crate) fn new(points: usize, tolerance: StepTolerance) -> Self {
        let zero = vec![0.0; points];
        WearStep {
            tolerance,
            stiffest: (0..points).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect(),
            power_steps: 2,
            f0: zero.clone(),
            f1: zero.clone(),
            end: zero,
        }
    }

    /// Advances `depth` by `cycles` under the frozen history in `rate`. `mark` receives the depths at each of
    /// `marks` (increasing, within the block, counted from its start), by cubic Hermite interpolation in a
    /// sub-step.
    ///
    /// # Errors
    /// [`WearStepFailed`] if a frozen force has no equilibrium on that bore, if a sub-step of the smallest length
    /// still misses the tolerance, if the step takes too many evaluations of the rate, or as soon as a surface is worn too deep.
    pub(crate) fn advance(
        &mut self,
        rate: &mut impl WearLaw,
        depth: &mut [f64],
        cycles: f64,
        marks: &[f64],
        mut mark: impl FnMut(usize, [&[f64]; 2]),
        stats: &mut WearStepStats,
    ) -> Result<(), WearStepFailed> {
        let Some(tolerance) = self.tolerance else {
            return self.euler(rate, depth, cycles, marks, mark, stats);
        };
        let sizes = rate.sizes();
        let most = stats.stages + Self::MOST_EVALUATIONS;
        rate.rate(depth, &mut self.f0)?;
        stats.stages += 1;
        let radius = self.spectral_radius(rate, depth, stats)?;
        let (mut done, mut step, mut marked) = (0.0, cycles, 0);
        let fastest = largest(self.f0.iter().copied());
        // Error allowed in excess of each sub-step's own share [m].
        let mut credit = FIRST_CREDIT * tolerance * fastest * cycles;
        let smallest = SMALLEST * cycles;
        while done < cycles {
            if stats.stages > most {
                return Err(WearStepFailed::TooManyStages);
            }
            step = step.min(cycles - done);
            let relative = match self.attempt(rate, depth, (step, tolerance), radius, &mut credit, stats) {
                Ok(relative) => relative,
                Err([smaller, error]) => {
                    stats.rejected += 1;
                    if step <= smallest {
                        return Err(WearStepFailed::Tolerance(error.min(f64::MAX)));
                    }
                    step = smaller.max(smallest);
                    continue;
                }
            };
            self.hold_worn(depth, stats);
            if let Some(depths) = sizes.too_deep(&self.end) {
                return Err(WearStepFailed::TooDeep(depths));
            }
            let last = if step == cycles - done { cycles } else { done + step };
            while marked < marks.len() && marks[marked] <= last {
                if marks[marked] == last {
                    mark(marked, [&self.end, &self.end]);
                } else {
                    let free = self.between(depth, (marks[marked] - done) / step, step);
                    let ends = depth.iter().zip(&self.end);
                    let kept = free.iter().zip(ends).map(|(h, (y0, y1))| h.clamp(*y0, y1.max(*y0)));
                    mark(marked, [&kept.collect::<Vec<f64>>(), &free]);
                }
                marked += 1;
            }
            depth.copy_from_slice(&self.end);
            std::mem::swap(&mut self.f0, &mut self.f1);
            done = last;
            // Not below the smallest one, however large the error that the credit allowed: where the rate jumps, ever shorter sub-steps would
            // approach the place without passing it.
            step = f64::max(step * (0.8 / libm::cbrt(relative.max(1e-3))).clamp(0.5, 4.0), smallest);
        }
        Ok(())
    }

    /// One explicit Euler step over the block; the wear in between grows evenly.
    fn euler(
        &mut self,
        rate: &mut impl WearLaw,
        depth: &mut [f64],
        cycles: f64,
        marks: &[f64],
        mut mark: impl FnMut(usize, [&[f64]; 2]),
        stats: &mut WearStepStats,
    ) -> Result<(), WearStepFailed> {
        rate.rate(depth, &mut self.f0)?;
        stats.stages += 1;
        let worn = |after: f64, end: &mut Vec<f64>| {
            end.clear();
            end.extend(depth.iter().zip(&self.f0).map(|(depth, rate)| depth + after * rate));
        };
        for (k, after) in marks.iter().enumerate() {
            worn(*after, &mut self.end);
            mark(k, [&self.end, &self.end]);
        }
        worn(cycles, &mut self.end);
        if let Some(depths) = rate.sizes().too_deep(&self.end) {
            return Err(WearStepFailed::TooDeep(depths));
        }
        depth.copy_from_slice(&self.end);
        Ok(())
    }

    /// One sub-step of `step` cycles and a relative tolerance from `depth` to `self.end`, for the spectral radius `radius` [1/cycle].
    /// If its error fits the tolerance and the `credit` [m], counts it there and returns it relative to its
    /// share.
    fn attempt(
        &mut self,
        rate: &mut impl WearLaw,
        depth: &[f64],
        (step, tolerance): (f64, f64),
        radius: f64,
        credit: &mut f64,
        stats: &mut WearStepStats,
    ) -> Result<f64, [f64; 2]> {
        let stages = ((1.0 + 1.54 * step * radius).sqrt().ceil() as usize + 1).max(2);
        if stages > MOST_STAGES {
            return Err([step * 0.5, f64::INFINITY]);
        }
        stats.stages += stages as u64;
        let made = chebyshev(rate, depth, &self.f0, step, stages, &mut self.end);
        if let Err(NoEquilibrium(excess)) = made.and_then(|()| rate.rate(&self.end, &mut self.f1)) {
            return Err([step * 0.5, excess]);
        }
        let (error, added) = self.error(depth, step);
        let share = tolerance * added;
        let relative = if added > 0.0 { error / share } else { 0.0 };
        if error > share + SPENDABLE * *credit {
            let smaller = step * (0.8 / libm::cbrt(relative)).clamp(0.1, 0.5);
            return Err([smaller, relative]);
        }
        *credit += share - error;
        Ok(relative)
    }

    /// Wear only grows: what the stages undershoot (below the tolerance) is not given back.
    fn hold_worn(&mut self, depth: &[f64], stats: &mut WearStepStats) {
        for (end, start) in self.end.iter_mut().zip(depth) {
            if *end < *start {
                *end = *start;
                stats.held += 1;
            }
        }
    }

    /// Embedded error estimate of the sub-step just made, and the largest wear it adds [m].
    fn error(&self, depth: &[f64], step: f64) -> (f64, f64) {
        let ends = self.f0.iter().zip(&self.f1);
        depth.iter().zip(&self.end).zip(ends).fold(
            (0.0, 0.0),
            |(error, added): (f64, f64), ((y0, y1), (f0, f1))| {
                let estimate = 0.8 * (y0 - y1) + 0.4 * step * (f0 + f1);
                (error.max(estimate.abs()), added.max(y1 - y0))
            },
        )
    }

    /// Depth at the fraction `s` of the sub-step [m].
    fn between(&self, depth: &[f64], s: f64, step: f64) -> Vec<f64> {
        let ends = self.f0.iter().zip(&self.f1);
        let hermite = |((y0, y1), (f0, f1)): ((&f64, &f64), (&f64, &f64))| {
            Cubic::hermite([*y0, *y1], [step * f0, step * f1]).value(s)
        };
        depth.iter().zip(&self.end).zip(ends).map(hermite).collect()
    }

    /// Largest eigenvalue of -d rate/d depth at `depth`, where the rate is f0, with a margin of a quarter
    /// [1/cycle]: a step of the power method from the stiffest direction of the block before, two at the
    /// start.
    fn spectral_radius(
        &mut self,
        rate: &mut impl WearLaw,
        depth: &[f64],
        stats: &mut WearStepStats,
    ) -> Result<f64, WearStepFailed> {
        let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let mut radius = 0.0;
        for _ in 0..std::mem::replace(&mut self.power_steps, 1) {
            let size = norm(&self.stiffest);
            if size <= 0.0 {
                return Ok(radius);
            }
            for ((moved, depth), v) in self.end.iter_mut().zip(depth).zip(&self.stiffest) {
                *moved = depth + PROBE * v / size;
            }
            rate.rate(&self.end, &mut self.f1)?;
            stats.stages += 1;
            for ((v, f1), f0) in self.stiffest.iter_mut().zip(&self.f1).zip(&self.f0) {
                *v = (f1 - f0) / PROBE;
            }
            radius = norm(&self.stiffest);
        }
        Ok(1.25 * radius)
    }
}

/// One step of the second-order Runge-Kutta-Chebyshev method with `s` >= 2 stages.
fn chebyshev(
    rate: &mut impl WearLaw,
    y0: &[f64],
    f0: &[f64],
    h: f64,
    s: usize,
    y: &mut [f64],
) -> Result<(), NoEquilibrium> {
    let n = y0.len();
    let w0 = 1.0 + 2.0 / 13.0 / (s * s) as f64;
    // Chebyshev polynomials T_j(w0) with first and second derivatives.
    let mut t = vec![(1.0, 0.0, 0.0), (w0, 1.0, 0.0)];
    for j in 2..=s {
        let ((a, da, dda), (b, db, ddb)) = (t[j - 2], t[j - 1]);
        t.push((2.0 * w0 * b - a, 2.0 * b + 2.0 * w0 * db - da, 4.0 * db + 2.0 * w0 * ddb - dda));
    }
    let w1 = t[s].1 / t[s].2;
    let b = |j: usize| {
        let (_, d, dd) = t[j.max(2)];
        dd / (d * d)
    };
    // In increments to y0, so that what does not wear stays as it is to the last bit.
    let mut before = vec![0.0; n];
    let mut last: Vec<f64> = f0.iter().map(|f| b(1) * w1 * h * f).collect();
    let mut f = vec![0.0; n];
    for j in 2..=s {
        for i in 0..n {
            y[i] = y0[i] + last[i];
        }
        rate.rate(y, &mut f)?;
        let mu = 2.0 * b(j) * w0 / b(j - 1);
        let nu = -b(j) / b(j - 2);
        let mu_t = 2.0 * b(j) * w1 / b(j - 1);
        let gamma_t = -(1.0 - b(j - 1) * t[j - 1].0) * mu_t;
        for i in 0..n {
            before[i] = mu * last[i] + nu * before[i] + h * (mu_t * f[i] + gamma_t * f0[i]);
        }
        std::mem::swap(&mut before, &mut last);
    }
    for i in 0..n {
        y[i] = y0[i] + last[i];
    }
    Ok(())
}
