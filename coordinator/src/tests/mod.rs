//! What tests of several modules share.

pub mod test_study;
