//! Counting of refused messages for the log.

/// Number of refused messages of one kind. They are logged at the first, second, fourth, ... time: a flood must not fill the log.
#[derive(Debug, Clone, Copy, Default)]
pub struct Refused(u64);

impl Refused {
    /// Counts a message; returns the number so far if it is to be logged.
    pub fn count(&mut self) -> Option<u64> {
        self.0 = self.0.saturating_add(1);
        self.0.is_power_of_two().then_some(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Refused;

    #[test]
    fn a_flood_is_logged_a_few_times() {
        let mut refused = Refused::default();
        let logged: Vec<u64> = (0..1000).filter_map(|_| refused.count()).collect();
        assert_eq!(logged, [1, 2, 4, 8, 16, 32, 64, 128, 256, 512]);
    }
}
