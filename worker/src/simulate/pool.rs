//! Lanes that carry islands of any number of evaluations: whoever has arrived leaves, and the next in line of the same
//! make takes the place.

use super::desk::{Desk, Spent, Ticket};
use super::moving::Moving;
use crate::integrate::{Abreast, AdvanceError, Linearised, Seat, Stepped, Watch, worst_coordinate};
use crate::lanes::Lanes;
use crate::mechanism::{Island, IslandLanes, same_topology};
use pulp::{Simd, WithSimd};
use std::time::Instant;

/// All groups of one thread.
pub struct Pool<S: Simd> {
    simd: S,
    groups: Vec<Group<S>>,
}

impl<S: Simd> Pool<S> {
    /// Without groups yet.
    pub fn new(simd: S) -> Self {
        Pool { simd, groups: vec![] }
    }

    /// Seats whoever waits at the desk, and carries one group until somebody has arrived, all who sit in it sharing the
    /// time; false if nobody is there.
    pub fn carry(&mut self, desk: &Desk) -> bool {
        self.groups.iter_mut().for_each(|group| group.fill(desk));
        while let Some(ticket) = desk.next(|_| true) {
            let group = Group::new(self.simd, ticket);
            // Groups of makes that are no longer asked for make room.
            self.groups.retain(|group| group.taken() > 0);
            self.groups.push(group);
            self.groups.iter_mut().for_each(|group| group.fill(desk));
        }
        // The fullest, but nobody is passed over for ever.
        let mut waiting: Vec<_> = self.groups.iter_mut().filter(|group| group.taken() > 0).collect();
        waiting.iter_mut().for_each(|group| group.passed_over += 1);
        let Some(group) = waiting.into_iter().max_by_key(|group| group.taken() + group.passed_over) else {
            return false;
        };
        group.passed_over = 0;
        let aboard: Vec<Spent> = group.riders.iter().flatten().map(Ticket::spent).collect();
        let begun = Instant::now();
        loop {
            self.simd.vectorize(Attempt(group));
            if group.settle() {
                break;
            }
        }
        let share = begun.elapsed() / aboard.len().max(1) as u32;
        aboard.iter().for_each(|spent| spent.set(spent.get() + share));
        true
    }
}

/// Islands of one make, abreast.
struct Group<S: Simd> {
    /// One of them, to compare with.
    make: Island,
    pack: IslandLanes<Lanes<S>>,
    abreast: Abreast<Lanes<S>>,
    riders: Vec<Option<Ticket>>,
    /// Times that another group was carried since this one was.
    passed_over: usize,
    /// One lane's view of a round.
    view: Linearised,
    q: Vec<f64>,
    v: Vec<f64>,
}

/// First half of a round, compiled for the instruction set of the lanes.
struct Attempt<'a, S: Simd>(&'a mut Group<S>);

impl<S: Simd> WithSimd for Attempt<'_, S> {
    type Output = ();

    #[inline(always)]
    fn with_simd<T: Simd>(self, _simd: T) {
        let Group { pack, abreast, .. } = self.0;
        abreast.attempt(pack);
    }
}

impl<S: Simd> Group<S> {
    fn new(simd: S, first: Ticket) -> Self {
        let moving = &first.stretch.moving;
        let (make, like) = (moving.island.clone(), Lanes::all(simd, 0.0));
        let pack = IslandLanes::new(&make, like);
        let abreast = Abreast::new(like, pack.linearised(), moving.advance.control.largest);
        let mut group = Group {
            view: make.linearised(),
            q: moving.q.clone(),
            v: moving.v.clone(),
            riders: (0..S::F64_LANES).map(|_| None).collect(),
            passed_over: 0,
            make,
            pack,
            abreast,
        };
        // Idle lanes compute along: from a state that exists.
        for lane in 0..S::F64_LANES {
            group.abreast.place(lane, &group.q, &group.v);
        }
        group.seat(0, first);
        group
    }

