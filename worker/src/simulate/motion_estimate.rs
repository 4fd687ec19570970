//! What the cycles simulated under one operating condition show of the error of an evaluation (`error_estimate.rs`): probes, the spread
//! of several motions, and what the quasi-static model was off by.

use super::probe::{FinerCycles, Probe};
use super::repetition::Repetition;
use super::run::Run;
use super::several_cycles::{CycleSpread, MOTIONS, mean_and_variance};

/// Error of the motion outputs over their change in a probe [1]: both cycles start from a state computed with the coarser
/// steps, and a vibration differs from cycle to cycle. With this factor and [`WEAR_SAFETY`] 659 of 662 wear depths and all
/// 662 values of the motion lie within their estimate of the values of `reference`, the worst at 1.14 and 0.67 of it:
/// three samples each of `flapping-wing` and `four-bar` and one of `flapping-wing-tolerances`, `draft` and
/// `balanced`, and the nominal `flapping-wing` under `foundation` to 24 000 cycles, `balanced`.
const MOTION_SAFETY: f64 = 2.5;
/// Error of the wear rates over their change in a probe [1].
const WEAR_SAFETY: f64 = 2.0;
/// Further factor of both for an aperiodic motion [1]: with friction 0.5 the flapping wing's asymmetry was off by up to 3 times the
/// estimate without it.
const APERIODIC_SAFETY: f64 = 3.0;
/// Error over the irregularity of an output that is erratic or whose motion is aperiodic [1]. With values that scatter independently by
/// sigma around a straight line, 95 % of the differences of two of them are below 2.8 sigma, and the largest of a few distances from the line
/// through both neighbours is about 1.3 sigma.
const IRREGULAR_SAFETY: f64 = 2.0;
/// Bends of unlike sign at two successive lives, as a share of the largest value, above which an output is erratic [1]: it depends on
/// details of the bores, which another time step or inputs off by rounding change. Those of `flapping-wing` and `four-bar` are below 8e-5;
/// with a friction of 0.5 the asymmetry of the wing, the same in every cycle on given bores to 1e-4, has some of 1e-2.
const ERRATIC: f64 = 2e-4;
/// Lower bound of the relative error of the motion on worn bores [1]. Other time steps cut the history of the
/// contact elsewhere, and the bore worn by it differs by a little that no probe shows, since a probe runs on the same bore: with a
/// wear coefficient ten times that of `flapping-wing`, half the step changes its asymmetry by 5e-5.
const WORN_MOTION: f64 = 1e-4;
/// Stated error over the standard deviation of what is scattered [1]. With it 47 to 50 depths of 50 starts of `slider-crank`
/// are within their stated errors, at every checkpoint (`worker/tests/evaluation/rattling.rs`).
const SCATTER: f64 = 2.0;

/// Scatter below which an output counts as the same in all cycles, over its value: rounding [1].
const SAME: f64 = 1e-9;

/// Outputs measured in the simulated cycles of a life.
pub struct MeasuredLives<'a> {
    /// Lives at which a cycle was simulated `(k,)` [cycles].
    pub lives: &'a [u32],
    /// Outputs there, zero for outputs of the wear `(k, outputs)` [SI].
    pub outputs: &'a [Vec<f64>],
}

impl MeasuredLives<'_> {
    /// Values of one output `(k,)` [SI].
    pub(crate) fn of_output(&self, output: usize) -> Vec<f64> {
        self.outputs.iter().map(|values| values[output]).collect()
    }
}

/// Probes of one operating condition, and the work that its contacts have done.
#[derive(Clone, Default)]
pub struct MotionEstimate {
    /// Life of the first checkpoint [cycles].
    pub first_checkpoint: u32,
    /// How the motion repeats itself.
    pub repetition: Repetition,
    /// Probes made so far; lives ascend.
    pub probes: Vec<Probe>,
    /// If the quasi-static model drives the wear, the largest relative difference of its wear rates from those of the dynamics [1].
    pub quasi_static: Option<f64>,
    /// Spread of the cycles at each simulated life of a motion that does not repeat itself, else empty; lives ascend.
    pub spreads: Vec<CycleSpread>,
    /// Comparisons with surfaces of more control points; lives ascend.
    pub finer: Vec<FinerCycles>,
    /// Volume that the blocks added so far have worn from every surface of every joint of the scene `(SURFACES joints,)` [m^3].
    pub worn: Vec<f64>,
}

impl MotionEstimate {
    /// An estimate for a life whose first checkpoint is at `first_checkpoint` [cycles].
    pub(crate) fn new(first_checkpoint: u32) -> Self {
        MotionEstimate { first_checkpoint, ..MotionEstimate::default() }
    }

