//! External simulators: a program of this machine, or a model of an UM-Bridge server, as a scene names it. Coordinators
//! and workers evaluate samples with the same code.
//!
//! | file | content |
//! |---|---|
//! | `slot` | a slot evaluates one sample at a time; the signal that stops it; errors of simulators |
//! | `guard` | finds the program of a command; ends a process group with the process that started it, or without contact |
//! | `process` | a process with its process group: lines in and out, time limit, kill |
//! | `reply`, `results_file` | what programs write and read, checked against the scene |
//! | `working_folder` | one run of a program in a folder, with files in and out; templates |
//! | `program`, `umbridge` | the two kinds of simulators |
//! | `cycle_slot` | cycles of a program on worn surfaces; the replies of a life under way |
//! | `cycle_reply`, `joint_cycle` | one cycle as it is asked for and as it is read, and what shows that it is wrong |
//! | `opened` | the simulator of a scene, ready to give slots |
//! | `identity` | what a coordinator and a worker with its own program agree by |

mod cycle_reply;
#[cfg(test)]
mod cycle_reply_tests;
mod cycle_request;
mod cycle_slot;
mod guard;
mod identity;
mod joint_cycle;
mod opened;
mod process;
mod program;
mod reply;
mod results_file;
mod slot;
mod umbridge;
mod working_folder;

pub use cycle_reply::CycleReply;
pub use cycle_request::{CycleRequest, WornSurfaces};
pub use cycle_slot::{CycleSlot, CyclesOfLife};
pub use guard::limit_contact;
pub use identity::SimulatorId;
pub use joint_cycle::{CycleContacts, JointCycle, slopes};
pub use opened::{OpenedSimulator, check};
pub use process::kill_all;
pub use slot::{SampleResult, SimulatorError, Slot, SlotError, SlotRequest, StopSignal};
