//! A campaign with simulations made in place, one after the other: for published problems, replays and tests.

use super::campaign::Campaign;
use super::campaign_result::CampaignResult;
use super::observations::ObservedOutcome;
use super::step::{CampaignError, SampleRequest, Step};
use std::collections::VecDeque;

impl Campaign {
    /// Runs the campaign to its end with simulations made here, one after the other. `observe` receives the
    /// campaign after each step.
    ///
    /// # Errors
    /// [`CampaignError`].
    pub fn learn_from(
        mut self,
        mut simulate: impl FnMut(&[f64]) -> ObservedOutcome,
        mut observe: impl FnMut(&Self),
    ) -> Result<CampaignResult, CampaignError> {
        let mut under_way = VecDeque::new();
        loop {
            let step = self.next_step()?;
            observe(&self);
            match step {
                Step::Evaluate(requests) => under_way.push_back(requests),
                Step::Wait => {
                    let requests: Vec<SampleRequest> =
                        under_way.pop_front().expect("a campaign waits for requested samples only");
                    self.record(requests.iter().map(|request| simulate(&request.sample)).collect())?;
                }
                Step::Done => break,
            }
        }
        Ok(self.finish().expect("a campaign that is done has a result"))
    }
}