    /// Adds a probe; lives ascend. Where a motion settles slowly, what the next cycle changes is the first part of what is to come.
    pub(crate) fn add_probe(&mut self, mut probe: Probe) {
        let factor = self.repetition.slowness.max(1.0);
        probe.motion.iter_mut().chain(&mut probe.wear).for_each(|change| *change *= factor);
        self.probes.push(probe);
    }

    /// Adds a block of `cycles` that wore under the contacts of the cycle just simulated.
    pub(crate) fn add_block(&mut self, run: &Run, cycles: u32) {
        let per_cycle = run.volume_per_cycle();
        self.worn.resize(per_cycle.len(), 0.0);
        for (worn, volume) in self.worn.iter_mut().zip(per_cycle) {
            *worn += run.share * f64::from(cycles) * volume;
        }
    }

    /// True if the motion does not repeat itself, so that several wear the bores.
    pub(crate) fn has_several_motions(&self) -> bool {
        !self.spreads.is_empty()
    }

    /// Largest relative difference of the quasi-static wear rates from those of the dynamics; zero if these drive the wear [1].
    pub(crate) fn tier_difference(&self) -> f64 {
        self.quasi_static.unwrap_or(0.0)
    }

    /// Error of output `k` of the motion at every one of the `checkpoints` `(m,)` [cycles], given its `history` there `(m,)`;
    /// `missed_peak` is the share of a peak missed between two time steps and `behind` the relative error of the wear at a life [1].
    pub(crate) fn motion_errors(
        &self,
        k: usize,
        (checkpoints, history): (&[u32], &[f64]),
        measured: &MeasuredLives,
        missed_peak: f64,
        behind: impl Fn(u32) -> f64,
    ) -> Vec<f64> {
        let values = measured.of_output(k);
        let to_come = self.repetition.to_come.as_ref().map_or(0.0, |(motion, _)| motion[k]);
        if self.has_several_motions() {
            let scatter = SCATTER * self.largest_variance(k).sqrt();
            // All motions see the same bores: what follows from these alone does not scatter, and has the error of the wear.
            let of_wear = |life: u32, value: f64| {
                if scatter > SAME * value.abs() || measured.lives.len() < 2 {
                    return 0.0;
                }
                let (_, slope) = neighbours(measured.lives, &values, life);
                slope * behind(life) * f64::from(life)
            };
            let checkpoints = checkpoints.iter().zip(history);
            return checkpoints
                .map(|(&life, &value)| to_come + scatter + missed_peak * value.abs() + of_wear(life, value))
                .collect();
        }
        let irregular = self.irregularity(measured.lives, &values);
        let erratic = IRREGULAR_SAFETY * erratic_bend(measured.lives, &values);
        let checkpoints = checkpoints.iter().zip(history);
        checkpoints
            .map(|(&life, value)| {
                let (secant, slope) = neighbours(measured.lives, &values, life);
                let behind = behind(life) * f64::from(life);
                to_come
                    + MOTION_SAFETY * self.largest_near(life, |p| p.motion[k])
                    + (missed_peak + WORN_MOTION) * value.abs()
                    + (value - secant).abs()
                    + (self.irregularity_share(life) * irregular).max(erratic)
                    + slope * behind
            })
            .collect()
    }

    /// Largest variance of an output of the motion over single cycles, of all simulated lives [SI^2].
    fn largest_variance(&self, output: usize) -> f64 {
        self.spreads.iter().map(|spread| spread.motion[output]).fold(0.0, f64::max)
    }

    /// Relative error of the wear rates of a surface up to `life` from the cycles that were simulated [1].
    pub(crate) fn relative_rate_error(&self, surface: usize, life: u32) -> f64 {
        let to_come = self.repetition.to_come.as_ref().map_or(0.0, |(_, wear)| wear[surface]);
        if self.spreads.is_empty() {
            to_come + WEAR_SAFETY * self.largest_near(life, |p| p.wear[surface])
        } else {
            to_come + SCATTER * self.scatter_of_depth(surface)
        }
    }

