//! Runs evaluations side by side on one thread: each as far as it comes without motion, then the lanes.

use super::desk::Desk;
use super::pool::Pool;
use pulp::{Arch, Simd, WithSimd};
use std::future::Future;
use std::pin::Pin;
use std::task::{Context, Poll, Waker};

/// One evaluation under way.
pub type Work<'a, T> = Pin<Box<dyn Future<Output = T> + 'a>>;

/// Runs one piece of work by itself.
pub fn alone<'a, T: 'a, F: Future<Output = T> + 'a>(work: impl FnOnce(Desk) -> F) -> T {
    let desk = Desk::default();
    let mut work: Option<Work<'a, T>> = Some(Box::pin(work(desk.clone())));
    let mut result = None;
    together(&desk, 1, &mut || work.take(), &mut |_, done| result = Some(done));
    // The work has been taken, and what is taken is carried to its end.
    result.unwrap_or_else(|| unreachable!())
}

/// Runs what `next` gives, at most `most` pieces at a time, until it gives nothing and all have come to their end;
/// `done` takes each result with the number of its piece, counted as they were given.
pub fn together<'a, T>(
    desk: &Desk,
    most: usize,
    next: &mut dyn FnMut() -> Option<Work<'a, T>>,
    done: &mut dyn FnMut(usize, T),
) {
    Arch::new().dispatch(Together { desk, most, next, done });
}

/// The same on given lanes.
pub struct Together<'b, 'a, T> {
    /// Where the work hands in its stretches.
    pub desk: &'b Desk,
    /// Pieces at a time.
    pub most: usize,
    /// Gives more.
    pub next: &'b mut dyn FnMut() -> Option<Work<'a, T>>,
    /// Takes results.
    pub done: &'b mut dyn FnMut(usize, T),
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
            // Nobody is ever woken: after each arrival everybody is asked.
            let mut context = Context::from_waker(Waker::noop());
            let before = under_way.len();
            under_way.retain_mut(|(number, work)| match work.as_mut().poll(&mut context) {
                Poll::Ready(result) => {
                    done(*number, result);
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
