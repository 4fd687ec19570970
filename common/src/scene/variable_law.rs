//! Reads the law of a random variable: which distribution, and the keys that each of them takes.

use super::faults::{FaultKind, in_first_unit};
use super::fits::WrittenFit;
use super::quantity::{Dimension, Kind, NUMBER, Quantity};
use super::read::{Context, Range};
use super::section::Section;
use crate::random::{Distribution, Extreme, LawError};
use std::collections::BTreeMap;
use toml::Value;

/// Where a truncated normal is cut unless the scene says otherwise, in standard deviations.
const TRUNCATION: f64 = 3.0;

/// The words of `distribution`.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    TruncatedNormal,
    Normal,
    Lognormal,
    Uniform,
    Gumbel(Extreme),
    Weibull,
    Exponential,
    Beta,
    Triangular,
    Constant,
}

const LAWS: [(&str, Law); 11] = [
    ("truncated-normal", Law::TruncatedNormal),
    ("normal", Law::Normal),
    ("lognormal", Law::Lognormal),
    ("uniform", Law::Uniform),
    ("gumbel", Law::Gumbel(Extreme::Maxima)),
    ("gumbel-minima", Law::Gumbel(Extreme::Minima)),
    ("weibull", Law::Weibull),
    ("exponential", Law::Exponential),
    ("beta", Law::Beta),
    ("triangular", Law::Triangular),
    ("constant", Law::Constant),
];

impl Law {
    /// The keys it may have beside `distribution`.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Law::TruncatedNormal => &["mean", "std", "truncation", "lower", "upper"],
            Law::Normal | Law::Lognormal | Law::Gumbel(_) | Law::Weibull => &["mean", "std"],
            Law::Uniform | Law::Beta => &["mean", "std", "lower", "upper"],
            Law::Exponential => &["mean", "std", "lower"],
            Law::Triangular => &["lower", "mode", "upper"],
            Law::Constant => &["mean"],
        }
    }

    /// Whether a fit may give its mean and standard deviation.
    fn takes_a_fit(self) -> bool {
        !matches!(self, Law::Triangular | Law::Constant)
    }
}

/// The law of a variable as written, its numbers not yet read.
pub(super) struct WrittenLaw {
    law: Law,
    truncation: f64,
    values: BTreeMap<&'static str, Value>,
    fit: Option<WrittenFit>,
}

impl WrittenLaw {
    /// Reads the keys of a law, and notes those that are missing or too many.
    pub(super) fn read(cx: &mut Context, row: &mut Section) -> Option<Self> {
        let law = row.word_or(cx, "distribution", &LAWS, Law::TruncatedNormal)?;
        let values: BTreeMap<&str, Value> =
            law.keys().iter().filter_map(|key| Some((*key, row.get(key)?.clone()))).collect();
        let truncation = match law {
            Law::TruncatedNormal => {
                row.quantity_or(cx, "truncation", NUMBER, Range::Within(0.1, 10.0), TRUNCATION)
            }
            _ => Some(TRUNCATION),
        };
        let fit = (law.takes_a_fit() && row.get("fit").is_some()).then(|| WrittenFit::read(cx, row));
        let written = Self { law, truncation: truncation.unwrap_or(TRUNCATION), values, fit: None };
        let complete = written.complete(cx, row, fit.is_some());
        let fit = fit.map_or(Some(None), |fit| fit.map(Some))?;
        (complete && truncation.is_some()).then_some(Self { fit, ..written })
    }

    fn has(&self, key: &str) -> bool {
        self.values.contains_key(key)
    }

    /// Whether every key is there that the law needs, and none that contradicts another.
    fn complete(&self, cx: &mut Context, row: &Section, fit: bool) -> bool {
        let before = cx.faults.len();
        let mut refuse = |message: &str| cx.inconsistent(&row.path, message);
        if fit && (self.has("mean") || self.has("std")) {
            refuse("fit gives mean and std: leave these out, or the fit");
        }
        let bounded = self.has("lower") || self.has("upper");
        match self.law {
            Law::Uniform if bounded && (fit || self.has("std") || self.has("mean")) => {
                refuse("give either lower and upper, or std with the mean, not both");
            }
            Law::Exponential if bounded && (fit || self.has("std")) => {
                refuse(
                    "give either lower, where the distribution begins, or std, which begins at mean - std",
                );
            }
            _ => {}
        }
        const STD: &str = "a quantity, or a share of the mean such as \"0.2 %\"";
        const BOUND: &str = "a bound of the distribution";
        let needed: &[(&str, &str)] = match self.law {
            Law::Constant => &[],
            Law::Triangular => &[("lower", BOUND), ("mode", "the likeliest value"), ("upper", BOUND)],
            Law::Uniform if bounded => &[("lower", BOUND), ("upper", BOUND)],
            Law::Exponential if bounded => &[],
            Law::Beta => &[("std", STD), ("lower", BOUND), ("upper", BOUND)],
            _ => &[("std", STD)],
        };
        let given = |key: &str| self.has(key) || (fit && key == "std");
        for (key, expected) in needed.iter().filter(|(key, _)| !given(key)) {
            cx.fault(row.key(key), FaultKind::Missing { expected: (*expected).to_owned() });
        }
        cx.faults.len() == before
    }

