//! What a study records and returns: the summary, the campaign file and the other files of a study's folder.
//!
//! | module | content |
//! |---|---|
//! | [`summary`] | the numbers of a study, as written to `summary.json` |
//! | [`output_unit`] | units in which outputs are shown |
//! | [`journal`] | the interface by which evaluations are recorded |
//! | [`progress`] | what a running study reports |
//! | [`store`] | the campaign file (SQLite) |
//! | [`result_files`] | JSON and CSV files |

pub mod journal;
pub mod output_unit;
pub mod progress;
pub mod result_files;
pub mod store;
pub mod summary;
