//! The quasi-static tier of an evaluation: a whole life's wear from the gaps alone, held against the dynamics on
//! the unworn bores and on those at the end of life.

use super::life::{Lived, live};
use super::moving::SMALLEST_STEP;
use super::run::Run;
use crate::mechanism::ideal_cycle;
use crate::outputs::{Recorder, Wanted};
use crate::quasi_static::{Follow, FollowStats, StepBounds, Unsuitable, ideal_motions, largest_difference};
use common::accuracy::Tier;
use common::scene::{Output, OutputKind};

/// Intervals of the tabulated ideal motion; twice as many change the wear of the built-in scenes by less than
/// 1e-4.
const IDEAL_INTERVALS: usize = 90;
/// Largest step as a fraction of the cycle. The wear would bear 1/200; coarser histories make the wear rates,
/// point by point, too rough for the comparison with the dynamics.
const LARGEST_STEP: f64 = 1.0 / 300.0;
/// Bound on the local error of a step, in the scales of the gaps (1 % of the smallest clearance): where contact
/// lasts the largest step rules, and four times the bound changes the wear by less than 1e-4.
const STEP_TOLERANCE: f64 = 0.05;

/// One island that follows its ideal motion.
#[derive(Clone)]
pub struct Guided {
    pub follow: Follow,
    pub recorder: Recorder,
    /// Gaps from which the next run-up starts.
    saved: Vec<f64>,
}

/// The whole life under the quasi-static tier, if the accuracy leaves the choice, the scene asks for nothing but
/// wear and both comparisons agree; else none, with `run` as it was but for its counts.
pub async fn wear_alone(run: &mut Run<'_>) -> Option<Lived> {
    let mut trial = run.clone();
    match trial.live_quasi_statically().await {
        Ok(lived) => {
            *run = trial;
            Some(lived)
        }
        Err(reason) => {
            tracing::debug!("the dynamics drives the wear: {reason}");
            run.take_counts(&trial);
            None
        }
    }
}

