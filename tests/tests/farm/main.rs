//! Coordinators and workers together: in-process peers and real processes on loopback, messages, faults, permissions, external programs.
//! One executable, whose tests overlap: many of them wait for timeouts.

mod builds;
mod cycles;
mod elastic;
mod external_limits;
mod external_workers;
mod faults;
mod messaging;
mod messaging_faults;
mod misfits;
mod mutated_frames;
mod outliers;
mod panics;
mod refusals;
mod router;
mod scale;
mod security;
mod study_and_workers;
mod tradeoff;
mod umbridge;
