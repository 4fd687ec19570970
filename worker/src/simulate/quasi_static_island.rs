//! One island on its ideal motion: the gaps of its joints through a cycle, recorded for the wear.

use super::island_state::{IslandState, StateSnapshot};
use crate::integrate::{StepControl, StepCounts};
use crate::mechanism::Island;
use crate::outputs::{Recorder, RecordingRequest};
use crate::quasi_static::{IdealMotion, QuasiStaticStepper, Unsuitable};
use crate::wear::WearHistory;
use common::accuracy::Accuracy;
use common::scene::Scene;

/// Lower bound of the time step, as a fraction of the cycle [1].
const SMALLEST_STEP: f64 = 1e-9;

/// Largest step as a fraction of the cycle [1]. For the wear 1/200 would do; coarser histories make the wear rates,
/// point by point, too rough for the comparison with the dynamics.
const LARGEST_STEP: f64 = 1.0 / 300.0;
/// Tolerance of the local error of a step, in the scales of the gaps (1 % of the smallest clearance) [1]: in lasting contact the
/// largest step decides, and four times the tolerance changes the wear by less than 1e-4.
const STEP_TOLERANCE: f64 = 0.05;

/// Stepper of the gaps of an island, and their recorder.
#[derive(Clone)]
pub struct QuasiStaticIsland {
    stepper: QuasiStaticStepper,
    /// Records the cycle for the wear.
    pub recorder: Recorder,
    /// Gaps from which the next run-up starts `(n,)` [m, rad].
    start: Vec<f64>,
}

impl QuasiStaticIsland {
    /// An island with closed joints on its ideal motion.
    pub(crate) fn new(ideal: IdealMotion, island: &Island, scene: &Scene, accuracy: &Accuracy) -> Self {
        let period = scene.life.period;
        let [largest, smallest] = [LARGEST_STEP, SMALLEST_STEP].map(|share| share * period);
        let control = StepControl::new(STEP_TOLERANCE, largest, smallest, accuracy.steps_bound);
        let samples = (1.0 / LARGEST_STEP) as usize;
        QuasiStaticIsland {
            start: vec![0.0; ideal.n],
            stepper: QuasiStaticStepper::new(ideal, island.linearised(), control),
            recorder: Recorder::new(island, scene, &RecordingRequest::default(), samples),
        }
    }

    /// Runs the gaps up on the bores as they are, then a recorded cycle. Keeps the state from which the next run-up starts, also
    /// as the start of the next warm-up of the dynamics in `state`; the cycle has this `period`, and that state the time `kept` [s]. Adds the work to `counts`.
    ///
    /// # Errors
    /// [`Unsuitable`] if the gaps cannot be integrated.
    pub(crate) fn run_cycle(
        &mut self,
        state: &mut IslandState,
        (kept, period): (f64, f64),
        counts: &mut StepCounts,
    ) -> Result<(), Unsuitable> {
        let QuasiStaticIsland { stepper, recorder, start } = self;
        stepper.start(&mut state.island, kept - period, start, counts)?;
        stepper.run(&mut state.island, 0.0, &mut (), counts)?;
        recorder.clear();
        stepper.run(&mut state.island, kept, recorder, counts)?;
        start.copy_from_slice(&stepper.solver.past[0]);
        let (q, v) = (&stepper.solver.q, &stepper.solver.v);
        state.warm_up_start = StateSnapshot::new(&state.island, kept, q, v);
        stepper.run(&mut state.island, period, recorder, counts)?;
        recorder.finish();
        Ok(())
    }
}

/// The contact histories that wear the joints of island number `index`: those `mixed` of several conditions, or those of the last cycle,
/// quasi-static or in the `recorder`.
pub(super) fn wear_histories<'h>(
    mixed: &'h [Vec<WearHistory>],
    quasi_static: &'h [QuasiStaticIsland],
    recorder: &'h Recorder,
    index: usize,
) -> &'h [WearHistory] {
    match mixed.get(index) {
        Some(histories) => histories,
        None => &quasi_static.get(index).map_or(recorder, |island| &island.recorder).histories,
    }
}
