//! Largest difference of two bodies' angles or angular velocities over a cycle.

use super::BodyTrack;
use super::trace::Piece;

/// In interval `k` of a track, the angular velocity [rad/s] if `SPEED`, else the angle [rad].
#[inline]
fn piece<const SPEED: bool>(track: &BodyTrack, k: usize) -> Piece {
    if SPEED { track.omega_in(k) } else { track.angle_in(k) }
}

/// Bounds of the same, the cubic through values and slopes at both ends of the interval: the mean of the values and the largest distance from
/// it. Limited slopes of the velocity are nearer to the secant.
///
/// With the slopes d0, d1 and the rise r over the interval the cubic lies s (1 - s) ((1 - s) (d0 - r) - s (d1 - r)) beside its chord,
/// s in [0, 1]: at most 4/27 (|d0 - r| + |d1 - r|).
#[inline]
fn bounds<const SPEED: bool>(BodyTrack { time, values }: &BodyTrack, k: usize) -> [f64; 2] {
    let [value, slope] = [0, 1].map(|rate| &values[usize::from(SPEED) + rate]);
    let h = time[k + 1] - time[k];
    let rise = value[k + 1] - value[k];
    let middle = 0.5 * (value[k] + value[k + 1]);
    let beside = (h * slope[k] - rise).abs() + (h * slope[k + 1] - rise).abs();
    // Something more than rounding.
    [middle, 0.5 * rise.abs() + 0.149 * beside + 1e-12 * middle.abs()]
}

/// One of the two tracks while they are compared.
struct SignedTrack<'a> {
    track: &'a BodyTrack,
    sign: f64,
    /// Interval of the track that contains the present time.
    interval: usize,
    /// Bounds of the quantity there.
    bounds: [f64; 2],
    /// The quantity there, and its value and slope at the present time, once they are needed.
    piece: Option<(Piece, (f64, f64))>,
}

