//! A number, or a SIMD vector of numbers.

use pulp::{Simd, WithSimd, bytemuck};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Work on single numbers, or in lanes that it chooses.
pub trait Vectorised {
    /// Result of the work.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

/// One number per lane, with the operations of the kernels.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + AddAssign
    + SubAssign
    + 'static
{
    /// Result of a comparison, one per lane.
    type Mask: Copy;
    /// Number of lanes.
    const LANES: usize;

    /// The numbers `number(k)` in lanes k; `self` sets the number of lanes.
    fn each(self, number: impl FnMut(usize) -> f64) -> Self;
    /// `value` in every lane; `self` sets the number of lanes.
    fn like(self, value: f64) -> Self;
    /// Number in lane `k`.
    fn lane(&self, k: usize) -> f64;
    /// Replaces the number in lane `k`.
    fn set_lane(&mut self, k: usize, value: f64);
    /// The first numbers of `from`, one per lane; `self` sets the number of lanes.
    fn load(self, from: &[f64]) -> Self;
    /// The columns of the rows of `table` whose numbers are the last 32 bits of `self`, one per lane; lane k counts its rows from `k each` on.
    fn columns(self, table: &[[f64; 4]], each: usize) -> [Self; 4];
    /// Bit k is one where the mask is true in lane k.
    fn bits(mask: Self::Mask) -> u64;
    /// Writes the numbers into the first ones of `to`.
    fn store(self, to: &mut [f64]);
    /// `self` + `a` `b`, rounded once.
    fn plus_product(self, a: Self, b: Self) -> Self;
    /// `self` - `a` `b`, rounded once.
    fn minus_product(self, a: Self, b: Self) -> Self;
    /// Square root of each number.
    fn sqrt(self) -> Self;
    /// Absolute value of each number.
    fn abs(self) -> Self;
    /// Whether `self` is below `other`; false where either is NaN.
    fn below(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is true, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Where both masks are true.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// True if the mask is true in any lane.
    fn any(mask: Self::Mask) -> bool;

    /// Does `work` in lanes like `self` as a separate function: a step that is inlined whole is one function of a size at which the
    /// compiler takes minutes. One number has no instructions of its own that such a function could be compiled for.
    #[inline(always)]
    fn apart<W: Vectorised>(self, work: W) -> W::Output {
        work.run()
    }

    /// Zero in every lane.
    #[inline(always)]
    fn zero(self) -> Self {
        self.like(0.0)
    }
    /// The larger one; `other` where either is NaN.
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self::select(other.below(self), self, other)
    }
    /// The smaller one; `other` where either is NaN.
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self::select(self.below(other), self, other)
    }
    /// The nearest whole number, ties to even; for numbers below 2^51 in size.
    #[inline(always)]
    fn round(self) -> Self {
        const SHIFT: f64 = 6755399441055744.0;
        (self + SHIFT) - SHIFT
    }
    /// `f` of each number.
    #[inline(always)]
    fn map(self, f: impl Fn(f64) -> f64) -> Self {
        self.each(|k| f(self.lane(k)))
    }
}

impl Real for f64 {
    type Mask = bool;
    const LANES: usize = 1;

    #[inline(always)]
    fn each(self, mut number: impl FnMut(usize) -> f64) -> Self {
        number(0)
    }
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn lane(&self, _k: usize) -> f64 {
        *self
    }
    #[inline(always)]
    fn set_lane(&mut self, _k: usize, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn columns(self, table: &[[f64; 4]], _each: usize) -> [Self; 4] {
        table[last_bits(self)]
    }
    #[inline(always)]
    fn bits(mask: bool) -> u64 {
        u64::from(mask)
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        f64::mul_add(a, b, self)
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        f64::mul_add(-a, b, self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }
    #[inline(always)]
    fn below(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn both(a: bool, b: bool) -> bool {
        a && b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
}

/// The last 32 bits of a number.
#[inline(always)]
fn last_bits(number: f64) -> usize {
    number.to_bits() as u32 as usize
}

/// Bit mask of a number without its sign.
const ALL_BUT_SIGN: f64 = f64::from_bits(!(1 << 63));

/// Where `deinterleave_shfl_f64s` of pulp 0.22 takes the row of lane `k` from: vectors of eight lanes come out with the lanes 1 and 2 of each
/// half exchanged, all others in their order.
#[inline(always)]
const fn place_of_row(k: usize, lanes: usize) -> usize {
    match (lanes, k & 3) {
        (8, 1) => k + 1,
        (8, 2) => k - 1,
        _ => k,
    }
}

/// A SIMD vector of the instruction set `S`, aligned as the widest ones: reading and writing across lines of the cache takes twice as long.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub struct Lanes<S: Simd> {
    simd: S,
    value: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// `value` in every lane.
    #[inline(always)]
    pub(crate) fn all(simd: S, value: f64) -> Self {
        Lanes { simd, value: simd.splat_f64s(value) }
    }

    /// The numbers, lane by lane.
    #[inline(always)]
    pub(crate) fn values(&self) -> &[f64] {
        bytemuck::cast_slice(std::slice::from_ref(&self.value))
    }
}

/// An operation lane by lane, and an operation of all lanes with one number.
macro_rules! operation {
    ($trait:ident, $method:ident, $simd:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Lanes { simd: self.simd, value: self.simd.$simd(self.value, other.value) }
            }
        }
    };
}
macro_rules! with_number {
    ($trait:ident, $method:ident) => {
        impl<S: Simd> $trait<f64> for Lanes<S> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.$method(Lanes::all(self.simd, other))
            }
        }
    };
}
operation!(Add, add, add_f64s);
operation!(Sub, sub, sub_f64s);
operation!(Mul, mul, mul_f64s);
operation!(Div, div, div_f64s);
with_number!(Add, add);
with_number!(Sub, sub);
with_number!(Mul, mul);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // -0 - x has the bits of -x, and compilers join it with the sum or product that follows; a flipped sign bit they do not.
        Lanes { simd: self.simd, value: self.simd.sub_f64s(self.simd.splat_f64s(-0.0), self.value) }
    }
}

