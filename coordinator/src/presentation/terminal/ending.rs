//! The summary printed at the end of a study.

use crate::presentation::report::failure_probability;
use crate::presentation::report::format::{count, duration, fixed, whole};
use crate::presentation::report::life::{LEVELS, LifeAt, life_at, numerical_lives, rows_that_matter};
use crate::results::summary::{PerLimitState, StudySummary};
use std::path::Path;

/// The summary printed at the end of a study: R around its fall, lives, stopping reason, effort, files.
pub fn final_text(summary: &StudySummary, dir: &Path) -> String {
    let mut names: Vec<&str> = summary.limit_states.iter().map(String::as_str).collect();
    names.push("total");
    let mut text = match summary.reliability.as_slice() {
        [only] => {
            names.iter().map(|name| format!("P_f {name} = {}\n", failure_probability(only, name))).collect()
        }
        _ => over_life(summary, &names),
    };
    if !summary.convergence.stopped_because.is_empty() {
        text += &format!("stopped because {}\n", summary.convergence.stopped_because);
    }
    text += &noise(summary);
    let counts = summary.evaluations;
    let time = summary.timing_s;
    let [first, then] =
        if summary.is_direct() { ["nominal", "samples"] } else { ["initial", "added by learning"] };
    text += &format!(
        "evaluations: {} ({} {first}, {} {then}, {} failed)\n",
        counts.total, counts.initial, counts.added, counts.failed
    );
    text += &format!(
        "time: {} ({} of simulation on {} workers, {} of surrogates)\n",
        duration(time.total),
        duration(time.simulation),
        summary.workers.len(),
        duration(time.surrogate)
    );
    text += &format!("report: {}\n", dir.join("report.html").display());
    text += &format!(
        "files: summary.json, reliability.csv, samples.csv, campaign.db, figures/ in {}\n",
        dir.display()
    );
    text.replace('\u{a0}', " ")
}

/// A line per surrogate whose training data are noisy.
fn noise(summary: &StudySummary) -> String {
    let noisy = summary.surrogates.iter().filter_map(|s| Some((&s.limit_state, s.much_noise()?)));
    let line = |(name, share): (&String, f64)| {
        format!(
            "noise: {:.1} % of the variance of {name} is numerical noise; a finer --accuracy may need fewer simulations\n",
            100.0 * share
        )
    };
    noisy.map(line).collect()
}

/// Table of R around its fall with a row of names on top, and the lives.
fn over_life(summary: &StudySummary, names: &[&str]) -> String {
    let width = |name: &str| name.chars().count().max(16) + 2;
    let mut text = format!("{:>10}", "cycles");
    for name in names {
        text += &format!("{:>1$}", format!("R {name}"), width(name));
    }
    text.push('\n');
    for row in rows_that_matter(summary, 0) {
        text += &format!("{:>10}", count(row.cycles.into()));
        for name in names {
            let value = |values: &PerLimitState, digits| {
                fixed(values.get(*name).copied().unwrap_or(f64::NAN), digits)
            };
            let cell = format!("{} ± {}", value(&row.reliability, 4), value(&row.standard_error, 4));
            text += &format!("{cell:>0$}", width(name));
        }
        text.push('\n');
    }
    text.push('\n');
    for level in LEVELS {
        let life = match life_at(summary, "total", level) {
            LifeAt::Beyond(last) => format!("beyond {} cycles", count(last.into())),
            LifeAt::Cycles { life, lower, upper } => {
                let [life, lower, upper] = [life, lower, upper].map(whole);
                format!("{life} cycles (95 % interval {lower} to {upper})")
            }
        };
        text += &format!("life at R = {level}: {life}\n");
    }
    if let Some([worst, best]) = numerical_lives(summary, "total", 0.5) {
        let last = summary.reliability.last().map_or(0, |row| row.cycles);
        let life =
            |life: Option<f64>| life.map_or_else(|| format!("more than {}", count(last.into())), whole);
        text += &format!(
            "numerical: if every response were off by its stated error in the same direction, life at R = 0.5 would be {} or {} \
             cycles\n",
            life(worst),
            life(best)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_study;

    #[test]
    fn the_final_text_has_table_lives_reason_effort_and_files() {
        let text = final_text(&test_study::study().summary, Path::new("out/study"));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0].split_whitespace().collect::<Vec<_>>(),
            ["cycles", "R", "wear", "R", "asymmetry", "R", "total"]
        );
        let row = lines.iter().find(|line| line.trim_start().starts_with("66 000")).unwrap();
        assert!(row.contains("0.4772 ± "), "{row}");
        assert_eq!(row.chars().count(), lines[0].chars().count());
        for part in [
            "life at R = 0.5: 65 4",
            "stopped because the estimated error",
            "noise: 3.0 % of the variance of wear is numerical noise",
            "evaluations: 216 (120 initial, 96 added by learning, 1 failed)",
            "time: 3 min 41 s (5 min 22 s of simulation on 2 workers, 48.2 s of surrogates)",
            "report: out/study/report.html",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert!(lines.len() < 30);
    }

    #[test]
    fn issue_nothing_is_added_by_learning_in_a_direct_simulation() {
        let mut summary = test_study::study().summary;
        summary.method = "monte-carlo".to_owned();
        let text = final_text(&summary, Path::new("out"));
        assert!(text.contains("(120 nominal, 96 samples, 1 failed)"), "{text}");
    }
}
