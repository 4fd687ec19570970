//! The worker: simulates worn mechanisms.
