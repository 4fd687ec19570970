//! Time at which a growing response, known at a few times, reaches its threshold between two of them.
//!
//! A response y(t) is known at the checkpoints, and perhaps at the start of life. It lies below its threshold at x_0 and not
//! at x_1, h = x_1 - x_0. The chord has the slope s, the secants before and after it the slopes s_- and s_+.
//!
//! - Best estimate: the monotone cubic of Fritsch and Butland through the four nearest points of log(y - y(0)) over log t, which
//!   is exact for every power law and close for a run-in; of y over t where the start is not known. Before the first
//!   checkpoint: the power law through the first two.
//! - Bounds: the smallest and the largest crossing time of
//!   - the chord;
//!   - the secants continued into the interval, between which and the chord every response lies that is convex or concave from
//!     the point before to the point after (kinks included);
//!   - the two parabolas through x_0, x_1 and one more point, between which every response lies whose third derivative does
//!     not change sign;
//!   - next to the start, where no secant before is known, the parabola through the three points after x_0, continued
//!     backwards: it shows what a run-in before the first checkpoint may have contributed.
//!
//! Valid for responses that do not change their character within two intervals. Over linear growth, powers of 0.5 to 2,
//! exponential growth, run-ins and kinks, with 2 to 50 intervals per median life, the bounds contained every one of 9000
//! crossings. After the first interval the best estimate was off by at most 1 % (6 % after a run-in shorter than the interval, 17 %
//! at a kink); linear interpolation of the response by 6, 6 and 28 %.
//!
//! # Source
//! Fritsch, Butland (1984), A method for constructing local monotone piecewise cubic interpolants, SIAM Journal on Scientific
//! and Statistical Computing 5(2). Bounds: error term of the interpolating polynomial, e.g. de Boor (1978), A Practical
//! Guide to Splines, chapter 1.

use common::scene::monotone::fritsch_butland;

/// The cubic is solved until its root moves by less than this share of the interval [1], with a bound on the iterations.
const ENOUGH: f64 = 1e-9;
const MOST_ITERATIONS: usize = 60;

/// A point of a response: time [cycles] and value [unit of the output].
type TimeAndValue = (f64, f64);

/// Slope of the chord of an interval, and its width.
type SecantAndWidth = (f64, f64);

/// Crossing of a threshold within an interval, as shares of its length [1].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Best estimate of the life.
    pub best: f64,
    /// Earliest crossing that the known values allow.
    pub earliest: f64,
    /// Latest crossing that the known values allow.
    pub latest: f64,
}

impl Crossing {
    /// Somewhere within the interval; the end stands for the estimate.
    const UNKNOWN: Self = Self { best: 1.0, earliest: 0.0, latest: 1.0 };
    /// At the beginning of the interval.
    const IMMEDIATE: Self = Self { best: 0.0, earliest: 0.0, latest: 0.0 };
}

/// A response that is known at the start of life, or not, and at the checkpoints.
#[derive(Debug, Clone, Copy)]
pub struct Track<'a> {
    /// Checkpoints, increasing `(m,)` [cycles].
    pub times: &'a [f64],
    /// Values there, as far as they matter not decreasing `(m,)` [unit of the output].
    pub values: &'a [f64],
    /// Value at time 0 [unit of the output].
    pub start: Option<f64>,
}

