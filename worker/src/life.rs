//! The life as a sequence of blocks, and outputs between the cycles that were simulated.

use crate::interpolate::{Cubic, fritsch_butland};

/// Cycles at which a cycle is simulated: 0, then a graded first block (a new bore wears fastest), then every
/// `jump` cycles (rounded to the checkpoints), to the end of life.
pub fn boundaries(cycles: u32, jump: u32, every: u32) -> Vec<u32> {
    let jump = match jump.clamp(1, cycles) {
        jump if jump >= every => jump / every * every,
        jump => (1..=jump).rev().find(|j| every.is_multiple_of(*j)).unwrap_or(1),
    };
    let mut all = vec![0];
    all.extend([16, 8, 4, 2].iter().map(|d| jump / d).filter(|&c| c > 0));
    let mut at = jump;
    while at < cycles {
        all.push(at);
        at += jump;
    }
    all.push(cycles);
    all.dedup();
    all
}

/// Largest length of the block that the graded start of a life with chosen blocks ends in, in checkpoints.
const START: u32 = 2;
/// A block is longer than the one before it by this factor at most.
const GROWTH: f64 = 2.0;

/// Chooses the lives at which a cycle is simulated, one after the other.
///
/// A block of length T is chosen such that two errors stay below the tolerance, as far as what is known by then tells.
/// Half of T times the change of the wear rate over a block is what freezing the contact adds to the depth;
/// relative to the depth it grows as T^2. A straight line between two simulated cycles misses an output of the motion
/// by T^2 |y''| / 8 at most; y'' is that of the parabola through the last three.
#[derive(Debug, Clone)]
pub struct Course {
    cycles: u32,
    every: u32,
    largest: u32,
    tolerance: f64,
    lives: Vec<u32>,
    /// Lives known beforehand, in reverse.
    given: Vec<u32>,
    /// Limit of every output of the motion in its unit; infinite of others.
    limits: Vec<f64>,
    /// Outputs at the last three lives at most.
    measured: Vec<(f64, Vec<f64>)>,
    /// Longest block that freezing the contact allows [cycle].
    frozen: f64,
}

impl Course {
    /// Through a life of `cycles`, in blocks of at most `largest` that end at checkpoints, `every` so many cycles apart.
    /// `limits` are what errors of the outputs are relative to. With a tolerance of zero all blocks are those of
    /// [`boundaries`].
    pub fn new(cycles: u32, largest: u32, every: u32, tolerance: f64, limits: Vec<f64>) -> Self {
        let chosen = tolerance > 0.0 && largest > START * every;
        let mut given = boundaries(cycles, if chosen { START * every } else { largest }, every);
        if chosen {
            given.retain(|&life| life <= (START * every).min(cycles));
        }
        given.reverse();
        let lives = given.pop().into_iter().collect();
        Course { cycles, every, largest, tolerance, lives, given, limits, measured: vec![], frozen: f64::MAX }
    }

    /// Lives so far, from zero.
    pub fn lives(&self) -> &[u32] {
        &self.lives
    }

    /// Takes notice of what freezing the contact over a block of `length` [cycle] added to the depth, relative to it.
    pub fn froze(&mut self, length: f64, relative: f64) {
        self.frozen = if relative > 0.0 { length * (self.tolerance / relative).sqrt() } else { f64::MAX };
    }

    /// Takes notice of the outputs at the life reached.
    pub fn measured(&mut self, values: &[f64]) {
        if self.measured.len() == 3 {
            self.measured.remove(0);
        }
        let life = self.lives.last().copied().unwrap_or(0);
        self.measured.push((f64::from(life), values.to_vec()));
    }

    /// The next life, which is now the one reached; none at the end.
    pub fn next_life(&mut self) -> Option<u32> {
        let at = self.lives.last().copied().filter(|&at| at < self.cycles)?;
        let life = self.given.pop().unwrap_or_else(|| {
            let before = self.lives.iter().rev().nth(1).copied().unwrap_or(0);
            let longest = (GROWTH * f64::from(at - before)).min(f64::from(self.largest));
            let length = longest.min(self.frozen).min(self.straight());
            let checkpoints = (length / f64::from(self.every)) as u32;
            // From checkpoint to checkpoint, whatever the graded start ended at.
            let life = (at / self.every + checkpoints.max(1)) * self.every;
            life.min(self.cycles)
        });
        self.lives.push(life);
        Some(life)
    }

    /// Longest block over which no output is bent beyond the tolerance [cycle].
    fn straight(&self) -> f64 {
        let [(x0, y0), (x1, y1), (x2, y2)] = self.measured.as_slice() else { return f64::MAX };
        let bend = |k: usize| ((y2[k] - y1[k]) / (x2 - x1) - (y1[k] - y0[k]) / (x1 - x0)) / (x2 - x0);
        // y'' is twice the second divided difference.
        let longest = |k: usize| (4.0 * self.tolerance * self.limits[k] / bend(k).abs()).sqrt();
        (0..self.limits.len()).map(longest).filter(|x| !x.is_nan()).fold(f64::MAX, f64::min)
    }
}

