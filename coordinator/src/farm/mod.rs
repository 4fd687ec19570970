//! Evaluates the samples of a study: on threads of this process, by an external program or model server, or by
//! workers over Zenoh.
//!
//! The path of one request, with the types in order:
//!
//! | step | type | where |
//! |---|---|---|
//! | 1. A study supplies numbered requests. | [`evaluate::RequestSource`], [`evaluate::Request`] | thread of the study |
//! | 2. An evaluator drains the requests that are available now. | [`evaluate::Evaluator`], `PendingRequests` | thread of the study |
//! | 3. [`dispatch::ZenohEvaluator`] submits them to the dispatch loop. | `Input::Submit` | channel |
//! | 4. The scheduler queues them and announces them to all workers. | [`dispatch::scheduler::Event`], `TaskTable`, [`common::wire::Notice`] | dispatch thread |
//! | 5. A worker claims tasks; the scheduler leases some to it. | [`common::wire::Claim`], [`common::wire::Reply`], [`common::wire::WorkOrder`] | Zenoh query |
//! | 6. A slot of the worker evaluates the task. | [`common::wire::Task`], `worker::service::Job` | worker |
//! | 7. The next claim carries the outcome; the first outcome of a task counts. | [`common::wire::Outcome`] | Zenoh query |
//! | 8. The evaluator passes it to the study, which makes it durable. | [`evaluate::Finished`] | thread of the study |
//! | 9. Only then does the reply to that claim acknowledge the outcome. | [`dispatch::scheduler::Event::Recorded`] | dispatch thread |
//!
//! Request, task and job stay three types: a request has a number in its study only; a task adds campaign and
//! attempt, so that a worker needs no memory of the coordinator; a job adds the scene and the coordinator that wants
//! the outcome, so that a slot needs no memory of the worker.

pub mod dispatch;
pub mod evaluate;
