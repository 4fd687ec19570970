//! Runs evaluations side by side on one thread: each as far as it comes without motion, then the lanes.

use super::desk::{Desk, Spent};
use super::pool::Pool;
use pulp::{Arch, Scalar, Simd, WithSimd};
use std::future::Future;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};
use std::time::{Duration, Instant};

/// How many numbers the lanes hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// As many as the processor's vectors.
    Widest,
    /// One: the instructions of any processor.
    One,
}

/// One evaluation under way, and what it has taken of its thread: the time of its own stages, and of the lanes its
/// share as one of those who sat in them.
pub struct Work<'a, T> {
    stages: Pin<Box<dyn Future<Output = T> + 'a>>,
    spent: Spent,
}

impl<'a, T> Work<'a, T> {
    /// Work that meets others at `desk`.
    pub fn new<F: Future<Output = T> + 'a>(desk: &Desk, stages: impl FnOnce(Desk) -> F) -> Self {
        let desk = desk.for_another();
        Work { spent: desk.spent(), stages: Box::pin(stages(desk)) }
    }

    fn poll(&mut self) -> Poll<T> {
        // Nobody is ever woken: after each arrival everybody is asked.
        let mut context = Context::from_waker(Waker::noop());
        let begun = Instant::now();
        let result = self.stages.as_mut().poll(&mut context);
        self.spent.set(self.spent.get() + begun.elapsed());
        result
    }
}

/// Runs one piece of work by itself.
pub fn alone<'a, T: 'a, F: Future<Output = T> + 'a>(work: impl FnOnce(Desk) -> F) -> T {
    let desk = Desk::default();
    let mut work = Some(Work::new(&desk, work));
    let mut result = None;
    together(Width::Widest, &desk, 1, &mut || work.take(), &mut |_, done, _| result = Some(done));
    // The work has been taken, and what is taken is carried to its end.
    result.unwrap_or_else(|| unreachable!())
}

/// Runs what `next` gives, at most `most` pieces at a time, until it gives nothing and all have come to their end;
/// `done` takes each result with the number of its piece, counted as they were given, and what it took.
pub fn together<'a, T>(
    width: Width,
    desk: &Desk,
    most: usize,
    next: &mut dyn FnMut() -> Option<Work<'a, T>>,
    done: &mut dyn FnMut(usize, T, Duration),
) {
    let together = Together { desk, most, next, done };
    match width {
        Width::Widest => Arch::new().dispatch(together),
        Width::One => together.with_simd(Scalar::new()),
    }
}

/// The same on given lanes.
struct Together<'b, 'a, T> {
    desk: &'b Desk,
    most: usize,
    next: &'b mut dyn FnMut() -> Option<Work<'a, T>>,
    done: &'b mut dyn FnMut(usize, T, Duration),
}

impl<T> WithSimd for Together<'_, '_, T> {
    type Output = ();

    fn with_simd<S: Simd>(self, simd: S) {
        let Together { desk, most, next, done } = self;
        let mut pool = Pool::new(simd);
        let mut under_way: Vec<(usize, Work<T>)> = vec![];
        let mut given = 0;
        loop {
            while under_way.len() < most
                && let Some(work) = next()
            {
                under_way.push((given, work));
                given += 1;
            }
            let before = under_way.len();
            under_way.retain_mut(|(number, work)| match work.poll() {
                Poll::Ready(result) => {
                    done(*number, result, work.spent.get());
                    false
                }
                Poll::Pending => true,
            });
            // Whoever has come to its end may have made room for another.
            if under_way.len() < before {
                continue;
            }
            if !pool.carry(desk) {
                return;
            }
        }
    }
}
