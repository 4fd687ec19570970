//! Vectors in the plane, one number or a lane of numbers per component.

use crate::lanes::Real;

/// Inner product a . b.
#[inline(always)]
pub(crate) fn dot<R: Real>(a: [R; 2], b: [R; 2]) -> R {
    a[0] * b[0] + a[1] * b[1]
}

/// Inner product a . b with a fused operation, for kernels compiled for this processor.
#[inline(always)]
pub(crate) fn fused_dot<R: Real>(a: [R; 2], b: [R; 2]) -> R {
    (a[0] * b[0]).plus_product(a[1], b[1])
}

/// Component of a x b normal to the plane.
#[inline(always)]
pub(crate) fn cross<R: Real>(a: [R; 2], b: [R; 2]) -> R {
    a[0] * b[1] - a[1] * b[0]
}

/// Component of a x b normal to the plane with a fused operation, for kernels compiled for this processor.
#[inline(always)]
pub(crate) fn fused_cross<R: Real>(a: [R; 2], b: [R; 2]) -> R {
    (a[0] * b[1]).minus_product(a[1], b[0])
}

/// The vector turned by a quarter turn to the left.
#[inline(always)]
pub(crate) fn left<R: Real>(a: [R; 2]) -> [R; 2] {
    [-a[1], a[0]]
}

/// The vector times `factor`.
#[inline(always)]
pub(crate) fn scaled<R: Real>(a: [R; 2], factor: R) -> [R; 2] {
    [a[0] * factor, a[1] * factor]
}

/// Length |a| of a vector.
#[inline(always)]
pub(crate) fn length<R: Real>(a: [R; 2]) -> R {
    dot(a, a).sqrt()
}

/// The vector turned by the angle with cosine and sine `cs`.
#[inline(always)]
pub(crate) fn turned<R: Real>(a: [R; 2], cs: [R; 2]) -> [R; 2] {
    let [c, s] = cs;
    [c * a[0] - s * a[1], s * a[0] + c * a[1]]
}

/// The vector turned back by the angle with cosine and sine `cs`.
#[inline(always)]
pub(crate) fn turned_back<R: Real>(a: [R; 2], cs: [R; 2]) -> [R; 2] {
    let [c, s] = cs;
    [c * a[0] + s * a[1], -s * a[0] + c * a[1]]
}