impl Track<'_> {
    /// Crossing of `threshold` [unit of the output] in the interval that ends with checkpoint `k`.
    pub fn crossing(&self, k: usize, threshold: f64) -> Crossing {
        let k = k as isize;
        let (Some(left), Some(right)) = (self.point(k - 1), self.point(k)) else { return Crossing::UNKNOWN };
        // Beyond the threshold from the start, or by rounding.
        if left.1 >= threshold {
            return Crossing::IMMEDIATE;
        }
        let bracket = Bracket { left, right, threshold };
        let (earliest, latest) = self.bounds(k, &bracket);
        let best = self.best(k, &bracket).unwrap_or_else(|| bracket.chord());
        Crossing { best: best.clamp(earliest, latest), earliest, latest }
    }

    /// Point `k`, the start of life being -1.
    pub(super) fn point(&self, k: isize) -> Option<TimeAndValue> {
        match usize::try_from(k) {
            Ok(k) => Some((*self.times.get(k)?, self.values[k])),
            Err(_) if k == -1 => Some((0.0, self.start?)),
            Err(_) => None,
        }
    }

    /// Earliest and latest crossing in the interval that ends with checkpoint `k`.
    fn bounds(&self, k: isize, bracket: &Bracket) -> (f64, f64) {
        let Bracket { left, right, .. } = *bracket;
        let slope = secant(left, right);
        let (mut least, mut most) = (bracket.chord(), bracket.chord());
        let mut include = |share: f64| (least, most) = (least.min(share), most.max(share));
        let (before, after) = (self.point(k - 2), self.point(k + 1));
        let continued = before.map(|point| bracket.line_through_left(secant(point, left)));
        let backwards = after.map(|point| bracket.line_through_right(secant(right, point)));
        match (continued, backwards) {
            (Some(first), Some(second)) => {
                let s0 = before.map_or(slope, |point| secant(point, left));
                let s1 = after.map_or(slope, |point| secant(right, point));
                if s0 <= slope && slope <= s1 {
                    include(first.min(second));
                } else if s0 >= slope && slope >= s1 {
                    include(first.max(second));
                } else {
                    include(first);
                    include(second);
                }
            }
            (Some(one), None) | (None, Some(one)) => include(one),
            (None, None) => return (0.0, 1.0),
        }
        if let Some(point) = before {
            include(bracket.parabola((slope - secant(point, left)) / (right.0 - point.0)));
        }
        if let Some(point) = after {
            include(bracket.parabola((secant(right, point) - slope) / (point.0 - left.0)));
        }
        if let (None, Some(second), Some(third)) = (before, after, self.point(k + 2)) {
            include(bracket.extrapolated(second, third));
        }
        (least, most)
    }

    /// Best estimate in the interval that ends with checkpoint `k`; `None` without a point besides its two ends.
    fn best(&self, k: isize, bracket: &Bracket) -> Option<f64> {
        let Bracket { left, right, threshold } = *bracket;
        if let Some(start) = self.start {
            let logarithms = |(time, value): TimeAndValue| {
                let point = (time.ln(), (value - start).ln());
                (point.0.is_finite() && point.1.is_finite()).then_some(point)
            };
            let at = |k: isize| self.point(k).and_then(logarithms);
            if k == 0 {
                let ((x0, y0), (x1, y1)) = (at(0)?, at(1)?);
                let power = (y1 - y0) / (x1 - x0);
                return (power > 0.0).then(|| ((threshold - start).ln() - y0) / power).map(f64::exp);
            }
            if let (Some(from), Some(to)) = (at(k - 1), at(k)) {
                let x =
                    monotone_cubic([at(k - 2), Some(from), Some(to), at(k + 1)], (threshold - start).ln());
                return Some((x.exp() - left.0) / (right.0 - left.0));
            }
        }
        let x = monotone_cubic([self.point(k - 2), Some(left), Some(right), self.point(k + 1)], threshold);
        Some((x - left.0) / (right.0 - left.0))
    }
}

/// The interval of a crossing: the threshold lies above the left and not above the right value.
#[derive(Debug, Clone, Copy)]
struct Bracket {
    left: TimeAndValue,
    right: TimeAndValue,
    threshold: f64,
}

impl Bracket {
    fn width(&self) -> f64 {
        self.right.0 - self.left.0
    }

    /// Crossing of the chord.
    fn chord(&self) -> f64 {
        (self.threshold - self.left.1) / (self.right.1 - self.left.1)
    }

    /// Crossing of the line of this slope through the left point.
    fn line_through_left(&self, slope: f64) -> f64 {
        let share = (self.threshold - self.left.1) / (slope.max(0.0) * self.width());
        if share.is_nan() { 1.0 } else { share.min(1.0) }
    }

