//! Limits of counts in a scene.

/// Largest count or life [cycles] that a scene may request: beyond it a typing error is more likely than intent.
pub(super) const COUNT_LIMIT: i64 = 100_000_000;
