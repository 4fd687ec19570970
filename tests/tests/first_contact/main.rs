//! First contact: the tutorial's commands as they stand, and what they leave, seen in a browser.

mod browser;
mod tutorial;
