//! Derivatives of the force of a guide against differences, for the tests of flat and of worn faces.

use super::frame::Frame;
use super::guide::Guiding;

/// Asserts that the derivatives of the force in the state `q`, `v` are those of its differences, and that something touches; `of` is named in messages.
pub(super) fn assert_derivatives(guide: &impl Guiding<f64>, q: &[f64; 6], v: &[f64; 6], of: &str) {
    let frames = |q: &[f64; 6], v: &[f64; 6]| [Frame::free(&q[..3], &v[..3]), Frame::free(&q[3..], &v[3..])];
    let exact = guide.force::<true>(&frames(q, v)).0;
    assert!(exact.f.iter().any(|f| f.abs() > 1.0), "{of}: nothing touches");
    let scale = |rows: &[[f64; 6]; 6], r: usize| rows[r].iter().fold(1.0_f64, |a, b| a.max(b.abs()));
    for c in 0..6 {
        let moved = |h: f64| {
            let mut q = *q;
            q[c] += h;
            guide.force::<false>(&frames(&q, v)).0.f
        };
        let faster = |h: f64| {
            let mut v = *v;
            v[c] += h;
            guide.force::<false>(&frames(q, &v)).0.f
        };
        let h = if c % 3 == 2 { 2e-9 } else { 1e-10 };
        let (low, high, slow, fast) = (moved(-h), moved(h), faster(-1e-6), faster(1e-6));
        for r in 0..6 {
            let (k, d) = ((high[r] - low[r]) / (2.0 * h), (fast[r] - slow[r]) / 2e-6);
            let (k_off, d_off) = ((exact.k[r][c] - k).abs(), (exact.d[r][c] - d).abs());
            assert!(k_off < 1e-4 * scale(&exact.k, r), "{of} k {r} {c}: {} {k}", exact.k[r][c]);
            assert!(d_off < 1e-5 * scale(&exact.d, r), "{of} d {r} {c}: {} {d}", exact.d[r][c]);
        }
    }
}