impl<'a> SignedTrack<'a> {
    fn new<const SPEED: bool>((track, sign): (&'a BodyTrack, f64)) -> Self {
        SignedTrack { track, sign, interval: 0, bounds: bounds::<SPEED>(track, 0), piece: None }
    }

    /// Start and end of the present interval [s].
    #[inline]
    fn start(&self) -> f64 {
        self.track.time[self.interval]
    }
    #[inline]
    fn end(&self) -> f64 {
        self.track.time[self.interval + 1]
    }

    /// Value and slope at the times `t0`, the present one, and `t1` [s], which is the present one from now on.
    #[inline]
    fn at_both<const SPEED: bool>(&mut self, t0: f64, t1: f64) -> [(f64, f64); 2] {
        let (piece, now) = self.piece.unwrap_or_else(|| {
            let piece = piece::<SPEED>(self.track, self.interval);
            (piece, piece.at(t0))
        });
        let then = piece.at(t1);
        self.piece = Some((piece, then));
        [now, then]
    }

    /// Goes on to the next interval. False if there is none.
    #[inline]
    fn go_on<const SPEED: bool>(&mut self) -> bool {
        self.interval += 1;
        let any = self.interval + 1 < self.track.time.len();
        if any {
            (self.bounds, self.piece) = (bounds::<SPEED>(self.track, self.interval), None);
        }
        any
    }
}

/// The outputs `angular-velocity-difference` [rad/s] (`SPEED`) and `angle-difference` [rad]:
/// max over t of |s_a x_a(t) - s_b x_b(t)| for a quantity x of two tracks over the same span of time, each given with its sign.
///
/// The two tracks have times of their own; between two neighbouring times of either, both are cubics. Their difference is a
/// cubic too, and its extremum is found exactly: a vibration sampled a few times a period keeps its peak. Where bounds of both cubics say
/// that their difference is smaller than the largest one so far, it is not computed.
pub(super) fn largest_difference<const SPEED: bool>(a: (&BodyTrack, f64), b: (&BodyTrack, f64)) -> f64 {
    let (mut a, mut b) = (SignedTrack::new::<SPEED>(a), SignedTrack::new::<SPEED>(b));
    let (sign_a, sign_b) = (a.sign, b.sign);
    let difference =
        |(x, dx): (f64, f64), (y, dy): (f64, f64)| (sign_a * x - sign_b * y, sign_a * dx - sign_b * dy);
    let mut t0 = a.start().max(b.start());
    let mut largest: f64 = 0.0;
    loop {
        let t1 = a.end().min(b.end());
        if t1 > t0 {
            let middle = (sign_a * a.bounds[0] - sign_b * b.bounds[0]).abs();
            if middle + a.bounds[1] + b.bounds[1] < largest {
                (a.piece, b.piece) = (None, None);
            } else {
                let ([a0, a1], [b0, b1]) = (a.at_both::<SPEED>(t0, t1), b.at_both::<SPEED>(t0, t1));
                let ((y0, d0), (y1, d1)) = (difference(a0, b0), difference(a1, b1));
                largest = largest.max(y0.abs()).max(y1.abs());
                if d0 * d1 < 0.0 {
                    largest = largest.max(extremum(y0, d0 * (t1 - t0), y1, d1 * (t1 - t0)).abs());
                }
            }
            t0 = t1;
        }
        if a.end() <= t1 && !a.go_on::<SPEED>() || b.end() <= t1 && !b.go_on::<SPEED>() {
            return largest;
        }
    }
}

/// Value at the interior extremum of the cubic on [0, 1] with end values y and end slopes d of opposite sign.
fn extremum(y0: f64, d0: f64, y1: f64, d1: f64) -> f64 {
    let c = 3.0 * (y1 - y0) - 2.0 * d0 - d1;
    let d = d0 + d1 - 2.0 * (y1 - y0);
    // 3 d s^2 + 2 c s + d0 = 0, in the form that does not cancel; one root lies in (0, 1).
    let root = (c * c - 3.0 * d * d0).max(0.0).sqrt();
    let q = -(c + root.copysign(c));
    let candidates = [if q != 0.0 { d0 / q } else { 0.5 }, if d != 0.0 { q / (3.0 * d) } else { 0.5 }];
    let s = candidates.into_iter().find(|s| (0.0..=1.0).contains(s)).unwrap_or(0.5);
    y0 + s * (d0 + s * (c + s * d))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn track(times: &[f64], f: impl Fn(f64) -> (f64, f64)) -> BodyTrack {
        let mut track = BodyTrack::default();
        for &t in times {
            track.push(t, [0.0, f(t).0, f(t).1]);
        }
        track
    }

    #[test]
    fn finds_the_peak_between_coarse_samples() {
        // Nine samples a period, shifted so that none lies on the peak of 1.
        let times: Vec<f64> = (0..=90).map(|k| k as f64 / 90.0 * 10.0).collect();
        let wave = track(&times, |t| {
            let x = std::f64::consts::TAU * t + 0.2;
            (x.sin(), std::f64::consts::TAU * x.cos())
        });
        let still = track(&[0.0, 3.3, 10.0], |_| (0.25, 0.0));
        let peak = largest_difference::<true>((&wave, 1.0), (&still, 1.0));
        assert!((peak - 1.25).abs() < 2e-3, "{peak}");
        let peak = largest_difference::<true>((&wave, 1.0), (&still, -1.0));
        assert!((peak - 1.25).abs() < 2e-3, "{peak}");
    }

    #[test]
    fn the_bounds_of_a_piece_hold_and_leave_out_no_peak() {
        // Two beating vibrations with rates that do not fit them: the largest difference of a fine grid is not above the one found.
        let wild = |k: u32, shift: f64| {
            let t = 0.37 * f64::from(k) + shift;
            ((1.3 * t).sin() * (0.01 * t).cos(), 4.0 * (7.1 * t).sin())
        };
        let (mut a, mut b) = (BodyTrack::default(), BodyTrack::default());
        for k in 0..400 {
            let (omega, alpha) = wild(k, 0.1);
            a.push(0.37 * f64::from(k), [0.1 * omega, omega, alpha]);
            let (omega, alpha) = wild(k, 0.9);
            b.push(0.37 * f64::from(k), [0.3 * omega, 0.5 * omega, alpha]);
        }
        let (mut speeds, mut angles) = (0.0_f64, 0.0_f64);
        for k in 0..399 {
            for step in 0..=50 {
                let t = a.time[k] + 0.37 * f64::from(step) / 50.0;
                for (of_a, of_b, [middle, reach], largest) in [
                    (a.omega_in(k), b.omega_in(k), bounds::<true>(&a, k), &mut speeds),
                    (a.angle_in(k), b.angle_in(k), bounds::<false>(&a, k), &mut angles),
                ] {
                    assert!((of_a.at(t).0 - middle).abs() <= reach);
                    *largest = largest.max((of_a.at(t).0 - of_b.at(t).0).abs());
                }
            }
        }
        let found = [
            largest_difference::<true>((&a, 1.0), (&b, 1.0)),
            largest_difference::<false>((&a, 1.0), (&b, 1.0)),
        ];
        for (found, grid) in found.into_iter().zip([speeds, angles]) {
            assert!(found >= grid && found < 1.01 * grid, "{found} {grid}");
        }
    }
}
