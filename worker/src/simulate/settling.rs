//! Whether a motion repeats itself from cycle to cycle, and further cycles until it does.
//!
//! From the states at the starts of successive cycles, over the scales of the error control, follows the periodic motion that they approach
//! (`repetition.rs`). After a window of cycles the motion goes on from there, where the ideal joints are closed again, until what is still
//! to come is below the tolerance of a time step.
//!
//! A motion whose state at the end of the first measured cycle is that at its start has settled; that costs nothing. The same comparison
//! shows a cycle that begins with the fall into a bore deepened by wear: if an output has its extreme in the start of such a cycle, the
//! cycle after it is measured in its place.

use super::island_state::IslandState;
use super::probe::{Probe, SURFACES};
use super::repetition::{NOT_DECAYING, size, slowness, to_come};
use super::{Run, Simulated};
use crate::integrate::Stepped;
use crate::outputs::{Recorder, is_extreme};
use common::outputs::UnsettledMotion;
use std::f64::consts::{PI, TAU};

/// Change of the state over a cycle, in the scales of the error control, up to which it counts as the same [1]. The scale is 1 % of the
/// smallest clearance.
const SAME: f64 = 0.1;
/// That change over a cycle on a bore that has just been worn: a penetration is stiff, and a hundredth of the scale carries a load [1].
const FALL: f64 = 0.01;
/// Most further settling cycles.
const MOST_FURTHER: u32 = 60;
/// States from which the periodic motion is extrapolated.
const WINDOW: usize = 7;
/// Least share of the change that an extrapolation has to take out, or the motion does not settle [1].
const PROGRESS: f64 = 0.5;
/// Most cycles that are measured again on the same bores.
const MOST_AGAIN: usize = 2;

/// What is still to come of such a motion, over the largest difference of three successive cycles [1].
const WANDERING: f64 = 5.0;
/// Angle from which on a body that turns is distinguished from one that swings in a cycle [rad], and the part of it that counts [1].
const TURNS: f64 = 0.5 * PI;
const PART_OF_TURN: f64 = 1e-3;

/// How far further settling cycles have come.
struct Rest {
    /// Number of further settling cycles simulated.
    cycles: u32,
    is_settled: bool,
    /// As in [`super::repetition::Repetition`]; infinite for a motion whose changes do not decay [1].
    slowness: f64,
}

/// A `change` over its `scale`; zero for none.
fn over(change: f64, scale: f64) -> f64 {
    if change == 0.0 { 0.0 } else { change / scale }
}

impl IslandState {
    /// State (`q`, `v`) at `time` [s] as that at the start of a cycle `(2 n,)` [1].
    fn scaled(&self, (time, q, v): (f64, &[f64], &[f64]), period: f64) -> Vec<f64> {
        let (scale_q, scale_v) = self.island.scales();
        let cycles = (time / period).round();
        let angle = |k: usize| TAU * cycles * self.turns[k / 3];
        let position = |k: usize| if k % 3 == 2 { q[k] - angle(k) } else { q[k] };
        let positions = (0..q.len()).map(|k| position(k) / scale_q[k]);
        positions.chain(v.iter().zip(scale_v).map(|(v, scale)| v / scale)).collect()
    }

    /// The present state as that at the start of a cycle.
    fn scaled_state(&self, period: f64) -> Vec<f64> {
        self.scaled((self.time, &self.q, &self.v), period)
    }

    /// Change between two such states `(2 n,)` [1]; whole turns of a body do not count.
    fn change(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        let (scale_q, _) = self.island.scales();
        let n = scale_q.len();
        let changes = to.iter().zip(from).enumerate().map(|(k, (to, from))| {
            let change = to - from;
            if k < n && k % 3 == 2 {
                let turn = TAU / scale_q[k];
                return change - turn * (change / turn).round();
            }
            change
        });
        changes.collect()
    }

    /// Change of the state over the cycle measured last, from its start to the present end `(2 n,)` [1].
    fn change_over_cycle(&self, period: f64) -> Vec<f64> {
        let start = self.scaled(self.cycle_start.state(), period);
        self.change(&start, &self.scaled_state(period))
    }

    /// Moves the state by `step` `(2 n,)` [1] and closes the ideal joints; false if they cannot be closed.
    fn shift(&mut self, step: &[f64]) -> bool {
        let (scale_q, scale_v) = self.island.scales();
        let n = scale_q.len();
        self.q.iter_mut().zip(scale_q).zip(&step[..n]).for_each(|((q, scale), step)| *q += scale * step);
        self.v.iter_mut().zip(scale_v).zip(&step[n..]).for_each(|((v, scale), step)| *v += scale * step);
        self.stepper.control.after_jump();
        !self.island.is_constrained() || self.island.close(self.time, &mut self.q, &mut self.v).is_some()
    }
}

