//! Evaluates the samples of a study: on threads of this process, by an external program or model server, or by
//! workers over Zenoh.
//!
//! The path of one request:
//!
//! 1. A study supplies numbered requests ([`evaluate::RequestSource`], [`evaluate::Request`]).
//! 2. An evaluator ([`evaluate::Evaluator`]) drains the requests that are available now; below, it is the
//!    [`dispatch::ZenohEvaluator`].
//! 3. The evaluator submits them to the dispatch thread, whose [`dispatch::scheduler::Scheduler`] queues them and announces
//!    them to all workers ([`common::wire::Notice`]).
//! 4. A worker sends a [`common::wire::Claim`]; the scheduler leases tasks to it, and a [`common::wire::Reply`] carries them
//!    in a [`common::wire::WorkOrder`].
//! 5. A slot of the worker evaluates the [`common::wire::Task`] as a `worker::service::Job`.
//! 6. The worker's next claim carries the [`common::wire::Outcome`]; the first outcome of a task counts.
//! 7. The evaluator passes it to the study as [`evaluate::Finished`], and the study makes it durable.
//! 8. Only then ([`dispatch::scheduler::Event::Recorded`]) does the reply to that claim acknowledge the outcome, and the
//!    worker discards it.
//!
//! Request, task and job stay three types: a request has a number in its study only; a task adds campaign and
//! attempt, so that a worker needs no memory of the coordinator; a job adds the scene and the coordinator that wants
//! the outcome, so that a slot needs no memory of the worker.

pub mod allocation;
pub mod dispatch;
pub mod evaluate;
