//! The answer of `coordinator weibull` with its tables and its figure.

use super::{StudyEvidence, WeibullReport};
use crate::presentation::report::format::{significant, three_digits};
use crate::presentation::report::{Answer, AnswerPart, Axis, Figure, Ink, Plot, Series, Shape, Table};
use crate::statistics::goodness_of_fit::GoodnessOfFit;
use crate::statistics::life_data::{FitBounds, UnitLife, kaplan_meier};
use serde_json::{Value, json};

/// Points of a drawn curve.
const POINTS: usize = 120;
/// p below which data contradict a study [1].
const CONTRADICTS: f64 = 0.05;

/// The answer with its tables and figure.
pub fn answer(report: &WeibullReport) -> Answer {
    let WeibullReport { lives, confidence, goodness, .. } = report;
    let failures = report.failures();
    let percent = significant(100.0 * confidence, 3);
    let head = ["", "value", "Fisher", "likelihood ratio"];
    let rows = quantities(report).into_iter().map(|(name, bounds)| {
        let [low, high] = bounds.likelihood_ratio.map(|bound| bound.map_or("none".to_owned(), digits));
        let [from, to] = bounds.fisher.map(digits);
        vec![name, digits(bounds.value), format!("{from} to {to}"), format!("{low} to {high}")]
    });
    let has_interval = lives.iter().any(|unit| matches!(unit, UnitLife::Interval(..)));
    let why = if has_interval { "is for lives without intervals" } else { "needs five failures at least" };
    let goodness = goodness.map(|GoodnessOfFit { statistic, p, .. }| {
        let p = three_digits(p);
        format!(
            "A^2 = {statistic:.3}, p = {p}; below 0.05 the lives are not those of a Weibull distribution."
        )
    });
    let goodness = goodness.unwrap_or_else(|| format!("not stated, it {why}."));
    let mut notes = vec![format!("Anderson-Darling: {goodness}")];
    if failures < 20 {
        notes.push("With fewer than 20 failures the likelihood-ratio bounds are the better ones.".to_owned());
    }
    let mut parts = vec![
        AnswerPart::Table(Table::new(format!("{percent} % bounds, lives in cycles"), head, rows)),
        AnswerPart::Notes("Fit", notes),
    ];
    parts.extend(report.study.as_ref().map(|study| AnswerPart::Notes("Study", against_study(study, report))));
    parts.push(AnswerPart::Figures);
    Answer {
        name: "weibull".to_owned(),
        title: format!(
            "Weibull distribution of {} units, {failures} failures: shape {}, scale {} cycles",
            lives.len(),
            three_digits(report.fit.law.shape),
            digits(report.fit.law.scale)
        ),
        subtitle: "Maximum likelihood with suspensions and intervals".to_owned(),
        parts,
        figures: vec![figure(report)],
        ..Answer::default()
    }
}

fn digits(value: f64) -> String {
    significant(value, 4)
}

/// Shape, scale, B10 and the life at the level asked for.
fn quantities(report: &WeibullReport) -> Vec<(String, FitBounds)> {
    let WeibullReport { fit, confidence, level, .. } = report;
    vec![
        ("shape".to_owned(), fit.shape(*confidence)),
        ("scale".to_owned(), fit.life((-1.0_f64).exp(), *confidence)),
        ("B10".to_owned(), fit.life(0.9, *confidence)),
        (format!("life at R = {level}"), fit.life(*level, *confidence)),
    ]
}

/// The study against the data, in sentences.
fn against_study(study: &StudyEvidence, report: &WeibullReport) -> Vec<String> {
    let StudyEvidence { scene, curve, ln_evidence: [physics, weibull], largest_p, .. } = study;
    let observed = report.failures();
    let [first, second] = if physics >= weibull { ["study", "Weibull"] } else { ["Weibull", "study"] };
    let [p, most] = [study.p, *largest_p].map(three_digits);
    let verdict = if *largest_p < CONTRADICTS {
        format!("The data contradict the study: every curve of its 95 % band is rejected, p = {most} at most")
    } else if study.p < CONTRADICTS {
        format!(
            "The data contradict the best estimate of the study, p = {p}, but not every curve of its 95 % band, p = {most} at most"
        )
    } else {
        format!("The data do not contradict the study, p = {p}")
    };
    let expected = significant(study.expected, 3);
    let factor = three_digits((physics - weibull).abs().min(600.0).exp());
    vec![
        format!(
            "{verdict}. Failures: {observed}; by R of {curve} of {scene} until the lives of these units expected: {expected}."
        ),
        format!(
            "Evidence, logarithm of the likelihood: study {physics:.2}, Weibull {weibull:.2} (its parameters are fitted to these data and cost \
             ln {observed}); in favour of {first} against {second} by a factor of {factor}."
        ),
    ]
}

/// R over life: the distribution with its Fisher band, the data by the estimate of Kaplan and Meier, the study with its band.
fn figure(report: &WeibullReport) -> Figure {
    let WeibullReport { fit, confidence, lives, .. } = report;
    let end = lives.iter().map(UnitLife::last).fold(fit.law.life_at(0.05), f64::max);
    let times = || (1..=POINTS).map(|k| end * k as f64 / POINTS as f64);
    let band = times().map(|t| {
        let [lower, upper] = fit.reliability(t, *confidence);
        (t, lower, upper)
    });
    let best = times().map(|t| (t, fit.law.reliability(t)));
    let mut series = vec![
        Series::unlisted("Weibull, band", Ink::Series(0), Shape::Band(band.collect())),
        Series::new("Weibull", Ink::Series(0), Shape::Line(best.collect())),
    ];
    if let Some(study) = &report.study {
        let [lower, upper] = &study.limits;
        let cycles = &study.band.best.times;
        let band = cycles.iter().zip(lower.iter().zip(upper)).map(|(t, (lower, upper))| (*t, *lower, *upper));
        let best = cycles.iter().zip(&study.band.best.reliability).map(|(t, r)| (*t, *r));
        series.push(Series::unlisted("study, band", Ink::Series(1), Shape::Band(band.collect())));
        series.push(Series::new("study", Ink::Series(1), Shape::Dashed(best.collect())));
    }
    series.push(Series::new("data", Ink::Ink, Shape::Cloud(kaplan_meier(lives))));
    let caption = "Weibull distribution with Fisher bounds; data: estimate of Kaplan and Meier after each failure, one within an interval \
                   at its end.";
    let x = Axis::linear("life [cycles]", (0.0, end));
    Plot::of_reliability("weibull", x, &series).figure("Reliability by the data", caption)
}

/// The answer as JSON.
pub fn json(report: &WeibullReport) -> Value {
    let rows = quantities(report).into_iter().map(|(name, bounds)| {
        json!({ "quantity": name, "value": bounds.value, "fisher": bounds.fisher, "likelihood_ratio": bounds.likelihood_ratio })
    });
    let study = report.study.as_ref().map(|study| {
        json!({
            "scene": study.scene, "curve": study.curve, "ln_evidence_study": study.ln_evidence[0],
            "ln_evidence_weibull": study.ln_evidence[1], "p": study.p, "largest_p": study.largest_p,
            "expected_failures": study.expected, "contradicted": study.largest_p < CONTRADICTS,
        })
    });
    json!({
        "units": report.lives.len(),
        "failures": report.failures(),
        "confidence": report.confidence,
        "ln_likelihood": report.fit.ln_likelihood,
        "quantities": rows.collect::<Vec<_>>(),
        "anderson_darling": report.goodness.map(|found| json!({ "statistic": found.statistic, "p": found.p })),
        "study": study,
    })
}