    /// Standard error of the mean over all motions of a surface's depth over the depth [1]: the root of the mean, over the ends of the
    /// blocks from the first checkpoint on, of
    ///
    ///   sum of s_i^2 / (M sum of D_i^2)
    ///
    /// over the control points at least half as deep as the deepest, with the mean D_i [m] and the variance s_i^2 [m^2] of what M motions
    /// have worn. These ratios differ little along a life.
    fn scatter_of_depth(&self, surface: usize) -> f64 {
        let mut worn = vec![vec![0.0; self.spreads[0].wear[0][surface].len()]; MOTIONS];
        let (mut sum, mut ends) = (0.0, 0.0);
        for (spread, next) in self.spreads.iter().zip(&self.spreads[1..]) {
            let cycles = f64::from(next.life - spread.life);
            for (worn, rates) in worn.iter_mut().zip(&spread.wear) {
                worn.iter_mut().zip(&rates[surface]).for_each(|(depth, rate)| *depth += cycles * rate);
            }
            let (mean, variance) = mean_and_variance(&worn);
            let deepest = mean.iter().fold(0.0_f64, |a, &b| a.max(b));
            let deep = mean.iter().zip(&variance).filter(|(mean, _)| 2.0 * **mean >= deepest);
            let (squares, variances) = deep.fold((0.0, 0.0), |(a, b), (mean, v)| (a + mean * mean, b + v));
            if next.life >= self.first_checkpoint && squares > 0.0 {
                ends += 1.0;
                sum += variances / (MOTIONS as f64 * squares);
            }
        }
        if ends > 0.0 { (sum / ends).sqrt() } else { 0.0 }
    }

    /// Estimated error of output `k` at `life` that the number of control points leaves [SI]: the larger of the comparisons around it.
    pub(crate) fn points_error(&self, k: usize, life: u32) -> f64 {
        let next = self.finer.partition_point(|cycles| cycles.life < life);
        let around = &self.finer[next.saturating_sub(1)..(next + 1).min(self.finer.len())];
        around.iter().map(|cycles| cycles.error(k).0).fold(0.0, f64::max)
    }

    /// The two probes around `life`, or the one next to it.
    fn around(&self, life: u32) -> &[Probe] {
        let next = self.probes.partition_point(|p| p.life < life);
        &self.probes[next.saturating_sub(1)..(next + 1).min(self.probes.len())]
    }

    /// True if one of the two probes around `life`, or the one on the unworn bores, found a motion that does not repeat itself.
    fn is_aperiodic_near(&self, life: u32) -> bool {
        let unworn = self.probes.first().is_some_and(|p| p.life == 0 && p.aperiodic);
        unworn || self.around(life).iter().any(|p| p.aperiodic)
    }

    /// The larger value of the two probes around `life`; of an aperiodic motion at least [`APERIODIC_SAFETY`] times the largest value of
    /// all probes that found one: a few cycles of it show only a part of its spread.
    fn largest_near(&self, life: u32, value: impl Fn(&Probe) -> f64) -> f64 {
        let largest = self.around(life).iter().map(&value).fold(0.0, f64::max);
        if self.is_aperiodic_near(life) {
            let aperiodic = self.probes.iter().filter(|p| p.aperiodic);
            return largest.max(APERIODIC_SAFETY * aperiodic.map(value).fold(0.0, f64::max));
        }
        largest
    }

    /// Share of the irregularity that counts at `life` [1]: [`IRREGULAR_SAFETY`] where the motion is aperiodic, since it shows what
    /// details of the bore do to an output; one where the quasi-static model drives the wear, since it shows how far an output is
    /// from what is interpolated between a few lives; else zero.
    fn irregularity_share(&self, life: u32) -> f64 {
        if self.is_aperiodic_near(life) {
            IRREGULAR_SAFETY
        } else if self.quasi_static.is_some() {
            1.0
        } else {
            0.0
        }
    }

    /// Irregularity of an output, its largest bend over the `lives` `(k,)` [cycles] where it counts.
    fn irregularity(&self, lives: &[u32], values: &[f64]) -> f64 {
        let inner = bends(lives, values).zip(lives.iter().skip(1));
        largest(inner.filter(|(_, life)| self.irregularity_share(**life) > 0.0).map(|(bend, _)| bend))
    }
}

/// Distances of the straight lines through the two neighbours of every value from the value; positive where the line is above it
/// `(k - 2,)`.
fn bends(lives: &[u32], values: &[f64]) -> impl Iterator<Item = f64> {
    lives.windows(3).zip(values.windows(3)).map(|(life, value)| {
        let share = f64::from(life[1] - life[0]) / f64::from(life[2] - life[0]);
        value[0] + share * (value[2] - value[0]) - value[1]
    })
}

/// Largest of these distances.
pub(crate) fn largest_bend(lives: &[u32], values: &[f64]) -> f64 {
    largest(bends(lives, values))
}

/// Largest bend of an output that goes up and down from one of the `lives` `(k,)` [cycles] to the next: of two successive bends of unlike sign
/// that both exceed [`ERRATIC`] of the largest value; zero without any. A curve that the lives resolve has bends of like sign, or small ones.
fn erratic_bend(lives: &[u32], values: &[f64]) -> f64 {
    let least = ERRATIC * largest(values.iter().copied());
    let bends: Vec<f64> = bends(lives, values).collect();
    let is_zigzag = |pair: &&[f64]| pair[0] * pair[1] < 0.0 && pair.iter().all(|bend| bend.abs() > least);
    largest(bends.windows(2).filter(is_zigzag).flatten().copied())
}

