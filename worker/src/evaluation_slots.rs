//! Slots of the external simulator that a scene names. A program that gives whole lives evaluates samples itself; around one that gives
//! cycles the worker simulates the life.

use crate::simulate::{CycleError, SimulateOptions, simulate_program_life};
use common::external::{
    CycleSlot, OpenedSimulator, SampleResult, SimulatorError, SimulatorId, Slot, SlotError, SlotRequest,
    StopSignal,
};
use common::failure::SimulationFailure;
use common::scene::{CycleTier, SceneSource};
use std::sync::Arc;

/// The simulator of a scene, ready to give slots.
#[derive(Debug, Clone)]
pub struct EvaluationSlots {
    opened: OpenedSimulator,
    /// The scene whose lives are simulated here, if its simulator gives cycles.
    lives: Option<(Arc<SceneSource>, CycleTier)>,
}

impl EvaluationSlots {
    /// Opens the simulator of a scene; `None` if it names none.
    ///
    /// # Errors
    /// [`SimulatorError`] as of [`OpenedSimulator::open`].
    pub fn open(source: &SceneSource) -> Option<Result<Self, SimulatorError>> {
        let simulator = source.nominal().simulator.as_ref()?;
        let lives = simulator.cycles.as_ref().map(|program| (Arc::new(source.clone()), program.tier));
        let opened = OpenedSimulator::open(simulator, source.nominal());
        Some(opened.map(|opened| EvaluationSlots { opened, lives }))
    }

    /// A slot with this number. Its program is started by [`Slot::start`] or by the first sample.
    pub fn slot(&self, number: usize) -> Box<dyn Slot> {
        match self.lives.clone() {
            Some((source, tier)) => Box::new(LifeSlot { source, tier, slot: self.opened.cycle_slot(number) }),
            None => self.opened.slot(number),
        }
    }
}

/// Simulates one life at a time around the cycles of a program.
struct LifeSlot {
    source: Arc<SceneSource>,
    tier: CycleTier,
    slot: CycleSlot,
}

impl Slot for LifeSlot {
    fn start(&mut self) -> Result<(), SimulatorError> {
        self.slot.start()
    }

    fn evaluate(&mut self, request: SlotRequest<'_>, stop: &StopSignal) -> Result<SampleResult, SlotError> {
        let SlotRequest { id, with_first_cycle, sample, .. } = request;
        let scene = match self.source.resolve_sample(sample) {
            Ok(scene) => scene,
            Err(faults) => return Ok(Err(SimulationFailure::InvalidSample { faults: faults.to_string() })),
        };
        let identity = SimulatorId::of_scene(self.source.nominal());
        let life = format!("{identity:?} {:?}", sample.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
        let mut cycles = self.slot.life((id, sample), &scene, &life, stop)?;
        let options = SimulateOptions { first_cycle: with_first_cycle };
        match simulate_program_life(&scene, &scene.accuracy, self.tier, &mut cycles, options) {
            Ok(evaluation) => {
                cycles.end();
                Ok(Ok(evaluation))
            }
            Err(CycleError::Failed(failure)) => Ok(Err(failure)),
            Err(CycleError::Slot(error)) => Err(error),
        }
    }

    fn name(&self) -> String {
        self.slot.name()
    }
}