    fn taken(&self) -> usize {
        self.riders.iter().flatten().count()
    }

    /// Seats who waits and fits.
    fn fill(&mut self, desk: &Desk) {
        for lane in 0..S::F64_LANES {
            if self.riders[lane].is_some() {
                continue;
            }
            let make = &self.make;
            let Some(ticket) = desk.next(|stretch| same_topology(make, &stretch.moving.island)) else {
                return;
            };
            self.seat(lane, ticket);
        }
    }

    fn seat(&mut self, lane: usize, ticket: Ticket) {
        let stretch = &ticket.stretch;
        self.pack.set(lane, &stretch.moving.island);
        self.abreast.place(lane, &stretch.moving.q, &stretch.moving.v);
        self.abreast.seats[lane] = Some(Seat::new(stretch.from, stretch.to, stretch.moving.advance.control));
        self.riders[lane] = Some(ticket);
    }

    /// Second half of a round; true if somebody has left.
    fn settle(&mut self) -> bool {
        let mut left = false;
        for lane in 0..S::F64_LANES {
            let done = match self.watch(lane) {
                Ok(()) => self.abreast.settle(lane),
                Err(error) => Err(error),
            };
            match done {
                Ok(false) => continue,
                Ok(true) => self.leave(lane, Ok(())),
                Err(error) => {
                    let error = self.blame(lane, error);
                    self.leave(lane, Err(error));
                }
            }
            left = true;
        }
        left
    }

    /// Shows a state reached to whoever watches.
    fn watch(&mut self, lane: usize) -> Result<(), AdvanceError> {
        let (Some(seat), Some(ticket)) = (&self.abreast.seats[lane], &mut self.riders[lane]) else {
            return Ok(());
        };
        if !seat.is_fresh() {
            return Ok(());
        }
        let time = seat.time;
        if !self.abreast.is_finite(lane) {
            return Err(AdvanceError::NotFinite { time });
        }
        let Moving { island, recorder, .. } = &mut ticket.stretch.moving;
        for (joint, (force, of)) in self.abreast.at.joints.iter().zip(&island.joints).enumerate() {
            let penetration = force.penetration.values()[lane];
            if penetration > of.contact.surface().deepest() {
                return Err(AdvanceError::OutOfRange { time, joint, penetration });
            }
        }
        if ticket.stretch.record {
            self.abreast.view(lane, &mut self.view);
            self.abreast.state(lane, &mut self.q, &mut self.v);
            if recorder.shown.is_some() {
                island.set_state(time, &self.q, &self.v);
            }
            recorder.state(island, time, &self.q, &self.v, &self.view);
        }
        Ok(())
    }

    /// Names the joint that stopped a lane.
    fn blame(&mut self, lane: usize, error: AdvanceError) -> AdvanceError {
        let Some(ticket) = &self.riders[lane] else { return error };
        self.abreast.view(lane, &mut self.view);
        let island = &ticket.stretch.moving.island;
        let coordinate = worst_coordinate(self.abreast.errors(lane), island.scales());
        let blamed = coordinate.and_then(|coordinate| island.responsible_joint(coordinate, &self.view));
        match error {
            AdvanceError::StepTooSmall { time, step, error, .. } => {
                AdvanceError::StepTooSmall { time, step, error, joint: blamed }
            }
            AdvanceError::TooManySteps { time, bound, .. } => {
                AdvanceError::TooManySteps { time, bound, joint: blamed }
            }
            other => other,
        }
    }

    fn leave(&mut self, lane: usize, arrived: Result<(), AdvanceError>) {
        let (Some(seat), Some(mut ticket)) = (self.abreast.seats[lane].take(), self.riders[lane].take())
        else {
            return;
        };
        let moving = &mut ticket.stretch.moving;
        moving.advance.control = seat.control;
        self.abreast.state(lane, &mut moving.q, &mut moving.v);
        ticket.close(seat.stats, arrived);
    }
}
