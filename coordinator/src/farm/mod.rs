//! How evaluations are computed: the [`evaluate::Evaluator`] trait with its local and external implementations,
//! and [`dispatch`], which sends tasks to workers over Zenoh.

pub mod dispatch;
pub mod evaluate;
