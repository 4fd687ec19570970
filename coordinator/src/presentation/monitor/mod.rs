//! Views of a running study: its status as text, and as a page that shows the report of the results so far.
//!
//! ```text
//! study --Progress--> ProgressRelay --> terminal
//!                         +-----> status board (dispatch) <--- StatusSource --- LivePage, `coordinator status` over Zenoh
//!                         +-----> LivePage (report, rendered on request in a thread of the server, at intervals)
//! ```
//!
//! Views are rendered on request only: without requests they cost the study nothing.

mod live;
mod server;
mod study_section;

pub use live::{LivePage, ProgressRelay};
pub use server::{MonitorError, MonitorServer, listen_address};
pub use study_section::{StatusSource, status_text};
