//! The summary printed at the end of a study.

use crate::presentation::format::{duration, in_columns};
use crate::presentation::motion_cautions::control_points_notes;
use crate::presentation::report::levels::parts_and_levels;
use crate::presentation::report::life::{
    LEVELS, life_and_limits, life_at, reliability_table, rows_that_matter, unit_of_life, unresolved_fall,
};
use crate::presentation::report::untested::{no_simulated_failure, steps_and_noise};
use crate::presentation::report::{failure_probability, variants};
use crate::results::summary::StudySummary;
use std::path::Path;

/// The summary printed at the end of a study: R around its fall, lives, stopping reason, effort, files.
pub fn final_text(summary: &StudySummary, dir: &Path) -> String {
    let names = summary.limit_states.iter().map(String::as_str).chain(["total"]);
    let mut text = match summary.reliability.as_slice() {
        [only] => names
            .map(|name| {
                let found = failure_probability(only, name);
                // A bound has its sign.
                let equals = if found.starts_with('<') { "" } else { "= " };
                format!("P_f {name} {equals}{found} (95 %)\n")
            })
            .collect(),
        _ => over_life(summary),
    };
    let cautions = no_simulated_failure(summary).into_iter();
    for note in cautions.chain(control_points_notes(&summary.control_points)) {
        text += &format!("caution: {note}\n");
    }
    if !summary.convergence.stopped_because.is_empty() {
        text += &format!("stopped because {}\n", summary.convergence.stopped_because);
    }
    if let Some(command) = summary.convergence.command_to_go_on(dir) {
        text += &format!("the study ended before its targets were met; go on with `{command}`\n");
    }
    for line in parts_and_levels(summary).into_iter().chain(steps_and_noise(summary)) {
        text += &format!("{line}\n");
    }
    let (counts, time) = (summary.evaluations, summary.timing_s);
    let [first, then] =
        if summary.is_direct() { ["nominal", "samples"] } else { ["initial", "added by learning"] };
    text += &format!(
        "evaluations: {} ({} {first}, {} {then}{}, {} failed)\n",
        counts.total,
        counts.initial,
        counts.added,
        summary.levels.as_ref().map_or(String::new(), |levels| format!(", {} finer", levels.evaluations)),
        counts.failed
    );
    // The most in one run.
    let workers = if time.workers == 0 { summary.workers.len() } else { time.workers as usize };
    text += &format!(
        "time: {}{} ({} of simulation on {workers} worker{}, {} of surrogates)\n",
        duration(time.total),
        if time.runs > 1 { format!(" in {} runs", time.runs) } else { String::new() },
        duration(time.simulation),
        if workers == 1 { "" } else { "s" },
        duration(time.surrogate)
    );
    text += &format!(
        "report: {}\nfiles: summary.json, reliability.csv, samples.csv, campaign.db, figures/ in {}\n",
        dir.join("report.html").display(),
        dir.display()
    );
    text.replace('\u{a0}', " ")
}

/// Table of R around its fall with a row of names on top, and the lives.
fn over_life(summary: &StudySummary) -> String {
    let mut text = in_columns(&reliability_table(summary, rows_that_matter(summary, 0)), &[]);
    text.push('\n');
    for level in LEVELS {
        let (life, limits) = life_and_limits(life_at(summary, "total", level));
        let unit = unit_of_life(&life);
        let limits = if limits.is_empty() { "95 % bound" } else { &format!("95 % interval {limits}") };
        text += format!("life at R = {level}: {life} {unit}").trim_end();
        text += &format!(" ({limits})\n");
    }
    if let Some(note) = unresolved_fall(summary) {
        text += &format!("caution: {note}\n");
    }
    variants::sentence(summary).map_or(text.clone(), |range| format!("{text}{range}\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn a_spent_budget_names_the_command_that_goes_on() {
        let mut summary = test_study::study().summary;
        summary.convergence.larger_budget = Some(432);
        summary.workers.truncate(1);
        summary.timing_s.workers = 0;
        let text = final_text(&summary, Path::new("out/study"));
        assert!(text.contains("go on with `coordinator resume out/study --max-evaluations 432`"), "{text}");
        assert!(text.contains(" on 1 worker, "), "{text}");
        let quoted = final_text(&summary, Path::new("out of/the study"));
        assert!(quoted.contains("`coordinator resume 'out of/the study' --max-evaluations 432`"), "{quoted}");
    }

    #[test]
    fn issue_a_bound_was_equal_to_less_than_a_number() {
        let mut summary = test_study::study().summary;
        summary.reliability.truncate(1);
        summary.reliability[0].interval.clear();
        summary.reliability[0].reliability.values_mut().for_each(|r| *r = 1.0);
        summary.reliability[0].standard_error.values_mut().for_each(|error| *error = 1e-5);
        let text = final_text(&summary, Path::new("out"));
        assert!(text.contains("P_f total < 2.0e\u{2212}5 (95 %)"), "{text}");
    }

    #[test]
    fn the_final_text_has_table_lives_reason_effort_and_files() {
        let text = final_text(&test_study::study().summary, Path::new("out/study"));
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[0].split_whitespace().collect::<Vec<_>>(),
            ["cycles", "R", "wear", "(95", "%)", "R", "asymmetry", "(95", "%)", "R", "total", "(95", "%)"]
        );
        let row = lines.iter().find(|line| line.trim_start().starts_with("66 000")).unwrap();
        assert!(row.contains("0.48 ± 0.14"), "{row}");
        assert_eq!(row.chars().count(), lines[0].chars().count());
        for part in [
            "life at R = 0.5: 65 4",
            "cycles (95 % interval 6",
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
    fn issue_the_workers_of_a_resumed_study_were_counted_once_for_each_run() {
        let mut summary = test_study::study().summary;
        let again = summary.workers.clone();
        summary.workers.extend(again);
        summary.timing_s.runs = 2;
        let text = final_text(&summary, Path::new("out"));
        assert!(
            text.contains("time: 3 min 41 s in 2 runs (5 min 22 s of simulation on 2 workers, "),
            "{text}"
        );
    }

    #[test]
    fn issue_nothing_is_added_by_learning_in_a_direct_simulation() {
        let mut summary = test_study::study().summary;
        summary.method = "monte-carlo".to_owned();
        let text = final_text(&summary, Path::new("out"));
        assert!(text.contains("(120 nominal, 96 samples, 1 failed)"), "{text}");
    }
}
