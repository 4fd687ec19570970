//! Reads the distribution of a random variable: its word, and the keys that each distribution takes.
//!
//! Reads a tolerance fit of a random variable: `fit = "H7/e8"` at a nominal `diameter` gives the mean and standard
//! deviation of a radial clearance, a single class such as `"H7"` those of the radius of a hole or a shaft.

use super::context::Range;
use super::faults::{FaultKind, in_first_unit};
use super::quantity::{Kind, LENGTH, NUMBER, Quantity};
use super::section::Section;
use crate::random::{
    Distribution, Extreme, Feature, LawError, ToleranceClass, ToleranceError, clearance_of_fit,
};
use std::collections::BTreeMap;
use toml::Value;

/// Default of the bounds of a truncated normal, in standard deviations from the mean.
const TRUNCATION: f64 = 3.0;

/// Every distribution by its word, with the keys that it takes besides `distribution`; the first one is that of a variable without a word.
pub const LAWS: [(&str, &[&str]); 11] = [
    ("truncated-normal", &["mean", "std", "truncation", "lower", "upper"]),
    ("normal", &["mean", "std"]),
    ("lognormal", &["mean", "std"]),
    ("uniform", &["mean", "std", "lower", "upper"]),
    ("gumbel", &["mean", "std"]),
    ("gumbel-minima", &["mean", "std"]),
    ("weibull", &["mean", "std"]),
    ("exponential", &["mean", "std", "lower"]),
    ("beta", &["mean", "std", "lower", "upper"]),
    ("triangular", &["lower", "mode", "upper"]),
    ("constant", &["mean"]),
];

/// Word of the distribution of a variable that names none.
pub const DEFAULT_LAW: &str = LAWS[0].0;

/// The distribution of a variable as written, its numbers not yet read.
pub(super) struct WrittenLaw {
    law: &'static str,
    truncation: f64,
    values: BTreeMap<&'static str, Value>,
    fit: Option<WrittenFit>,
}

impl WrittenLaw {
    /// Reads the keys of a distribution; missing and contradictory ones are faults.
    pub(super) fn read(row: &mut Section) -> Option<Self> {
        let (law, keys) = row.word_or("distribution", &LAWS.map(|law| (law.0, law)), LAWS[0])?;
        let values: BTreeMap<&str, Value> =
            keys.iter().filter_map(|key| Some((*key, row.get(key)?.clone()))).collect();
        let truncation = match law {
            "truncated-normal" => row.quantity_or("truncation", NUMBER, Range::Within(0.1, 10.0), TRUNCATION),
            _ => Some(TRUNCATION),
        };
        // A fit gives mean and standard deviation.
        let fit = (keys.contains(&"std") && row.get("fit").is_some()).then(|| WrittenFit::read(row));
        let written = Self { law, truncation: truncation.unwrap_or(TRUNCATION), values, fit: None };
        let complete = written.complete(row, fit.is_some());
        let fit = fit.map_or(Some(None), |fit| fit.map(Some))?;
        (complete && truncation.is_some()).then_some(Self { fit, ..written })
    }

    fn has(&self, key: &str) -> bool {
        self.values.contains_key(key)
    }

