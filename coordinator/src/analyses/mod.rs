//! Analyses besides the study itself: the trade of speed for accuracy, calibration to measurements, the accuracy
//! that an error budget needs, and published reliability problems.

pub mod benchmark;
pub mod budget;
pub mod calibrate;
pub mod tradeoff;
