//! Reads a tolerance fit of a random variable: `fit = "H7/e8"` at a nominal `diameter` gives the mean and standard
//! deviation of a radial clearance, a single class such as `"H7"` those of the radius of a hole or a shaft.

use super::context::{Context, Range};
use super::faults::FaultKind;
use super::quantity::{Kind, LENGTH, NUMBER};
use super::section::Section;
use crate::random::{Feature, Fit, ToleranceClass, ToleranceError};

/// Default of the process capability C_p: the tolerance zone is 6 standard deviations wide [1].
const CAPABILITY: f64 = 1.0;

/// A fit as written.
pub(super) struct WrittenFit {
    written: String,
    /// Hole or shaft for a single class; none for a fit, which gives a clearance.
    feature: Option<Feature>,
    /// Mean of the radius or the radial clearance [m].
    mean: f64,
    /// Standard deviation of the radius or the radial clearance [m].
    std: f64,
}

impl WrittenFit {
    /// Reads `fit`, `diameter` and `capability`.
    pub(super) fn read(row: &mut Section) -> Option<Self> {
        let written = row.text("fit", "a fit, e.g. \"H7/e8\"");
        let diameter = row.quantity("diameter", LENGTH, Range::Positive);
        let capability = row.quantity_or("capability", NUMBER, Range::Within(0.1, 10.0), CAPABILITY);
        let (written, diameter, capability) = (written?, diameter?, capability?);
        match moments(written, diameter, capability) {
            Ok((feature, mean, std)) => Some(Self { written: written.to_owned(), feature, mean, std }),
            Err(error) => {
                let key = if matches!(error, ToleranceError::Diameter { .. }) { "diameter" } else { "fit" };
                row.inconsistent(key, error.to_string());
                None
            }
        }
    }

    /// Mean and standard deviation [m] for a variable that changes these keys, which must be lengths that the fit gives.
    pub(super) fn moments(
        &self,
        cx: &Context,
        path: &str,
        kind: Kind,
        changes: &[String],
    ) -> Option<(f64, f64)> {
        let key = format!("{path}.fit");
        let value = format!("\"{}\"", self.written);
        if kind.dimension != LENGTH.dimension {
            cx.fault(key, FaultKind::WrongUnit { value, found: LENGTH.dimension, expected: kind });
            return None;
        }
        for changed in changes {
            let field = changed.rsplit('.').next().unwrap_or(changed);
            let refused = match (field, self.feature) {
                ("radial_clearance", Some(_)) => {
                    "is the class of one part; a clearance needs both, e.g. \"H7/e8\""
                }
                ("bushing_radius" | "journal_radius", None) => {
                    "gives a clearance; a radius needs the class of its part alone, e.g. \"H7\" or \"e8\""
                }
                ("bushing_radius", Some(Feature::Shaft)) => {
                    "is the class of a shaft, a bushing is a hole, e.g. \"H7\""
                }
                ("journal_radius", Some(Feature::Hole)) => {
                    "is the class of a hole, a journal is a shaft, e.g. \"e8\""
                }
                _ => continue,
            };
            cx.inconsistent(key, format!("{value} {refused}; the variable changes \"{changed}\""));
            return None;
        }
        Some((self.mean, self.std))
    }
}

/// Hole or shaft for a single class, and mean and standard deviation of its radius [m]; none and those of the radial
/// clearance [m] for a fit.
fn moments(
    written: &str,
    diameter: f64,
    capability: f64,
) -> Result<(Option<Feature>, f64, f64), ToleranceError> {
    if written.contains('/') {
        let (mean, std) = Fit::parse(written)?.clearance(diameter, capability)?;
        return Ok((None, 0.5 * mean, 0.5 * std));
    }
    let class = ToleranceClass::parse(written)?;
    let (mean, std) = class.moments(diameter, capability)?;
    Ok((Some(class.feature), 0.5 * (diameter + mean), 0.5 * std))
}