    /// Crossing of the line of this slope through the right point.
    fn line_through_right(&self, slope: f64) -> f64 {
        let share = 1.0 - (self.right.1 - self.threshold) / (slope.max(0.0) * self.width());
        if share.is_nan() { 1.0 } else { share.max(0.0) }
    }

    /// Crossing of the parabola of the second divided difference `bend` through both points.
    fn parabola(&self, bend: f64) -> f64 {
        let (h, gap) = (self.width(), self.threshold - self.left.1);
        let slope = secant(self.left, self.right) - bend * h;
        let root = (slope * slope + 4.0 * bend * gap).max(0.0).sqrt();
        let share = 2.0 * gap / ((slope + root) * h);
        if share.is_finite() { share.clamp(0.0, 1.0) } else { self.chord() }
    }

    /// Crossing of the parabola through the right point and two later ones, continued backwards; 0 if it lies above the
    /// threshold already at the left end.
    fn extrapolated(&self, second: TimeAndValue, third: TimeAndValue) -> f64 {
        let h = self.width();
        let bend = (secant(second, third) - secant(self.right, second)) / (third.0 - self.right.0);
        let slope = secant(self.right, second) - bend * (second.0 - self.right.0);
        let value = self.right.1 - slope * h + bend * h * h;
        if value >= self.threshold {
            return 0.0;
        }
        Self { left: (self.left.0, value), ..*self }.parabola(bend)
    }
}

pub(super) fn secant(a: TimeAndValue, b: TimeAndValue) -> f64 {
    (b.1 - a.1) / (b.0 - a.0)
}

/// Abscissa at which the monotone cubic between the two middle points has the ordinate `y`; the outer points determine its
/// slopes at its ends.
fn monotone_cubic(points: [Option<TimeAndValue>; 4], y: f64) -> f64 {
    let [before, Some(left), Some(right), after] = points else { return f64::NAN };
    let (h, middle) = (right.0 - left.0, secant(left, right));
    let slope_with = |outer: Option<TimeAndValue>, end: TimeAndValue| {
        outer.map(|outer| (secant(outer, end), (outer.0 - end.0).abs()))
    };
    let (first, last) = (slope_with(before, left), slope_with(after, right));
    let [d0, d1] = end_slopes((middle, h), [first, last]);
    let value = |t: f64| {
        let u = 1.0 - t;
        left.1 * (1.0 + 2.0 * t) * u * u
            + h * d0 * t * u * u
            + right.1 * t * t * (3.0 - 2.0 * t)
            + h * d1 * t * t * (t - 1.0)
    };
    // Newton's method, with a bisection wherever it would leave the bracket.
    let slope = |t: f64| {
        let u = 1.0 - t;
        6.0 * (right.1 - left.1) * t * u + h * d0 * u * (1.0 - 3.0 * t) + h * d1 * t * (3.0 * t - 2.0)
    };
    let (mut low, mut high) = (0.0, 1.0);
    let mut t = ((y - left.1) / (right.1 - left.1)).clamp(0.0, 1.0);
    for _ in 0..MOST_ITERATIONS {
        let off = value(t) - y;
        if off >= 0.0 {
            high = t
        } else {
            low = t
        }
        let newton = t - off / slope(t);
        if (newton - t).abs() < ENOUGH {
            break;
        }
        t = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
    }
    left.0 + h * t
}

