//! What a study records and returns: the summary, the campaign file and the other files of a study's folder.
//!
//! | module | content |
//! |---|---|
//! | [`summary`], [`summary_rows`] | the numbers of a study, as written to `summary.json` |
//! | [`journal`] | the record of evaluations: interface, and a journal in memory |
//! | [`progress`] | what a running study reports |
//! | [`store`] | the campaign file (SQLite) |
//! | [`result_files`] | JSON and CSV files |
//! | [`verified`] | what direct simulation has shown of a study |
//! | [`timing`] | times of a study over all its runs |
//!
//! # Example
//! A journal returns the outcome of a request that was finished before:
//! ```
//! use common::outputs::Evaluation;
//! use coordinator::farm::evaluate::{Finished, Request};
//! use coordinator::results::journal::{InMemoryJournal, Journal};
//!
//! let request = Request { id: 7, sample: vec![0.04], with_first_cycle: false, accuracy: None, level: 0, not_by: vec![] };
//! let outcome = Ok(Evaluation::from_histories(vec![1000], vec![vec![2.5e-6]]));
//! let finished = Finished { id: 7, outcome, worker: "local/0".into(), wall: 0.2 };
//!
//! let mut journal = InMemoryJournal::default();
//! assert!(journal.finished(&request)?.is_none());
//! journal.record(&request, &finished)?;
//! assert_eq!(journal.finished(&request)?, Some(finished));
//! # Ok::<(), coordinator::farm::evaluate::EvaluateError>(())
//! ```

pub mod csv_table;
pub mod journal;
pub mod life_summary;
pub mod progress;
pub mod reliability_summary;
pub mod result_files;
pub mod scene_summary;
pub mod store;
pub mod summary;
pub mod summary_rows;
pub mod timing;
pub mod verified;
