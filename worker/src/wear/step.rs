//! One wear step of one joint: dh/dN = rate(h) over a block of cycles, by a stabilised explicit method.
//!
//! Second-order Runge-Kutta-Chebyshev with as many stages as the stiffness of the unloading asks for, sub-steps
//! by its embedded error estimate.
//!
//! # Source
//! Sommeijer, Shampine, Verwer (1998), RKC: an explicit solver for parabolic PDEs.

use super::WearRate;

/// Counts of one or more wear steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WearStepStats {
    /// Evaluations of the wear rate.
    pub stages: u64,
    /// Sub-steps refused and halved.
    pub rejected: u64,
}

/// The step could not reach its tolerance; carries the error over its bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WearStepFailed(pub f64);

/// Scratch and state of the wear step of one joint.
#[derive(Debug, Clone)]
pub struct WearStep {
    /// Allowed error relative to the largest wear the step adds [1].
    tolerance: f64,
    /// Direction of the stiffest mode found so far.
    stiffest: Vec<f64>,
}

/// Most stages of one sub-step.
const MOST_STAGES: usize = 50;
/// Sub-steps are at least this fraction of the block.
const SMALLEST: f64 = 1.0 / 1024.0;

impl WearStep {
    /// For `points` control points.
    pub fn new(points: usize, tolerance: f64) -> Self {
        let stiffest = (0..points).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        WearStep { tolerance, stiffest }
    }

    /// Advances `depth` by `cycles` under the frozen history in `rate`.
    ///
    /// # Errors
    /// [`WearStepFailed`] if a sub-step of 1/1024 of the block still misses the tolerance.
    pub fn advance(
        &mut self,
        rate: &mut WearRate,
        depth: &mut [f64],
        cycles: f64,
        stats: &mut WearStepStats,
    ) -> Result<(), WearStepFailed> {
        let n = depth.len();
        let mut f0 = vec![0.0; n];
        rate.rate(depth, &mut f0);
        stats.stages += 1;
        let mut end = vec![0.0; n];
        let mut f1 = vec![0.0; n];
        let (mut done, mut step) = (0.0, cycles);
        while done < cycles {
            step = step.min(cycles - done);
            let radius = self.spectral_radius(rate, depth, &f0, stats);
            let stages = ((1.0 + 1.54 * step * radius).sqrt().ceil() as usize + 1).max(2);
            if stages > MOST_STAGES {
                step *= 0.5;
                stats.rejected += 1;
                if step < SMALLEST * cycles {
                    return Err(WearStepFailed(f64::INFINITY));
                }
                continue;
            }
            chebyshev(rate, depth, &f0, step, stages, &mut end);
            rate.rate(&end, &mut f1);
            stats.stages += stages as u64;
            // Wear only grows: what the stages undershoot (below the tolerance) is not given back.
            let mut error: f64 = 0.0;
            let mut added: f64 = 0.0;
            for i in 0..n {
                error = error.max((0.8 * (depth[i] - end[i]) + 0.4 * step * (f0[i] + f1[i])).abs());
                added = added.max(end[i] - depth[i]);
            }
            let relative = if added > 0.0 { error / (self.tolerance * added) } else { 0.0 };
            if relative > 1.0 && added * cycles / step > 1e-15 {
                step *= (0.8 / relative.cbrt()).clamp(0.1, 0.5);
                stats.rejected += 1;
                if step < SMALLEST * cycles {
                    return Err(WearStepFailed(relative));
                }
                continue;
            }
            for i in 0..n {
                depth[i] = depth[i].max(end[i]);
            }
            std::mem::swap(&mut f0, &mut f1);
            done += step;
            step *= (0.8 / relative.max(1e-3).cbrt()).clamp(0.5, 4.0);
        }
        Ok(())
    }

    /// Largest eigenvalue of -d rate/d depth by a few power iterations, with a margin of a quarter [1/cycle].
    fn spectral_radius(
        &mut self,
        rate: &mut WearRate,
        depth: &[f64],
        f0: &[f64],
        stats: &mut WearStepStats,
    ) -> f64 {
        let n = depth.len();
        let mut moved = vec![0.0; n];
        let mut f = vec![0.0; n];
        // A tenth of a micrometre: the scale of the penetration, so that kinks of the rate are averaged over.
        let size = 1e-8;
        let mut radius = 0.0;
        for _ in 0..2 {
            let norm = self.stiffest.iter().map(|v| v * v).sum::<f64>().sqrt();
            if norm <= 0.0 {
                return radius;
            }
            for i in 0..n {
                moved[i] = depth[i] + size * self.stiffest[i] / norm;
            }
            rate.rate(&moved, &mut f);
            stats.stages += 1;
            for i in 0..n {
                self.stiffest[i] = (f[i] - f0[i]) / size;
            }
            radius = self.stiffest.iter().map(|v| v * v).sum::<f64>().sqrt();
        }
        1.25 * radius
    }
}

/// One step of the second-order Runge-Kutta-Chebyshev method with `s` >= 2 stages.
fn chebyshev(rate: &mut WearRate, y0: &[f64], f0: &[f64], h: f64, s: usize, y: &mut [f64]) {
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
    let mut before = y0.to_vec();
    let mut last: Vec<f64> = (0..n).map(|i| y0[i] + b(1) * w1 * h * f0[i]).collect();
    let mut f = vec![0.0; n];
    for j in 2..=s {
        rate.rate(&last, &mut f);
        let mu = 2.0 * b(j) * w0 / b(j - 1);
        let nu = -b(j) / b(j - 2);
        let mu_t = 2.0 * b(j) * w1 / b(j - 1);
        let gamma_t = -(1.0 - b(j - 1) * t[j - 1].0) * mu_t;
        for i in 0..n {
            y[i] = (1.0 - mu - nu) * y0[i]
                + mu * last[i]
                + nu * before[i]
                + mu_t * h * f[i]
                + gamma_t * h * f0[i];
        }
        std::mem::swap(&mut before, &mut last);
        last.copy_from_slice(y);
    }
}