impl<S: Simd> AddAssign for Lanes<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Simd> SubAssign for Lanes<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Simd> Real for Lanes<S> {
    type Mask = (S, S::m64s);
    const LANES: usize = S::F64_LANES;

    #[inline(always)]
    fn each(self, mut number: impl FnMut(usize) -> f64) -> Self {
        let mut value = self.value;
        let lanes: &mut [f64] = bytemuck::cast_slice_mut(std::slice::from_mut(&mut value));
        for (k, lane) in lanes.iter_mut().enumerate() {
            *lane = number(k);
        }
        Lanes { simd: self.simd, value }
    }
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Lanes::all(self.simd, value)
    }
    #[inline(always)]
    fn lane(&self, k: usize) -> f64 {
        self.values()[k]
    }
    #[inline(always)]
    fn set_lane(&mut self, k: usize, value: f64) {
        bytemuck::cast_slice_mut(std::slice::from_mut(&mut self.value))[k] = value;
    }
    #[inline(always)]
    fn load(self, from: &[f64]) -> Self {
        Lanes { simd: self.simd, value: S::as_simd_f64s(&from[..S::F64_LANES]).0[0] }
    }
    #[inline(always)]
    fn columns(self, table: &[[f64; 4]], each: usize) -> [Self; 4] {
        let mut values = [self.value; 4];
        let rows: &mut [[f64; 4]] = bytemuck::cast_slice_mut(&mut values);
        for k in 0..S::F64_LANES {
            rows[place_of_row(k, S::F64_LANES)] = table[k * each + last_bits(self.lane(k))];
        }
        let [a, b, c, d] = self.simd.deinterleave_shfl_f64s(values);
        let lanes = |value| Lanes { simd: self.simd, value };
        [lanes(a), lanes(b), lanes(c), lanes(d)]
    }
    #[inline(always)]
    fn bits((_, mask): Self::Mask) -> u64 {
        let bytes = bytemuck::bytes_of(&mask);
        if const { size_of::<S::m64s>() == 1 } {
            // One bit for each lane.
            return u64::from(bytes[0]) & ((1 << S::F64_LANES) - 1);
        }
        // A number for each lane, all of whose bits are one where the mask is true; halves of them take fewest instructions.
        let halves: &[u32] = bytemuck::cast_slice(bytes);
        let each = halves.len() / S::F64_LANES;
        let mut bits = 0;
        for k in 0..S::F64_LANES {
            bits |= halves[each * k] & (1 << k);
        }
        u64::from(bits)
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        S::as_mut_simd_f64s(&mut to[..S::F64_LANES]).0[0] = self.value;
    }
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        Lanes { simd: self.simd, value: self.simd.mul_add_f64s(a.value, b.value, self.value) }
    }
    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        Lanes { simd: self.simd, value: self.simd.negate_mul_add_f64s(a.value, b.value, self.value) }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Lanes { simd: self.simd, value: self.simd.sqrt_f64s(self.value) }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Lanes { simd: self.simd, value: self.simd.and_f64s(self.value, self.simd.splat_f64s(ALL_BUT_SIGN)) }
    }
    #[inline(always)]
    fn below(self, other: Self) -> Self::Mask {
        (self.simd, self.simd.less_than_f64s(self.value, other.value))
    }
    #[inline(always)]
    fn select((simd, mask): Self::Mask, yes: Self, no: Self) -> Self {
        Lanes { simd, value: simd.select_f64s(mask, yes.value, no.value) }
    }
    #[inline(always)]
    fn apart<W: Vectorised>(self, work: W) -> W::Output {
        run_apart(self.simd, work)
    }
    #[inline(always)]
    fn both((simd, a): Self::Mask, (_, b): Self::Mask) -> Self::Mask {
        (simd, simd.and_m64s(a, b))
    }
    #[inline(always)]
    fn any((simd, mask): Self::Mask) -> bool {
        simd.first_true_m64s(mask) < S::F64_LANES
    }
}

/// Does `work`, which uses lanes of `simd`, with its instructions.
pub(crate) fn run_in<S: Simd, W: Vectorised>(simd: S, work: W) -> W::Output {
    simd.vectorize(OnProcessor(work))
}

/// As [`run_in`], never inlined.
#[inline(never)]
fn run_apart<S: Simd, W: Vectorised>(simd: S, work: W) -> W::Output {
    run_in(simd, work)
}

/// Work for the instructions of any lanes.
pub(super) struct OnProcessor<W>(pub W);

impl<W: Vectorised> WithSimd for OnProcessor<W> {
    type Output = W::Output;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _simd: S) -> W::Output {
        self.0.run()
    }
}