/// Values at the checkpoints from values at the simulated lives: monotone cubic interpolation (Fritsch and
/// Butland), which makes no new extremum between two simulated cycles.
pub fn at_checkpoints(lives: &[u32], values: &[f64], checkpoints: &[u32]) -> Vec<f64> {
    let x: Vec<f64> = lives.iter().map(|&l| f64::from(l)).collect();
    let n = x.len();
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let secant: Vec<f64> = values.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h).collect();
    let slope = |k: usize| -> f64 {
        if n == 2 {
            return secant[0];
        }
        if k == 0 || k == n - 1 {
            // One-sided three-point slope, limited to the same sign and three times the secant.
            let (s0, s1, h0, h1) = if k == 0 {
                (secant[0], secant[1], h[0], h[1])
            } else {
                (secant[n - 2], secant[n - 3], h[n - 2], h[n - 3])
            };
            let d = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
            return if d * s0 <= 0.0 { 0.0 } else { d.abs().min(3.0 * s0.abs()).copysign(s0) };
        }
        fritsch_butland([h[k - 1], h[k]], [secant[k - 1], secant[k]])
    };
    checkpoints
        .iter()
        .map(|&c| {
            let c = f64::from(c);
            let k = x.partition_point(|&l| l < c).clamp(1, n - 1) - 1;
            let s = (c - x[k]) / h[k];
            if s == 1.0 {
                return values[k + 1];
            }
            Cubic::hermite([values[k], values[k + 1]], [slope(k) * h[k], slope(k + 1) * h[k]]).value(s)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_meet_every_checkpoint_they_can() {
        assert_eq!(boundaries(6000, 2000, 1000), [0, 125, 250, 500, 1000, 2000, 4000, 6000]);
        assert_eq!(boundaries(1000, 300, 1000)[..6], [0, 15, 31, 62, 125, 250]);
        assert_eq!(boundaries(5000, 2000, 1000).last(), Some(&5000));
        assert_eq!(boundaries(3, 2000, 1), [0, 1, 3]);
    }

    /// Lives of a course whose output is `value`, with a wear that freezing the contact over T cycles makes wrong by
    /// `frozen` T^2.
    fn course(largest: u32, tolerance: f64, frozen: f64, value: impl Fn(f64) -> f64) -> Vec<u32> {
        let mut course = Course::new(72_000, largest, 1000, tolerance, vec![2.0]);
        course.measured(&[value(0.0)]);
        let mut before = 0.0;
        while let Some(life) = course.next_life() {
            let life = f64::from(life);
            course.froze(life - before, frozen * (life - before) * (life - before));
            course.measured(&[value(life)]);
            before = life;
        }
        course.lives().to_vec()
    }

    #[test]
    fn without_a_tolerance_blocks_are_those_of_the_largest_jump() {
        for jump in [500, 2000, 8000] {
            assert_eq!(course(jump, 0.0, 1.0, |n| n * n), boundaries(72_000, jump, 1000));
        }
    }

    #[test]
    fn blocks_are_as_long_as_both_errors_allow() {
        // Nothing bends and nothing is frozen: from the graded start up to the largest.
        let free = course(8000, 1e-2, 0.0, |n| 1e-3 * n);
        assert_eq!(free[..9], [0, 125, 250, 500, 1000, 2000, 4000, 8000, 16_000]);
        assert!(free.windows(2).all(|w| w[1] - w[0] <= 8000) && free.last() == Some(&72_000));
        // T^2 y'' / 8 = tolerance times limit at T = 4000; so is the frozen share.
        let lengths = |lives: &[u32]| lives[7..].windows(2).map(|w| w[1] - w[0]).collect::<Vec<u32>>();
        let bent = course(8000, 1.01e-2, 0.0, |n| 0.5e-8 * n * n);
        let wearing = course(8000, 1.01e-2, 1e-2 / 16e6, |n| 1e-3 * n);
        for lives in [bent, wearing] {
            assert!(lengths(&lives).iter().all(|&length| length == 4000), "{lives:?}");
        }
    }

    #[test]
    fn a_kink_shortens_the_blocks_behind_it() {
        let lives = course(8000, 1e-3, 0.0, |n| 1.0 + 2e-5 * (n - 50_000.0).max(0.0));
        let after: Vec<u32> = lives.iter().copied().filter(|&n| n > 50_000).collect();
        assert!(after[1] - after[0] < 4000, "{lives:?}");
    }

    #[test]
    fn interpolation_keeps_simulated_values_and_straight_lines() {
        let lives = [0, 125, 500, 2000, 4000];
        let line: Vec<f64> = lives.iter().map(|&l| 3.0 + 0.5 * f64::from(l)).collect();
        for (c, v) in [(125, 65.5), (1000, 503.0), (3000, 1503.0), (4000, 2003.0)] {
            assert!((at_checkpoints(&lives, &line, &[c])[0] - v).abs() < 1e-9);
        }
        let bumpy = [1.0, 4.0, 2.0, 2.5, 9.0];
        assert_eq!(at_checkpoints(&lives, &bumpy, &lives), bumpy);
    }
}
