//! Several stages of one evaluation at the same time: their islands wait for lanes together.

use std::future::{Future, poll_fn};
use std::pin::Pin;
use std::task::Poll;

/// Runs the futures `stages` until all have ended; the results are in their order.
pub(crate) async fn join<'f, T, F: Future<Output = T> + 'f>(stages: impl IntoIterator<Item = F>) -> Vec<T> {
    type Stage<'f, T> = Pin<Box<dyn Future<Output = T> + 'f>>;
    let mut running: Vec<(Stage<'f, T>, Option<T>)> =
        stages.into_iter().map(|stage| (Box::pin(stage) as Stage<'f, T>, None)).collect();
    poll_fn(|context| {
        for (stage, result) in running.iter_mut().filter(|(_, result)| result.is_none()) {
            if let Poll::Ready(ended) = stage.as_mut().poll(context) {
                *result = Some(ended);
            }
        }
        if running.iter().all(|(_, result)| result.is_some()) { Poll::Ready(()) } else { Poll::Pending }
    })
    .await;
    running.into_iter().filter_map(|(_, result)| result).collect()
}
