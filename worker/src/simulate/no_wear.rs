//! Scenes in which nothing wears: the outputs of one cycle are those of the whole life.
//!
//! The error follows from a second run of the cycle with time steps shorter by a factor r = 2 (Richardson): a scheme of order
//! p = 4 has the error |y - y_r| / (1 - r^-p) = 16/15 |y - y_r|, which is doubled for safety.
//!
//! # Source
//! Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I (1993), section II.4 (Richardson extrapolation).

use super::{LifeHistory, Run, Simulated};

/// Factor by which the time steps of the second run are shorter [1].
const FINER: f64 = 2.0;
/// Stated error over the difference of the two runs [1].
const SAFETY: f64 = 2.0;
/// Lower bound of the relative error of a value: rounding of some million steps [1].
const ROUNDING: f64 = 1e-10;

impl Run<'_> {
    /// Runs the cycle just measured a second time with shorter time steps, and returns the life that it stands for.
    ///
    /// # Errors
    /// [`SimulationFailure`] if the second run fails.
    pub(crate) async fn life_without_wear(&mut self) -> Simulated<LifeHistory> {
        let values = self.measured.clone();
        let finer = self.accuracy.refined(FINER);
        self.restart_cycle(&finer);
        let to_come = self.repetition.to_come.clone();
        let to_come = |k: usize| to_come.as_ref().map_or(0.0, |to_come| to_come.motion[k]);
        self.measure().await?;
        let again = self.measured.clone();
        let count = self.scene.life.checkpoints().len();
        let error = |value: f64, again: f64| (SAFETY * (value - again).abs()).max(ROUNDING * value.abs());
        let errors = values.iter().zip(again).enumerate();
        let errors = errors.map(|(k, (&v, a))| vec![to_come(k) + error(v, a); count]).collect();
        let histories = values.iter().map(|&v| vec![v; count]).collect();
        Ok(LifeHistory { histories, errors, start: values })
    }
}
