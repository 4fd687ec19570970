//! Loads in lanes: the same kind of load on the same frames, with numbers of its own in each lane.

use super::frame::End;
use super::load::{IslandLoad, Size};
use super::table::PiecewiseCubic;
use crate::lanes::Real;

impl IslandLoad {
    /// Whether another load differs in numbers alone.
    pub(super) fn has_make_of(&self, other: &IslandLoad) -> bool {
        let size = |a: &Size, b: &Size| match (a, b) {
            (Size::OverAngle(_, a), Size::OverAngle(_, b)) => a == b,
            _ => std::mem::discriminant(a) == std::mem::discriminant(b),
        };
        let sizes = match (self, other) {
            (Self::Force { size: a, .. }, Self::Force { size: b, .. })
            | (Self::Torque { size: a, .. }, Self::Torque { size: b, .. }) => size(a, b),
            _ => true,
        };
        std::mem::discriminant(self) == std::mem::discriminant(other)
            && self.frames() == other.frames()
            && sizes
    }

    /// The same in every lane.
    pub(super) fn in_lanes<R: Real>(&self, like: R) -> IslandLoad<R> {
        let all = |x: &f64| like.like(*x);
        let end = |end: &End| End { frame: end.frame, arm: end.arm.map(|x| like.like(x)) };
        let tables = |tables: &[PiecewiseCubic]| vec![tables[0].clone(); R::LANES];
        let size = |size: &Size| match size {
            Size::Constant(size) => Size::Constant(all(size)),
            Size::OverTime(of) => Size::OverTime(tables(of)),
            Size::OverAngle(of, frame) => Size::OverAngle(tables(of), *frame),
        };
        match self {
            Self::DirectionalSpring { ends, direction, stiffness, free_length } => {
                IslandLoad::DirectionalSpring {
                    ends: [end(&ends[0]), end(&ends[1])],
                    direction: direction.map(|x| like.like(x)),
                    stiffness: all(stiffness),
                    free_length: all(free_length),
                }
            }
            Self::Spring { ends, stiffness, damping, free_length } => IslandLoad::Spring {
                ends: [end(&ends[0]), end(&ends[1])],
                stiffness: all(stiffness),
                damping: all(damping),
                free_length: all(free_length),
            },
            Self::TorsionSpring { frames, stiffness, damping, free_angle } => IslandLoad::TorsionSpring {
                frames: *frames,
                stiffness: all(stiffness),
                damping: all(damping),
                free_angle: all(free_angle),
            },
            Self::Force { end: at, direction, size: of } => {
                IslandLoad::Force { end: end(at), direction: direction.map(|x| like.like(x)), size: size(of) }
            }
            Self::Torque { frame, size: of } => IslandLoad::Torque { frame: *frame, size: size(of) },
            Self::Motor { frame, stall_torque, no_load_speed } => IslandLoad::Motor {
                frame: *frame,
                stall_torque: all(stall_torque),
                no_load_speed: all(no_load_speed),
            },
        }
    }
}

impl<R: Real> IslandLoad<R> {
    /// Replaces the numbers of a lane by those of a load of the same make.
    pub(super) fn set_lane(&mut self, lane: usize, from: &IslandLoad) {
        let mut from = from.clone();
        self.numbers_mut().zip(from.numbers_mut()).for_each(|(to, from)| to.set_lane(lane, *from));
        if let Some(to) = self.tables_mut()
            && let Some(from) = from.tables_mut()
        {
            to[lane].clone_from(&from[0]);
        }
    }

    /// The tables of its size, if it has any.
    fn tables_mut(&mut self) -> Option<&mut Vec<PiecewiseCubic>> {
        match self {
            Self::Force { size, .. } | Self::Torque { size, .. } => match size {
                Size::OverTime(tables) | Size::OverAngle(tables, _) => Some(tables),
                Size::Constant(_) => None,
            },
            _ => None,
        }
    }

    /// Every number of the load, tables aside.
    fn numbers_mut(&mut self) -> impl Iterator<Item = &mut R> {
        fn two<R>(ends: &mut [End<R>; 2]) -> Vec<&mut R> {
            ends.iter_mut().flat_map(|end| &mut end.arm).collect()
        }
        let all: Vec<&mut R> = match self {
            Self::DirectionalSpring { ends, direction, stiffness, free_length } => {
                two(ends).into_iter().chain(direction).chain([stiffness, free_length]).collect()
            }
            Self::Spring { ends, stiffness, damping, free_length } => {
                two(ends).into_iter().chain([stiffness, damping, free_length]).collect()
            }
            Self::TorsionSpring { stiffness, damping, free_angle, .. } => {
                vec![stiffness, damping, free_angle]
            }
            Self::Force { end, direction, size } => {
                end.arm.iter_mut().chain(direction).chain(constant_of(size)).collect()
            }
            Self::Torque { size, .. } => constant_of(size).into_iter().collect(),
            Self::Motor { stall_torque, no_load_speed, .. } => vec![stall_torque, no_load_speed],
        };
        all.into_iter()
    }
}

/// The number of a size that is always the same.
fn constant_of<R>(size: &mut Size<R>) -> Option<&mut R> {
    match size {
        Size::Constant(size) => Some(size),
        _ => None,
    }
}