/// Largest magnitude of these `values`, zero without any.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| largest.max(value.abs()))
}

/// Value at `life` of the straight line between the simulated lives around it, and the steepest slope there or next to it.
fn neighbours(lives: &[u32], values: &[f64], life: u32) -> (f64, f64) {
    let slope = |k: usize| (values[k + 1] - values[k]) / f64::from(lives[k + 1] - lives[k]);
    let last = lives.len() - 2;
    let k = lives.partition_point(|&l| l < life).clamp(1, last + 1) - 1;
    let steepest = (k.saturating_sub(1)..=(k + 1).min(last)).fold(0.0_f64, |a, k| a.max(slope(k).abs()));
    (values[k] + slope(k) * f64::from(life - lives[k]), steepest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn probe(life: u32, motion: f64, wear: f64) -> Probe {
        Probe { life, motion: vec![motion], wear: vec![wear], aperiodic: false, rattles: false }
    }

    #[test]
    fn between_two_probes_the_larger_change_counts() {
        let probes = vec![probe(10, 1.0, 0.1), probe(30, 3.0, 0.3), probe(90, 2.0, 0.2)];
        let estimate = MotionEstimate { probes, ..MotionEstimate::default() };
        let motion = |life| estimate.largest_near(life, |p| p.motion[0]);
        assert_eq!([5, 10, 20, 30, 31, 90].map(motion), [1.0, 1.0, 3.0, 3.0, 3.0, 3.0]);
    }

    #[test]
    fn an_aperiodic_motion_adds_its_irregularity_where_it_was_found() {
        let aperiodic = Probe { aperiodic: true, ..probe(40, 1.0, 0.1) };
        let probes = vec![probe(0, 1.0, 0.1), probe(20, 1.0, 0.1), aperiodic];
        let estimate = MotionEstimate { probes, ..MotionEstimate::default() };
        assert_eq!([10, 20, 21, 40].map(|life| estimate.is_aperiodic_near(life)), [false, false, true, true]);
        // Off the line by 4 at life 10, where the motion is periodic, and by 2 at life 30.
        let (lives, values) = ([0, 10, 20, 30, 40], [0.0, 4.0, 0.0, 2.0, 0.0]);
        assert_eq!(estimate.irregularity(&lives, &values), 2.0);
    }

    #[test]
    fn values_that_go_up_and_down_are_erratic() {
        let lives = [0, 10, 20, 40, 80];
        let curve = |life: &u32| 10.0 * f64::from(*life) - 0.05 * f64::from(*life).powi(2);
        let of = |off: f64| -> Vec<f64> {
            let signs = [1.0, -1.0].into_iter().cycle();
            lives.iter().map(curve).zip(signs).map(|(value, sign)| value + sign * off).collect()
        };
        // The curve bends by -5, -10 and -40, the values off by 3 to both sides by 6, -6 and 6; the largest is 483.
        assert_eq!(erratic_bend(&lives, &of(0.0)), 0.0);
        assert!((erratic_bend(&lives, &of(3.0)) - 16.0).abs() < 1e-12);
        assert_eq!([&lives[..3], &[]].map(|lives| erratic_bend(lives, &of(3.0)[..lives.len()])), [0.0; 2]);
    }

    #[test]
    fn a_straight_line_is_interpolated_without_error() {
        let (lives, values) = ([0, 10, 30, 70], [1.0, 2.0, 4.0, 8.0]);
        for (life, value) in [(10, 2.0), (15, 2.5), (70, 8.0)] {
            let (line, slope) = neighbours(&lives, &values, life);
            assert!((line - value).abs() < 1e-12 && (slope - 0.1).abs() < 1e-12);
        }
    }

    #[test]
    fn what_follows_from_the_bores_alone_has_the_error_of_their_wear_with_several_motions_too() {
        let error = |variance| {
            let spread = CycleSpread { life: 100, motion: vec![variance], wear: vec![] };
            let estimate = MotionEstimate { spreads: vec![spread], ..MotionEstimate::default() };
            let measured = MeasuredLives { lives: &[0, 100], outputs: &[vec![1.0], vec![3.0]] };
            estimate.motion_errors(0, (&[100], &[3.0]), &measured, 0.0, |_| 0.1)[0]
        };
        // It grows by 0.02 a cycle, and the wear is off by a tenth of 100 cycles.
        assert!((error(0.0) - 0.2).abs() < 1e-12, "{}", error(0.0));
        assert_eq!(error(0.25), SCATTER * 0.5);
    }
}