impl Run<'_> {
    /// The whole life under the quasi-static tier, from the settled first cycle just measured.
    ///
    /// # Errors
    /// [`Unsuitable`] if the dynamics has to drive the wear instead.
    async fn live_quasi_statically(&mut self) -> Result<Lived, Unsuitable> {
        self.try_gaps()?;
        let mut lived = live(self, async |run: &mut Run| run.follow(), false).await?;
        // The dynamics once more, on the worn bores, from where the gaps have carried the mechanism.
        self.last_cycle().await?;
        self.agree()?;
        for ((errors, values), share) in
            lived.errors.iter_mut().zip(&lived.histories).zip(&self.tier_difference)
        {
            errors.iter_mut().zip(values).for_each(|(error, value)| *error += share * value.abs());
        }
        Ok(lived)
    }

    /// Puts the tier in charge and compares it with the settled first cycle just measured, on the unworn bores.
    fn try_gaps(&mut self) -> Result<(), Unsuitable> {
        if self.accuracy.tier == Tier::Dynamic {
            return Err(Unsuitable::Unwanted);
        }
        self.guide()?;
        self.follow()?;
        self.agree()
    }

    /// Whether the tier may drive the wear, by that comparison: the largest relative difference of the wear rates.
    ///
    /// # Errors
    /// [`Unsuitable`] if the dynamics has to.
    pub fn usable_tier(&self) -> Result<f64, Unsuitable> {
        let mut trial = self.clone();
        trial.try_gaps()?;
        Ok(trial.tier_difference.iter().copied().fold(0.0, f64::max))
    }

    /// Takes over the counts of an attempt that began as a copy of this run.
    fn take_counts(&mut self, attempt: &Run) {
        self.stats = attempt.stats;
        self.wear_stats = attempt.wear_stats;
        self.newton = attempt.newton;
        self.simulated = attempt.simulated;
    }

    /// Puts every island on its ideal motion, all joints closed.
    fn guide(&mut self) -> Result<(), Unsuitable> {
        let wear = |o: &&Output| matches!(o.kind, OutputKind::LargestWear { .. });
        if let Some(output) = self.scene.outputs.iter().find(|o| !wear(o)) {
            return Err(Unsuitable::Output { output: output.name.clone() });
        }
        let period = self.scene.life.period;
        let poses = ideal_cycle(self.scene, IDEAL_INTERVALS + 1, &mut self.newton)?;
        if poses.len() < 2 {
            return Err(Unsuitable::Undetermined);
        }
        let islands: Vec<_> = self.islands.iter().map(|m| &m.island).collect();
        let bounds = StepBounds {
            largest: LARGEST_STEP * period,
            smallest: SMALLEST_STEP * period,
            most: self.accuracy.steps_bound,
        };
        let samples = (1.0 / LARGEST_STEP) as usize;
        self.guided = ideal_motions(self.scene, &islands, &poses)?
            .into_iter()
            .zip(islands)
            .map(|(ideal, island)| Guided {
                saved: vec![0.0; ideal.coordinates()],
                follow: Follow::new(ideal, island.linearised(), STEP_TOLERANCE, bounds),
                recorder: Recorder::new(island, self.scene, &Wanted::default(), samples),
            })
            .collect();
        Ok(())
    }

    /// Runs the gaps up on the bores as they are, then a recorded cycle; keeps the state from which the next
    /// run-up starts, of the dynamics too.
    fn follow(&mut self) -> Result<(), Unsuitable> {
        let period = self.scene.life.period;
        let kept = (1.0 - self.accuracy.warm_up).max(0.0) * period;
        let mut stats = FollowStats::default();
        let mut done = Ok(());
        for (m, g) in self.islands.iter_mut().zip(&mut self.guided) {
            done = done.and_then(|()| {
                g.follow.begin(&mut m.island, kept - period, &g.saved, &mut stats)?;
                g.follow.run(&mut m.island, 0.0, &mut (), &mut stats)?;
                g.recorder.clear();
                g.follow.run(&mut m.island, kept, &mut g.recorder, &mut stats)?;
                g.saved.copy_from_slice(g.follow.gaps());
                let (q, v) = g.follow.state();
                m.saved.keep(&m.island, q, v);
                g.follow.run(&mut m.island, period, &mut g.recorder, &mut stats)?;
                g.recorder.finish();
                Ok(())
            });
        }
        self.stats.steps += stats.steps;
        self.stats.rejected += stats.refused;
        self.stats.forces += stats.iterations;
        self.newton += stats.iterations;
        self.simulated += 1;
        done
    }

    /// Compares the wear rates of the two cycles last recorded, quasi-static and dynamic, on the bores as they
    /// are, and keeps the largest difference seen for each output.
    ///
    /// # Errors
    /// [`Unsuitable::Disagrees`] if an output's rates differ by more than the tolerance of the wear.
    fn agree(&mut self) -> Result<(), Unsuitable> {
        let none = || vec![vec![]; self.scene.joints.len()];
        let (mut guided, mut dynamic) = (none(), none());
        for (m, g) in self.islands.iter_mut().zip(&self.guided) {
            for (k, joint) in m.island.joints.iter().enumerate() {
                for (rates, recorder) in [(&mut guided, &g.recorder), (&mut dynamic, &m.recorder)] {
                    let mut rate = vec![0.0; joint.profile.points()];
                    m.rates[k].freeze(&recorder.histories[k]);
                    m.rates[k]
                        .rate(&m.depth[k], &mut rate)
                        .map_err(|_| Unsuitable::Disagrees { share: f64::INFINITY })?;
                    rates[joint.scene_joint] = rate;
                }
            }
        }
        for (output, largest) in self.scene.outputs.iter().zip(&mut self.tier_difference) {
            if let OutputKind::LargestWear { joints } = &output.kind {
                let share = largest_difference(&guided, &dynamic, joints);
                if share > self.accuracy.wear_tolerance {
                    return Err(Unsuitable::Disagrees { share });
                }
                *largest = largest.max(share);
            }
        }
        Ok(())
    }
}
