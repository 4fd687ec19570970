//! Cycles of a program on the surfaces as worn so far: requests and replies of one life after the other, by the road of the program.
//!
//! The replies of a life under way are kept in a file, so that another worker goes on where one has died: no cycle is simulated twice but the one
//! under way.
//!
//! A file belongs to a life: scene, sample and accuracy. A line has the digest of a request and the reply to it. A line that was not
//! finished counts for nothing. The request contains the surfaces, which follow from the replies before it: a life that goes on has the
//! same bits. The file is removed at the end of the life.

use super::cycle_reply::{CycleReply, ExpectedCycle};
use super::cycle_request::{CycleLine, CycleRequest};
use super::program::{ProgramSlot, SampleByName};
use super::reply::{Expected, outcome};
use super::slot::{SimulatorError, Slot, SlotError, SlotRequest, StopSignal};
use super::umbridge::ModelSlot;
use crate::failure::SimulationFailure;
use crate::scene::Scene;
use crate::scene::source::digest;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs::{File, OpenOptions, create_dir_all, read_to_string, remove_file};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A slot whose program or model gives cycles.
#[derive(Debug)]
pub enum CycleSlot {
    /// A program of this machine.
    Program(ProgramSlot),
    /// A model of a server.
    Model(ModelSlot),
}

/// The life of one sample, cycle by cycle.
#[derive(Debug)]
pub struct CyclesOfLife<'a> {
    slot: &'a mut CycleSlot,
    id: u64,
    sample: &'a [f64],
    stop: &'a StopSignal,
    inputs: Expected,
    journal: Option<CycleJournal>,
}

impl CycleSlot {
    /// Starts a program that keeps running.
    ///
    /// # Errors
    /// [`SimulatorError`].
    pub fn start(&mut self) -> Result<(), SimulatorError> {
        if let CycleSlot::Program(slot) = self { slot.start() } else { Ok(()) }
    }

    /// Name of the slot in results.
    pub fn name(&self) -> String {
        match self {
            CycleSlot::Program(slot) => slot.name(),
            CycleSlot::Model(slot) => slot.name(),
        }
    }

    fn broken(&self, id: u64, fault: String) -> SimulatorError {
        match self {
            CycleSlot::Program(slot) => slot.setup.broken(id, fault),
            CycleSlot::Model(slot) => slot.broken(id, fault),
        }
    }

    /// The cycles of evaluation `id` of a `sample` `(d,)`, which gives the `scene`. Replies are kept in the journal of the scene, if it has one,
    /// under `life`, a text that identifies scene and sample.
    ///
    /// # Errors
    /// The journal cannot be read or written.
    pub fn life<'a>(
        &'a mut self,
        (id, sample): (u64, &'a [f64]),
        scene: &Scene,
        life: &str,
        stop: &'a StopSignal,
    ) -> Result<CyclesOfLife<'a>, SlotError> {
        let program = scene.simulator.as_ref().and_then(|simulator| simulator.cycles.as_ref());
        let folder = program.and_then(|program| program.journal.as_deref());
        let open =
            |folder: &str| CycleJournal::open(Path::new(folder), life).map_err(|e| no_journal(folder, &e));
        let journal = folder.map(open).transpose()?;
        Ok(CyclesOfLife { slot: self, id, sample, stop, inputs: Expected::from_scene(scene), journal })
    }
}

