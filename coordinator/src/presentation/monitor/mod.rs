//! A running study made visible: its status as text, as metrics, and as a page that shows the report as far as it is.
//!
//! ```text
//! study --Progress--> Watch --> terminal
//!                       +-----> board (dispatch) <--- Source --- metrics, `coordinator status` over Zenoh
//!                       +-----> Live (report in a thread of whoever looks, at most every few seconds)
//! ```
//!
//! Nothing here is asked by the study: whoever looks costs it no more than what the look itself computes.

mod live;
mod metrics;
mod server;
pub mod text;
mod watch;

pub use live::{Live, View};
pub use metrics::metrics_text;
pub use server::{MonitorError, Server, address};
pub use watch::{Source, Watch};
