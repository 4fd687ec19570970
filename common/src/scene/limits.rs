//! Limits of counts in a scene.

/// Largest count or life [cycles] that a scene may request: beyond it a typing error is more likely than intent.
pub(super) const COUNT_LIMIT: i64 = 100_000_000;
/// Most checkpoints of a life; each has a surrogate per output.
pub(super) const CHECKPOINT_LIMIT: u32 = 100_000;
/// Most values of all outputs at all checkpoints: with its stated error each takes 16 bytes of a worker's message of at most 4 MiB.
pub const VALUE_LIMIT: usize = 200_000;
