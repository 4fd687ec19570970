//! The measured variables of a scene: how many values they have, which distribution was taken from them and whether it fits.

use common::random::Family;
use common::scene::{MeasuredVariable, SceneSource, Warning};
use coordinator::presentation::report::format::{before_unit, three_digits, unit_scale};
use coordinator::statistics::goodness_of_fit::{GoodnessOfFit, REPLICATIONS, anderson_darling};
use serde::Serialize;

/// Below this p the values are unlikely for the family.
const UNLIKELY: f64 = 0.05;

/// A measured variable in text and in JSON.
#[derive(Debug, Serialize)]
pub struct MeasuredFinding {
    variable: String,
    values: usize,
    /// The family that was fitted; none for an empirical distribution.
    family: Option<&'static str>,
    /// Every family that can be fitted, with its test.
    families: Vec<FamilyTest>,
    #[serde(skip)]
    range: String,
}

/// The test of one family.
#[derive(Debug, Serialize)]
struct FamilyTest {
    family: &'static str,
    /// Statistic of Anderson and Darling.
    a2: f64,
    /// Share of samples of the family that fit no better.
    p: f64,
}

/// The measured variables of a scene with the tests of their families.
pub fn measured_findings(source: &SceneSource) -> Vec<MeasuredFinding> {
    let unit = |name: &str| source.variable(name).map_or("1", |k| source.variables()[k].unit.as_str());
    source.measured.iter().map(|measured| finding(measured, unit(&measured.name))).collect()
}

fn finding(measured: &MeasuredVariable, unit: &str) -> MeasuredFinding {
    let MeasuredVariable { name, samples, family, .. } = measured;
    let fitting = Family::WORDS.into_iter().filter(|(_, family)| family.fit(samples).is_ok());
    let families = fitting.map(|(word, family)| {
        let GoodnessOfFit { statistic, p } = anderson_darling(family, samples);
        FamilyTest { family: word, a2: statistic, p }
    });
    let scale = unit_scale(unit);
    let shown = |value: f64| three_digits(value / scale).replace('\u{2212}', "-");
    let least = samples.iter().copied().fold(f64::INFINITY, f64::min);
    let most = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    MeasuredFinding {
        variable: name.clone(),
        values: samples.len(),
        family: family.map(Family::word),
        families: families.collect(),
        range: before_unit(&format!("{} to {}", shown(least), shown(most)), unit).replace('\u{a0}', " "),
    }
}

impl MeasuredFinding {
    /// The lines about the variable.
    pub fn lines(&self) -> String {
        let Self { variable, values, range, .. } = self;
        let tests = |but: &str| {
            let others = self.families.iter().filter(|test| test.family != but);
            others.map(|test| format!("{} p = {:.3}", test.family, test.p)).collect::<Vec<_>>().join(", ")
        };
        match self.family {
            None => format!(
                "{variable}: empirical distribution of {values} measured values from {range}; no value beyond them occurs, so failures rarer \
                 than about 1 in {values} need a fit\n  fit = ... (Anderson-Darling): {}\n",
                tests("")
            ),
            Some(family) => {
                let own = self.families.iter().find(|test| test.family == family);
                let own = own
                    .map(|FamilyTest { a2, p, .. }| format!("A^2 = {a2:.3}, p = {p:.3}"))
                    .unwrap_or_default();
                format!(
                    "{variable}: {family} fitted to {values} measured values from {range}; Anderson-Darling {own} (parameters estimated: \
                     {REPLICATIONS} samples, fitted anew each)\n  others: {}\n",
                    tests(family)
                )
            }
        }
    }

    /// The warning if the values are unlikely for the fitted family.
    pub fn warning(&self) -> Option<Warning> {
        let family = self.family?;
        let own = self.families.iter().find(|test| test.family == family && test.p < UNLIKELY)?;
        let best = self.families.iter().max_by(|a, b| a.p.total_cmp(&b.p))?;
        let advice = if best.p < UNLIKELY {
            "no family fits: leave fit out for the empirical distribution, or look for two populations in one file".to_owned()
        } else {
            format!("fit = \"{}\" has p = {:.3}", best.family, best.p)
        };
        let message =
            format!("the measured values are unlikely for this family (p = {:.3}); {advice}", own.p);
        Some(Warning { key: format!("variables.{}.fit", self.variable), message })
    }
}