    /// True if no required key is missing and no key contradicts another.
    fn complete(&self, row: &Section, fit: bool) -> bool {
        let before = row.cx.fault_count();
        let bounded = self.has("lower") || self.has("upper");
        let moments = self.has("mean") || self.has("std");
        let contradictions = [
            (fit && moments, "give either fit, or mean and std, not both"),
            (
                self.law == "uniform" && bounded && (fit || moments),
                "give either lower and upper, or std with the mean, not both",
            ),
            (
                self.law == "exponential" && bounded && (fit || self.has("std")),
                "give either lower, where the distribution begins, or std, which begins at mean - std",
            ),
        ];
        for (_, message) in contradictions.into_iter().filter(|(is_given, _)| *is_given) {
            row.inconsistent_table(message);
        }
        const STD: &str = "a quantity, or a share of the mean such as \"0.2 %\"";
        const BOUND: &str = "a bound of the distribution";
        let needed: &[(&str, &str)] = match self.law {
            "constant" => &[],
            "triangular" => &[("lower", BOUND), ("mode", "the likeliest value"), ("upper", BOUND)],
            "uniform" if bounded => &[("lower", BOUND), ("upper", BOUND)],
            "exponential" if bounded => &[],
            "beta" => &[("std", STD), ("lower", BOUND), ("upper", BOUND)],
            _ => &[("std", STD)],
        };
        let given = |key: &str| self.has(key) || (fit && key == "std");
        for (key, expected) in needed.iter().filter(|(key, _)| !given(key)) {
            row.missing(key, *expected);
        }
        row.cx.fault_count() == before
    }

    /// The first key that locates the variable, with its value as written: it has the dimension of the variable.
    pub(super) fn located(&self) -> Option<(&'static str, &Value)> {
        ["mean", "mode", "lower", "upper"].into_iter().find_map(|key| Some((key, self.values.get(key)?)))
    }

    /// True if the mean is the value that the scene has without the variable.
    pub(super) fn takes_nominal(&self) -> bool {
        let by_bounds = self.law == "triangular" || (self.law == "uniform" && self.has("lower"));
        !(self.has("mean") || self.fit.is_some() || by_bounds)
    }

    /// The distribution, given the `nominal` value of the keys that the variable changes.
    pub(super) fn distribution(
        &self,
        row: &Section,
        nominal: Quantity,
        changes: &[String],
    ) -> Option<Distribution> {
        let kind = nominal.kind();
        let value = |key: &str, default: f64| match self.values.get(key) {
            Some(written) => row.as_quantity(key, written, kind, Range::Any),
            None => Some(default),
        };
        let (mean, std) = match &self.fit {
            Some(fit) => fit.moments(row, kind, changes)?,
            None => {
                let mean = value("mean", nominal.value)?;
                (mean, self.std(row, mean, kind)?)
            }
        };
        let reach = self.truncation * std;
        let lower = value("lower", mean - reach);
        let upper = value("upper", mean + reach);
        let (lower, upper) = (lower?, upper?);
        let made = match self.law {
            "truncated-normal" => Distribution::truncated_normal(mean, std, lower, upper),
            "normal" => Distribution::normal(mean, std),
            "lognormal" => Distribution::lognormal(mean, std),
            "uniform" if self.has("lower") => Distribution::uniform(lower, upper),
            "uniform" => Distribution::uniform_by_moments(mean, std),
            "gumbel" => Distribution::gumbel(mean, std, Extreme::Maxima),
            "gumbel-minima" => Distribution::gumbel(mean, std, Extreme::Minima),
            "weibull" => Distribution::weibull(mean, std),
            "exponential" if self.has("lower") => Distribution::exponential_from(lower, mean),
            "exponential" => Distribution::exponential(mean, std),
            "beta" => Distribution::beta(mean, std, lower, upper),
            "triangular" => Distribution::triangular(lower, value("mode", mean)?, upper),
            _ => Distribution::constant(mean),
        };
        made.map_err(|error| self.refuse(row, error, kind)).ok()
    }

    /// The standard deviation, a quantity or a share of the mean; 0 for a distribution without this key.
    fn std(&self, row: &Section, mean: f64, kind: Kind) -> Option<f64> {
        let Some(written) = self.values.get("std") else { return Some(0.0) };
        let std = row.cx.quantity_or_share(&row.key("std"), written, kind, mean.abs())?;
        if std > 0.0 && std.is_finite() {
            return Some(std);
        }
        row.out_of_range("std", written.to_string(), "> 0; distribution = \"constant\" holds it fixed")
            .and(None)
    }

