//! Where the circle of a journal crosses a tabulated bore: on the chord between two table angles, and next to the contact on a parabola.
//!
//! With p [m], how far the circle lies beyond the bore (`arc_ends.rs`), at the table angles on both sides of the crossing, it is where the straight
//! line between the two is zero. Before the first table angle the parabola through the penetration delta at the contact, with the slope
//! of p there, takes the place of that line.
//!
//! # Source
//! Chosen here.

/// Where the circle of a journal crosses a bore.
#[derive(Debug, Clone, Copy)]
pub struct Crossing {
    /// Number of the table angle behind the crossing.
    pub at: usize,
    /// p at the table angle before, or where the contact is, and behind it [m].
    pub before: f64,
    pub next: f64,
}

impl Crossing {
    /// Distance from the direction of the contact, in table intervals: there the penetration is `penetration` [m], p has the `slope` [m per interval]
    /// outwards, and the first table angle is at the distance `offset`.
    #[inline(always)]
    pub(super) fn distance(&self, penetration: f64, slope: f64, offset: f64) -> f64 {
        match self.at {
            0 => first_end(penetration, slope, offset, self.next),
            m => offset + (m - 1) as f64 + self.before / (self.before - self.next),
        }
    }
}

/// End of the arc within the first table interval: positive root of delta + slope x + q x^2, where q makes
/// the parabola pass through (first, p), p <= 0 < delta; lengths in any one unit, `slope` per that unit.
fn first_end(delta: f64, slope: f64, first: f64, p: f64) -> f64 {
    if delta <= 0.0 || first <= 0.0 {
        return first.max(f64::MIN_POSITIVE);
    }
    let q = (p - delta - slope * first) / (first * first);
    let root = (slope * slope - 4.0 * q * delta).max(0.0).sqrt();
    // q x^2 + slope x + delta = 0, the root that stays finite as q -> 0.
    let x = if slope >= 0.0 { (slope + root) / (-2.0 * q) } else { 2.0 * delta / (root - slope) };
    if x.is_finite() && x > 0.0 { x.min(first) } else { first }
}