    /// What is written of where the variable lies, with its key: it has the variable's dimension.
    pub(super) fn located(&self) -> Option<(&'static str, &Value)> {
        ["mean", "mode", "lower", "upper"].into_iter().find_map(|key| Some((key, self.values.get(key)?)))
    }

    /// Whether the value that the scene has without the variable is its mean.
    pub(super) fn takes_nominal(&self) -> bool {
        let by_bounds = self.law == Law::Triangular || (self.law == Law::Uniform && self.has("lower"));
        !(self.has("mean") || self.fit.is_some() || by_bounds)
    }

    /// The distribution, where the changed keys have the `nominal` value without it; `path` is that of the variable.
    pub(super) fn distribution(
        &self,
        cx: &mut Context,
        path: &str,
        nominal: Quantity,
        changes: &[String],
    ) -> Option<Distribution> {
        let dimension = nominal.dimension;
        let value = |cx: &mut Context, key: &str, default: f64| match self.values.get(key) {
            Some(written) => cx.quantity(&format!("{path}.{key}"), written, Kind::of(dimension), Range::Any),
            None => Some(default),
        };
        let (mean, std) = match &self.fit {
            Some(fit) => fit.moments(cx, path, dimension, changes)?,
            None => {
                let mean = value(cx, "mean", nominal.value)?;
                (mean, self.std(cx, path, mean, dimension)?)
            }
        };
        let reach = self.truncation * std;
        let lower = value(cx, "lower", mean - reach);
        let upper = value(cx, "upper", mean + reach);
        let (lower, upper) = (lower?, upper?);
        let made = match self.law {
            Law::TruncatedNormal => Distribution::truncated_normal(mean, std, lower, upper),
            Law::Normal => Distribution::normal(mean, std),
            Law::Lognormal => Distribution::lognormal(mean, std),
            Law::Uniform if self.has("lower") => Distribution::uniform(lower, upper),
            Law::Uniform => Distribution::uniform_by_moments(mean, std),
            Law::Gumbel(extreme) => Distribution::gumbel(mean, std, extreme),
            Law::Weibull => Distribution::weibull(mean, std),
            Law::Exponential if self.has("lower") => Distribution::exponential_from(lower, mean),
            Law::Exponential => Distribution::exponential(mean, std),
            Law::Beta => Distribution::beta(mean, std, lower, upper),
            Law::Triangular => Distribution::triangular(lower, value(cx, "mode", mean)?, upper),
            Law::Constant => Distribution::constant(mean),
        };
        made.map_err(|error| self.refuse(cx, path, error, dimension)).ok()
    }

    /// The standard deviation, a quantity or a share of the mean; 0 where the law takes none.
    fn std(&self, cx: &mut Context, path: &str, mean: f64, dimension: Dimension) -> Option<f64> {
        let Some(written) = self.values.get("std") else { return Some(0.0) };
        let relative = written.as_str().is_some_and(|text| text.trim_end().ends_with('%'));
        let expected = if relative { Dimension::NONE } else { dimension };
        let mut std = cx.quantity(&format!("{path}.std"), written, Kind::of(expected), Range::Any)?;
        if relative {
            std *= mean.abs();
        }
        if std > 0.0 && std.is_finite() {
            return Some(std);
        }
        let (value, allowed) =
            (written.to_string(), "> 0; leave the variable out to hold it fixed".to_owned());
        cx.fault(format!("{path}.std"), FaultKind::OutOfRange { value, allowed });
        None
    }

    /// Says what a law does not allow in the words of the scene.
    fn refuse(&self, cx: &mut Context, path: &str, error: LawError, dimension: Dimension) {
        let shown = |value| in_first_unit(value, Kind::of(dimension));
        match error {
            LawError::OutOfRange { parameter, value, above, below } => {
                let allowed = match (above.is_finite(), below.is_finite()) {
                    (true, true) => format!("> {} and < {}", shown(above), shown(below)),
                    (true, false) => format!("> {}", shown(above)),
                    (false, true) => format!("< {}", shown(below)),
                    (false, false) => "any finite number".to_owned(),
                };
                let written = self.values.get(parameter).map(Value::to_string);
                let value = written.unwrap_or_else(|| shown(value));
                cx.fault(format!("{path}.{parameter}"), FaultKind::OutOfRange { value, allowed });
            }
            LawError::NotEnclosed { parameter, value, lower, upper } => {
                let message = format!(
                    "the bounds {} and {} do not enclose the {parameter} {}",
                    shown(lower),
                    shown(upper),
                    shown(value)
                );
                cx.inconsistent(path, message);
            }
        }
    }
}
