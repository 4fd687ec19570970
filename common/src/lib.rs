//! Data that coordinator and workers share: scenes, random variables, what an evaluation returns, and the
//! messages between them. No messaging, no threads, no linear algebra.

pub mod accuracy;
pub mod failure;
pub mod outputs;
pub mod random;
pub mod scene;
pub mod umbridge;
pub mod wire;