    /// Records a parameter that the distribution does not allow, in the units of the scene.
    fn refuse(&self, row: &Section, error: LawError, kind: Kind) -> Option<()> {
        let shown = |value| in_first_unit(value, kind);
        match error {
            LawError::OutOfRange { parameter, value, above, below } => {
                let allowed = match (above.is_finite(), below.is_finite()) {
                    (true, true) => format!("> {} and < {}", shown(above), shown(below)),
                    (true, false) => format!("> {}", shown(above)),
                    (false, true) => format!("< {}", shown(below)),
                    (false, false) => "any finite number".to_owned(),
                };
                let written = self.values.get(parameter).map(Value::to_string);
                row.out_of_range(parameter, written.unwrap_or_else(|| shown(value)), allowed)
            }
            LawError::NotEnclosed { parameter, value, lower, upper } => {
                let [lower, upper, value] = [lower, upper, value].map(shown);
                let message = format!(
                    "the bounds {lower} and {upper} do not enclose the {parameter} {value}: move them, or the {parameter}"
                );
                match [parameter, "lower", "upper"].into_iter().find(|key| self.has(key)) {
                    Some(key) => row.inconsistent(key, message),
                    None => row.inconsistent_table(message),
                }
            }
        }
    }
}

/// Default of the process capability C_p: the tolerance zone is 6 standard deviations wide [1].
const CAPABILITY: f64 = 1.0;

/// A fit as written.
struct WrittenFit {
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
    fn read(row: &mut Section) -> Option<Self> {
        let written = row.text("fit", "a fit, e.g. \"H7/e8\"");
        let diameter = row.quantity("diameter", LENGTH, Range::Positive);
        let capability = row.quantity_or("capability", NUMBER, Range::Within(0.1, 10.0), CAPABILITY);
        let (written, diameter, capability) = (written?, diameter?, capability?);
        let moments = if written.contains('/') {
            clearance_of_fit(written, diameter, capability).map(|(mean, std)| (None, 0.5 * mean, 0.5 * std))
        } else {
            ToleranceClass::parse(written).and_then(|class| {
                let (mean, std) = class.moments(diameter, capability)?;
                Ok((Some(class.feature), 0.5 * (diameter + mean), 0.5 * std))
            })
        };
        match moments {
            Ok((feature, mean, std)) => Some(Self { written: written.to_owned(), feature, mean, std }),
            Err(error @ ToleranceError::Diameter(_)) => {
                row.inconsistent("diameter", error.to_string()).and(None)
            }
            Err(error) => row.inconsistent("fit", error.to_string()).and(None),
        }
    }

    /// Mean and standard deviation [m] for a variable that changes these keys, which must be lengths that the fit gives.
    fn moments(&self, row: &Section, kind: Kind, changes: &[String]) -> Option<(f64, f64)> {
        let value = format!("\"{}\"", self.written);
        if kind.dimension != LENGTH.dimension {
            return row.fault("fit", FaultKind::wrong_unit(value, LENGTH.dimension, kind)).and(None);
        }
        for changed in changes {
            let field = changed.rsplit('.').next().unwrap_or(changed);
            const ONE_PART: &str = "is the class of one part; a clearance needs both, e.g. \"H7/e8\"";
            const BOTH: &str =
                "gives a clearance; a radius needs the class of its part alone, e.g. \"H7\" or \"e8\"";
            const SHAFT: &str = "is the class of a shaft, a bushing is a hole, e.g. \"H7\"";
            const HOLE: &str = "is the class of a hole, a journal is a shaft, e.g. \"e8\"";
            let refused = match (field, self.feature) {
                ("radial_clearance", Some(_)) => ONE_PART,
                ("bushing_radius" | "journal_radius", None) => BOTH,
                ("bushing_radius", Some(Feature::Shaft)) => SHAFT,
                ("journal_radius", Some(Feature::Hole)) => HOLE,
                _ => continue,
            };
            let message = format!("{value} {refused}; the variable changes \"{changed}\"");
            return row.inconsistent("fit", message).and(None);
        }
        Some((self.mean, self.std))
    }
}