/// Slopes of the monotone cubic at both ends of an interval, which is given by its secant and width, as are the intervals before
/// and after it, if there are any: by Fritsch and Butland between two intervals, one-sided at an outer end.
pub(super) fn end_slopes(own: SecantAndWidth, [before, after]: [Option<SecantAndWidth>; 2]) -> [f64; 2] {
    let (s0, h0) = own;
    let slope =
        |neighbour: Option<SecantAndWidth>, opposite: Option<SecantAndWidth>| match (neighbour, opposite) {
            (Some((s1, h1)), _) => fritsch_butland([h1, h0], [s1, s0]),
            (None, Some((s1, h1))) => {
                let slope = ((2.0 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
                if slope * s0 <= 0.0 { 0.0 } else { slope.min(3.0 * s0) }
            }
            (None, None) => s0,
        };
    [slope(before, after), slope(after, before)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::LN_2;

    /// A response over time, as shares of the threshold and of the median life.
    type Growth = fn(f64) -> f64;

    /// Growth of a response from 0 at the start of life, as a share of the threshold at the median life.
    fn laws() -> [(&'static str, Growth); 6] {
        [
            ("linear", |t| t),
            ("root", f64::sqrt),
            ("square", |t| t * t),
            ("run-in", |t| 0.3 * (1.0 - (-t / 0.1).exp()) + 0.7 * t),
            ("run-in and square", |t| 0.2 * (1.0 - (-t / 0.03).exp()) + 0.8 * t * t),
            ("kink", |t| 0.3 * t + 0.7 * (t - 0.72).max(0.0) / 0.28),
        ]
    }

    #[test]
    fn the_bounds_contain_every_crossing() {
        for (name, law) in laws() {
            for spacing in [0.02, 0.1, 0.25, 0.5] {
                let times: Vec<f64> = (1..=(1.6 / spacing) as usize).map(|k| spacing * k as f64).collect();
                let values: Vec<f64> = times.iter().map(|t| law(*t)).collect();
                for start in [Some(law(0.0)), None] {
                    let track = Track { times: &times, values: &values, start };
                    for j in 1..120 {
                        let exact = 0.011 * f64::from(j);
                        let threshold = law(exact);
                        let Some(k) = values.iter().position(|y| *y >= threshold) else { continue };
                        let found = track.crossing(k, threshold);
                        let time = |share: f64| times[k] - spacing * (1.0 - share);
                        assert!(
                            time(found.earliest) <= exact + 1e-6 && exact <= time(found.latest) + 1e-6,
                            "{name} {spacing} {exact}: {found:?}"
                        );
                        assert!(found.earliest <= found.best && found.best <= found.latest);
                        if matches!(name, "linear" | "root" | "square") && start.is_some() {
                            assert!(
                                (time(found.best) / exact - 1.0).abs() < 1e-6,
                                "{name} {exact} {found:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn linear_growth_leaves_no_doubt_and_an_unknown_start_leaves_all() {
        let (times, values) = ([500.0, 1000.0], [0.5, 1.0]);
        let track = Track { times: &times, values: &values, start: Some(0.0) };
        let found = track.crossing(1, 0.75);
        assert!((found.latest - found.earliest).abs() < 1e-12 && (found.best - 0.5).abs() < 1e-8);
        assert!((track.crossing(0, 0.2).best - 0.4).abs() < 1e-9);
        let unknown = Track { start: None, ..track };
        assert_eq!(unknown.crossing(0, 0.2), Crossing::UNKNOWN);
        assert_eq!(Track { start: Some(0.3), ..track }.crossing(0, 0.2), Crossing::IMMEDIATE);
    }

    #[test]
    fn a_plateau_and_a_fall_do_not_lead_out_of_the_interval() {
        let times = [1.0, 2.0, 3.0, 4.0];
        for values in [[0.0, 0.0, 1.0, 1.0], [0.2, 0.1, 1.0, 0.5], [0.0, 0.5, 1.0, 1e9]] {
            let found = Track { times: &times, values: &values, start: Some(0.0) }.crossing(2, 0.7);
            for share in [found.best, found.earliest, found.latest] {
                assert!((0.0..=1.0).contains(&share), "{values:?} {found:?}");
            }
        }
    }

    #[test]
    fn a_run_in_before_the_first_checkpoint_is_within_the_bounds() {
        // Three tenths of the limit within the first cycles, then steady: the limit of 0.2 is reached at once.
        let (times, values) = ([0.5, 1.0, 1.5], [0.65, 1.0, 1.35]);
        let found = Track { times: &times, values: &values, start: Some(0.0) }.crossing(0, 0.2);
        assert!(found.earliest < 1e-12 && found.latest > 0.3, "{found:?}");
        assert!((found.best - (0.2 / 0.65_f64).powf(LN_2 / (1.0 / 0.65_f64).ln())).abs() < 1e-9);
    }
}
