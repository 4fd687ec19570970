//! Values whose numbers differ from lane to lane while their structure is shared.

use super::Real;

/// A value of numbers and indices: in lanes each number becomes a lane of numbers, each index stays one
/// index.
pub trait Lanewise {
    /// The value in lanes.
    type Lanes<R: Real>;
    /// This value in every lane; `like` sets the number of lanes.
    fn in_lanes<R: Real>(&self, like: R) -> Self::Lanes<R>;
    /// Writes the numbers into lane `lane` of `to`, a value of the same topology.
    fn write_lane<R: Real>(&self, lane: usize, to: &mut Self::Lanes<R>);
    /// Whether the indices and the structure agree: such values fit into the lanes of one value.
    fn has_same_topology(&self, other: &Self) -> bool;
}

/// Implements [`Lanewise`] for a value that is the same in all lanes.
macro_rules! same_in_lanes {
    ($name:ty) => {
        impl $crate::lanes::Lanewise for $name {
            type Lanes<R: $crate::lanes::Real> = $name;
            fn in_lanes<R: $crate::lanes::Real>(&self, _like: R) -> $name {
                *self
            }
            fn write_lane<R: $crate::lanes::Real>(&self, _lane: usize, _to: &mut $name) {}
            fn has_same_topology(&self, other: &Self) -> bool {
                self == other
            }
        }
    };
}

impl Lanewise for f64 {
    type Lanes<R: Real> = R;
    fn in_lanes<R: Real>(&self, like: R) -> R {
        like.like(*self)
    }
    fn write_lane<R: Real>(&self, lane: usize, to: &mut R) {
        to.set_lane(lane, *self);
    }
    fn has_same_topology(&self, _other: &Self) -> bool {
        true
    }
}

same_in_lanes!(usize);

impl<T: Lanewise, const N: usize> Lanewise for [T; N] {
    type Lanes<R: Real> = [T::Lanes<R>; N];
    fn in_lanes<R: Real>(&self, like: R) -> Self::Lanes<R> {
        std::array::from_fn(|k| self[k].in_lanes::<R>(like))
    }
    fn write_lane<R: Real>(&self, lane: usize, to: &mut Self::Lanes<R>) {
        self.iter().zip(to).for_each(|(from, to)| from.write_lane::<R>(lane, to));
    }
    fn has_same_topology(&self, other: &Self) -> bool {
        self.iter().zip(other).all(|(a, b)| a.has_same_topology(b))
    }
}

impl<T: Lanewise> Lanewise for Option<T> {
    type Lanes<R: Real> = Option<T::Lanes<R>>;
    fn in_lanes<R: Real>(&self, like: R) -> Self::Lanes<R> {
        self.as_ref().map(|value| value.in_lanes::<R>(like))
    }
    fn write_lane<R: Real>(&self, lane: usize, to: &mut Self::Lanes<R>) {
        if let (Some(from), Some(to)) = (self, to) {
            from.write_lane::<R>(lane, to);
        }
    }
    fn has_same_topology(&self, other: &Self) -> bool {
        match (self, other) {
            (Some(a), Some(b)) => a.has_same_topology(b),
            (None, None) => true,
            _ => false,
        }
    }
}

/// Numbers, lane by lane.
pub trait InLane {
    /// What the number of one lane is.
    type One;
    /// The numbers in lane `k`.
    fn in_lane(&self, k: usize) -> Self::One;
}

impl<R: Real> InLane for R {
    type One = f64;
    fn in_lane(&self, k: usize) -> f64 {
        self.lane(k)
    }
}

impl<T: InLane, const N: usize> InLane for [T; N] {
    type One = [T::One; N];
    fn in_lane(&self, k: usize) -> Self::One {
        std::array::from_fn(|i| self[i].in_lane(k))
    }
}

/// Implements [`InLane`] for a struct, field by field.
macro_rules! in_lane {
    ($name:ident { $($field:ident),+ $(,)? }) => {
        impl<R: $crate::lanes::Real> $crate::lanes::InLane for $name<R> {
            type One = $name;
            fn in_lane(&self, k: usize) -> $name {
                $name { $($field: self.$field.in_lane(k)),+ }
            }
        }
    };
}

/// Reads the numbers of a lane into those of one system, of the same length.
pub(crate) fn read_lane<T: InLane>(from: &[T], lane: usize, to: &mut [T::One]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = from.in_lane(lane));
}

/// Implements [`Lanewise`] for a struct, field by field; for one of `numbers` alone also [`InLane`].
macro_rules! lanewise {
    (numbers $name:ident { $($field:ident),+ $(,)? }) => {
        $crate::lanes::lanewise!($name { $($field),+ });
        $crate::lanes::in_lane!($name { $($field),+ });
    };
    ($name:ident { $($field:ident),+ $(,)? }) => {
        impl $crate::lanes::Lanewise for $name {
            type Lanes<R: $crate::lanes::Real> = $name<R>;
            fn in_lanes<R: $crate::lanes::Real>(&self, like: R) -> $name<R> {
                $name { $($field: self.$field.in_lanes::<R>(like)),+ }
            }
            fn write_lane<R: $crate::lanes::Real>(&self, lane: usize, to: &mut $name<R>) {
                $(self.$field.write_lane::<R>(lane, &mut to.$field);)+
            }
            fn has_same_topology(&self, other: &Self) -> bool {
                $(self.$field.has_same_topology(&other.$field))&&+
            }
        }
    };
}

pub(crate) use {in_lane, lanewise, same_in_lanes};
