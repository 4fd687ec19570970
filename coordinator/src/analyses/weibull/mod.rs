//! What engineers do with lives of a population today, the two-parameter Weibull distribution with suspensions, beside the reliability
//! of a study: fit and bounds, the evidence of both, and whether the data contradict the study.
//!
//! The evidence of the study is the mean likelihood of the data over the curves that its intervals allow. That of the Weibull
//! distribution is its largest likelihood over the number of failures r, ln L - (k / 2) ln r with k = 2 parameters (Schwarz), which
//! were fitted to the same data. The data contradict the study where a test at 5 % rejects every curve of its 95 % band.
//!
//! # Source
//! IEC 61649:2008; Schwarz (1978), Estimating the dimension of a model, Annals of Statistics 6; Kass, Raftery (1995), Bayes factors,
//! Journal of the American Statistical Association 90.

mod data_file;
mod text;

pub use data_file::{LifeQuestion, read as read_lives};
pub use text::{answer, json};

use crate::analyses::error::RefusedQuestion;
use crate::analyses::replace::curve_of;
use crate::results::summary::StudySummary;
use crate::statistics::design::{Stream, open_stream};
use crate::statistics::goodness_of_fit::{GoodnessOfFit, anderson_darling};
use crate::statistics::life_data::{
    NoMaximum, UnitLife, WeibullFit, censored_anderson_darling, evidence_of_curve, test_of_curve,
};
use crate::statistics::replacement::CurveBand;
use common::random::Family;

/// Fewest failures for the test of Anderson and Darling.
const FEWEST: usize = 5;

/// Data with their Weibull distribution.
#[derive(Debug)]
pub struct WeibullReport {
    /// What is known of the units.
    pub lives: Vec<UnitLife>,
    /// The distribution of largest likelihood.
    pub fit: WeibullFit,
    /// Two-sided confidence of all bounds [1].
    pub confidence: f64,
    /// Reliability whose life is stated [1].
    pub level: f64,
    /// Test of the family, if there are five failures or more and no interval.
    pub goodness: Option<GoodnessOfFit>,
    /// Comparison with a study.
    pub study: Option<StudyEvidence>,
}

/// A curve of a study against the data.
#[derive(Debug)]
pub struct StudyEvidence {
    /// Scene of the study.
    pub scene: String,
    /// Limit state, or `total`.
    pub curve: String,
    /// The curve with its 95 % band.
    pub band: CurveBand,
    /// Lower and upper limits of R at the points of the curve `(2)(g,)` [1].
    pub limits: [Vec<f64>; 2],
    /// Logarithms of the evidence of the study and of the Weibull distribution.
    pub ln_evidence: [f64; 2],
    /// Probability of data that agree no better with the best estimate [1].
    pub p: f64,
    /// Failures that it expects until the units' lives.
    pub expected: f64,
    /// Largest p of any curve of the band [1].
    pub largest_p: f64,
}

impl WeibullReport {
    /// Number of failures, known exactly or within an interval.
    pub fn failures(&self) -> usize {
        self.lives.iter().filter(|unit| unit.has_failed()).count()
    }

    /// The fit to these lives.
    ///
    /// # Errors
    /// [`NoMaximum`].
    pub fn new(lives: Vec<UnitLife>, confidence: f64, level: f64) -> Result<Self, NoMaximum> {
        let fit = WeibullFit::new(&lives)?;
        let exact = |unit: &UnitLife| if let UnitLife::Failed(life) = unit { Some(*life) } else { None };
        let failed: Vec<f64> = lives.iter().filter_map(exact).collect();
        let has_interval = lives.iter().any(|unit| matches!(unit, UnitLife::Interval(..)));
        let goodness = (failed.len() >= FEWEST && !has_interval).then(|| {
            if failed.len() == lives.len() {
                anderson_darling(Family::Weibull, &failed)
            } else {
                censored_anderson_darling(&fit.law, &lives)
            }
        });
        Ok(Self { fit, lives, confidence, level, goodness, study: None })
    }

    /// Adds the comparison with a curve of a study, which reaches beyond all lives.
    ///
    /// # Errors
    /// [`RefusedQuestion`] if there is no such curve.
    pub fn compare(&mut self, summary: &StudySummary, curve: &str) -> Result<(), RefusedQuestion> {
        let row = curve_of(summary, curve)?;
        let points = summary.unconditional_points();
        let limits = row.limits();
        let mut rng = open_stream(summary.seed, Stream::Curve);
        let band = CurveBand::new(&row.cycles, &row.reliability, limits, points, &mut rng);
        let (p, expected) = test_of_curve(&band.best, points, &self.lives);
        let of_curve = |curve| test_of_curve(curve, points, &self.lives).0;
        let largest_p = band.curves().map(of_curve).fold(0.0, f64::max);
        let ln_weibull = self.fit.ln_likelihood - (self.failures() as f64).ln();
        self.study = Some(StudyEvidence {
            scene: summary.scene.clone(),
            curve: row.limit_state.clone(),
            ln_evidence: [evidence_of_curve(&band, points, &self.lives), ln_weibull],
            p,
            expected,
            largest_p,
            limits: limits.map(<[f64]>::to_vec),
            band,
        });
        Ok(())
    }
}