impl CyclesOfLife<'_> {
    /// The reply to a request, from the journal or from the program.
    ///
    /// # Errors
    /// As [`Slot::evaluate`]; a reply that does not fit the scene is a [`SimulatorError`].
    pub fn ask(
        &mut self,
        request: &CycleRequest,
    ) -> Result<Result<CycleReply, SimulationFailure>, SlotError> {
        let CyclesOfLife { slot, id, stop, inputs, journal, sample } = self;
        let CycleRequest { scene, condition, cycle, accuracy, joints } = *request;
        let expected = ExpectedCycle::from_scene(scene);
        let values = &*inputs.values(sample, condition);
        let outputs: Vec<&str> = expected.outputs.iter().flatten().map(String::as_str).collect();
        let line = CycleLine {
            id: None,
            cycle,
            sample: SampleByName { names: &inputs.inputs, values },
            condition: condition.map(|condition| &*condition.name),
            accuracy,
            period: expected.period,
            joints,
            outputs: &outputs,
        };
        let text = |id: Option<u64>, values: &[f64]| {
            let line = CycleLine { id, sample: SampleByName { values, ..line.sample }, ..line };
            serde_json::to_string(&line).expect("numbers by name are JSON")
        };
        let place = format!("cycle {cycle}");
        let read = |text: &str| expected.read(text, cycle).map_err(|none| none.of(&place));
        let key = || text(None, values);
        if let Some(known) = journal.as_ref().and_then(|journal| journal.reply(&key())) {
            return outcome(read(known), |fault| slot.broken(*id, fault));
        }
        let with_id = |values: &[f64]| text(Some(*id), values);
        let of_object =
            |reply: &Map<String, Value>| expected.of_object(reply, cycle).map_err(|none| none.of(&place));
        let asked = match slot {
            CycleSlot::Program(slot) => {
                let asked = SlotRequest { id: *id, level: 0, with_first_cycle: false, sample: values };
                slot.ask(asked, &with_id, stop, |setup, text| match setup.line_reply(*id, text)? {
                    Some(reply) => of_object(&reply),
                    None => read(text),
                })
            }
            CycleSlot::Model(slot) => slot.ask_cycle((*id, &line), &expected, stop, of_object),
        };
        let (cycle, reply) = match asked? {
            Ok(found) => found,
            Err(failure) => return Ok(Err(failure)),
        };
        if let Some(journal) = journal {
            journal.add(&key(), &reply).map_err(|reason| no_journal("of the life", &reason))?;
        }
        Ok(Ok(cycle))
    }

    /// The error of a reply to the cycle of this life.
    pub fn broken(&self, fault: String) -> SlotError {
        self.slot.broken(self.id, fault).into()
    }

    /// Ends the life: its journal is not needed any more.
    pub fn end(self) {
        if let Some(Err(error)) = self.journal.map(CycleJournal::remove) {
            tracing::warn!("the journal of a life cannot be removed: {error}");
        }
    }
}

/// The error of a journal in `folder` that cannot be read or written.
fn no_journal(folder: &str, reason: &io::Error) -> SimulatorError {
    SimulatorError::of_key("journal", format!("{folder}: {reason}"))
}

/// The journal of one life.
#[derive(Debug)]
pub struct CycleJournal {
    path: PathBuf,
    known: BTreeMap<u128, String>,
    file: File,
}

impl CycleJournal {
    /// Opens the journal of the life identified by the text `life` in `folder`, which is created if missing.
    ///
    /// # Errors
    /// The file cannot be read or written.
    pub fn open(folder: &Path, life: &str) -> io::Result<Self> {
        create_dir_all(folder)?;
        let path = folder.join(format!("{:032x}.cycles", digest(life)));
        let text = if path.exists() { read_to_string(&path)? } else { String::new() };
        let entry = |line: &str| {
            let (digest, reply) = line.strip_suffix('\n')?.split_once(' ')?;
            Some((u128::from_str_radix(digest, 16).ok()?, serde_json::from_str(reply).ok()?))
        };
        let known = text.split_inclusive('\n').filter_map(entry).collect();
        let mut file = OpenOptions::new().create(true).append(true).open(&path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n")?;
        }
        Ok(CycleJournal { path, known, file })
    }

    /// The reply to a request, if it is known.
    pub fn reply(&self, request: &str) -> Option<&str> {
        self.known.get(&digest(request)).map(String::as_str)
    }

    /// Adds the reply to a request.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, request: &str, reply: &str) -> io::Result<()> {
        let text = serde_json::to_string(reply)?;
        self.file.write_all(format!("{:032x} {text}\n", digest(request)).as_bytes())?;
        self.file.sync_data()
    }

    /// Removes the file, at the end of the life, if another worker with the same life has not.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(self) -> io::Result<()> {
        match remove_file(self.path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reply_outlives_its_worker_and_half_a_line_does_not() {
        let folder = tempfile::tempdir().unwrap();
        let mut journal = CycleJournal::open(folder.path(), "life").unwrap();
        journal.add("first", "{\"a\":\n1}").unwrap();
        journal.add("second", "2").unwrap();
        drop(journal);
        let path = folder.path().join(format!("{:032x}.cycles", digest("life")));
        let text = read_to_string(&path).unwrap();
        std::fs::write(&path, &text[..text.len() - 2]).unwrap();
        let mut journal = CycleJournal::open(folder.path(), "life").unwrap();
        assert_eq!((journal.reply("first"), journal.reply("second")), (Some("{\"a\":\n1}"), None));
        journal.add("second", "3").unwrap();
        let journal = CycleJournal::open(folder.path(), "life").unwrap();
        assert_eq!(journal.reply("second"), Some("3"));
        assert_eq!(CycleJournal::open(folder.path(), "other").unwrap().reply("first"), None);
        let of_twin = CycleJournal::open(folder.path(), "life").unwrap();
        journal.remove().unwrap();
        assert!(!path.exists());
        of_twin.remove().unwrap();
    }
}