impl<'a> Run<'a> {
    /// Returns to what the run was `before`; its counts go on.
    pub(crate) fn return_to(&mut self, mut before: Run<'a>) {
        before.copy_counts(self);
        *self = before;
    }

    /// Largest change of the state over the cycle just measured [1].
    fn change_over_cycle(&self) -> f64 {
        let period = self.scene.life.period;
        self.islands.iter().map(|state| size(&state.change_over_cycle(period))).fold(0.0, f64::max)
    }

    /// Simulates the scene's settling cycles from the state of the ideal mechanism, in which the journals come into contact with
    /// their bores.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn settle(&mut self) -> Simulated<()> {
        let period = self.scene.life.period;
        for cycle in (1..=self.scene.life.settle_cycles).rev() {
            let start = -f64::from(cycle) * period;
            self.integrate(start..start + period, false).await?;
            self.simulated += 1;
        }
        Ok(())
    }

    /// Measures the first cycle, of a motion that has settled if it settles.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn measure_first(&mut self) -> Simulated<()> {
        self.measure().await?;
        let change = self.change_over_cycle();
        tracing::debug!("over the first cycle the state changes by {change}");
        if self.scene.life.is_single_cycle() || change <= SAME {
            return Ok(());
        }
        if self.repetition.is_determined {
            // Beside its ideal motion by the clearances alone: what the probes find is all that there is (`probe.rs`).
            return Ok(());
        }
        let before = self.clone();
        let rest = match self.settle_further().await {
            Ok(rest) => rest,
            Err(failure) => {
                tracing::debug!("settling further failed: {failure}");
                self.return_to(before);
                Rest { cycles: 0, is_settled: false, slowness: f64::INFINITY }
            }
        };
        if rest.is_settled {
            self.repetition.slowness = rest.slowness.min(1.0 / (1.0 - NOT_DECAYING));
            return self.measure().await;
        }
        self.measure().await?;
        self.state_what_is_to_come(&rest).await
    }

    /// Notes by how much two further cycles differ from the one just measured, and what that leaves to come.
    async fn state_what_is_to_come(&mut self, rest: &Rest) -> Simulated<()> {
        let mut copy = self.clone();
        copy.begin_count();
        let cycles = [copy.measured_values(0)?, copy.measure_next(0).await?, copy.measure_next(0).await?];
        self.add_counts(&copy);
        let [measured, further @ ..] = &cycles;
        let mut changes = Probe::unchanged(0, measured);
        further.iter().for_each(|cycle| {
            changes.add_cycle(measured, cycle);
        });
        let factor = if rest.slowness.is_finite() { rest.slowness } else { WANDERING };
        let scaled = |changes: &[f64]| changes.iter().map(|change| factor * change).collect();
        self.repetition.to_come = Some((scaled(&changes.motion), scaled(&changes.wear)));
        let relative = self.scene.outputs.iter().enumerate().map(|(k, output)| {
            let change = match output.kind.wear() {
                Some((_, joints)) => {
                    let surfaces = joints.iter().flat_map(|&joint| SURFACES * joint..SURFACES * (joint + 1));
                    surfaces.filter_map(|surface| changes.wear.get(surface)).fold(0.0, |a: f64, b| a.max(*b))
                }
                None => over(changes.motion[k], measured.motion[k].abs()),
            };
            (output, change)
        });
        let largest = relative.max_by(|a, b| a.1.total_cmp(&b.1));
        self.repetition.unsettled = largest.map(|(output, change)| UnsettledMotion {
            output: output.name.clone(),
            change,
            further_cycles: rest.cycles,
            turning: self.turning_body(),
        });
        Ok(())
    }

    /// The body that turns furthest in the cycle just measured, and its angle [rad], if that is no whole number of turns.
    fn turning_body(&self) -> Option<(String, f64)> {
        let bodies = self.islands.iter().flat_map(|state| {
            let (_, from, _) = state.cycle_start.state();
            state
                .island
                .bodies
                .iter()
                .enumerate()
                .map(move |(slot, &body)| (body, state.q[3 * slot + 2] - from[3 * slot + 2]))
        });
        let (body, angle) = bodies.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let part = angle / TAU - (angle / TAU).round();
        (angle.abs() > TURNS && part.abs() > PART_OF_TURN)
            .then(|| (self.scene.bodies[body].name.clone(), angle))
    }

    /// Goes on with settling cycles until the motion repeats itself; how far it has come.
    async fn settle_further(&mut self) -> Simulated<Rest> {
        let period = self.scene.life.period;
        let tolerance = self.accuracy.step_tolerance;
        let mut sequences: Vec<Vec<Vec<f64>>> = self
            .islands
            .iter()
            .map(|state| {
                let start = state.scaled(state.cycle_start.state(), period);
                let change = state.change_over_cycle(period);
                let end = start.iter().zip(&change).map(|(start, change)| start + change).collect();
                vec![start, end]
            })
            .collect();
        let mut before = f64::INFINITY;
        let mut rest = Rest { cycles: 0, is_settled: false, slowness: f64::INFINITY };
        loop {
            let to_come: Vec<Vec<f64>> = sequences.iter().map(|states| to_come(states)).collect();
            let largest = to_come.iter().map(|x| size(x)).fold(0.0, f64::max);
            let states = sequences[0].len();
            tracing::debug!("settling {}: {largest} still to come ({states} states)", rest.cycles);
            rest.is_settled = largest <= tolerance && states > 2;
            if states >= WINDOW && !rest.slowness.is_finite() {
                rest.slowness = sequences.iter().map(|states| slowness(states)).fold(0.0, f64::max);
            }
            if rest.is_settled || rest.cycles >= MOST_FURTHER {
                break;
            }
            if states >= WINDOW {
                if largest > PROGRESS * before {
                    break;
                }
                before = largest;
                for ((state, sequence), step) in self.islands.iter_mut().zip(&mut sequences).zip(&to_come) {
                    state.shift(step);
                    *sequence = vec![state.scaled_state(period)];
                }
                self.settle_once(&mut sequences).await?;
                rest.cycles += 1;
            }
            self.settle_once(&mut sequences).await?;
            rest.cycles += 1;
        }
        if rest.is_settled && !rest.slowness.is_finite() {
            rest.slowness = sequences.iter().map(|states| slowness(states)).fold(0.0, f64::max);
        }
        Ok(rest)
    }

    /// Simulates a settling cycle and adds the states at its end.
    async fn settle_once(&mut self, sequences: &mut [Vec<Vec<f64>>]) -> Simulated<()> {
        let period = self.scene.life.period;
        self.integrate(-period..0.0, false).await?;
        self.simulated += 1;
        for (state, sequence) in self.islands.iter().zip(sequences) {
            let last = &sequence[sequence.len() - 1];
            let change = state.change(last, &state.scaled_state(period));
            let next = last.iter().zip(&change).map(|(last, change)| last + change).collect();
            sequence.push(next);
        }
        Ok(())
    }

    /// Simulates warm-up and measured cycle on the profile as it is now; the cycle after it if that begins with a transient which sets an
    /// output.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn next_settled_cycle(&mut self) -> Simulated<()> {
        self.next_cycle().await?;
        self.measure_after_transient().await
    }

    /// Measures the cycle after the one just measured, as long as that changes the state by more than [`FALL`] and begins with a
    /// transient which sets an output.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the integration stops.
    pub(crate) async fn measure_after_transient(&mut self) -> Simulated<()> {
        if self.repetition.is_irregular {
            return Ok(());
        }
        for _ in 0..MOST_AGAIN {
            let change = self.change_over_cycle();
            let early = if change > FALL { self.starts_with_extreme() } else { None };
            tracing::debug!(
                "over a worn cycle the state changes by {change}; output with an extreme in its start: {early:?}"
            );
            if early.is_none() {
                break;
            }
            self.measure().await?;
        }
        Ok(())
    }

    /// The first output whose extreme lies in the start of the cycle just measured.
    fn starts_with_extreme(&self) -> Option<&str> {
        let rest: Vec<Recorder> = self.islands.iter().map(|state| state.recorder.without_start()).collect();
        let islands = self.islands.iter().zip(&rest);
        let later = self.outputs_of_recordings(islands.map(|(state, recorder)| (&state.island, recorder)));
        let outputs = self.scene.outputs.iter().zip(self.measured.iter().zip(&later));
        let mut extremes =
            outputs.filter(|(output, (whole, later))| whole != later && is_extreme(&output.kind));
        extremes.next().map(|(output, _)| output.name.as_str())
    }
}
