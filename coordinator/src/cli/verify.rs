//! `coordinator verify`: validates the surrogates of a study against simulations that they were not fitted to.

use super::error::CommandError;
use super::output::answer_with;
use super::shared::positive;
use super::stored_study::{StoredStudy, ended_without_result};
use clap::Args;
use coordinator::presentation::report::answer::{Answer, AnswerPart, Table};
use coordinator::statistics::reliability::REACH;
use coordinator::study::{SimulatedPoint, StudyError, Verification, verify as refit, verify_study};
use std::collections::HashSet;
use std::path::PathBuf;

/// Fewest simulations of either study: surrogates need three, and a share of fewer than ten has no meaning.
const LEAST: usize = 10;

/// Arguments of `coordinator verify`.
#[derive(Debug, Clone, Args)]
pub struct VerifyArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Folder of a study whose simulations are compared with the surrogates of the first one
    #[arg(long, value_name = "DIR")]
    pub against: PathBuf,
    /// Fit surrogates to the first N evaluations of the study, instead of those it ended with
    #[arg(long, value_name = "N", value_parser = positive)]
    pub evaluations: Option<usize>,
}

/// Runs the command.
///
/// # Errors
/// [`CommandError`] if a study cannot be read, or the two are of different scenes or too small.
pub fn verify(arguments: &VerifyArguments, as_json: bool) -> Result<(), CommandError> {
    let VerifyArguments { dir, against, .. } = arguments;
    let (study, other) = (StoredStudy::look(dir)?, StoredStudy::look(against)?);
    if let Some(difference) = study.difference(&other) {
        let both = format!("{} and {}", dir.display(), against.display());
        let fault = format!(
            "they differ in their {difference}; expected are studies of the same scene at the same accuracy"
        );
        return Err(CommandError::refused(both, fault));
    }
    let mut learned = study.simulated()?;
    learned.truncate(arguments.evaluations.unwrap_or(usize::MAX));
    let bits = |point: &SimulatedPoint| point.sample.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
    let seen: HashSet<Vec<u64>> = learned.iter().map(bits).collect();
    let mut unseen = other.simulated()?;
    unseen.retain(|point| !seen.contains(&bits(point)));
    for (study, points) in [(&study, learned.len()), (&other, unseen.len())] {
        if points < LEAST {
            return Err(too_few(study, points));
        }
    }
    let failed = |error| CommandError::Study {
        error: StudyError::from_campaign(error, study.scene()),
        dir: dir.clone(),
    };
    let (scene, settings) = (study.scene(), &study.settings);
    let learns = settings.method.learns() && arguments.evaluations.is_none();
    let own = match learns {
        true => verify_study(scene, settings, &study.outcomes()?, &unseen).map_err(failed)?,
        false => None,
    };
    let found = own.map_or_else(|| refit(scene, settings, &learned, &unseen).map_err(failed), Ok)?;
    answer_with(&verification(&found), &found, None, as_json)
}

/// The error of a study with too few simulations, or the reason why it ended before it had more.
fn too_few(study: &StoredStudy, points: usize) -> CommandError {
    ended_without_result(&study.campaign).unwrap_or_else(|| {
        let fault = format!("{points} usable simulations, expected at least {LEAST}");
        CommandError::refused(study.campaign.dir().display(), fault)
    })
}

fn verification(found: &Verification) -> Answer {
    let surrogates = found.surrogates.iter().map(|surrogate| {
        vec![
            surrogate.limit_state.clone(),
            surrogate.form.clone(),
            format!("{:.4}", surrogate.q2),
            format!("{:.4}", surrogate.q2_leave_one_out),
            format!("{:.2}", surrogate.variance_ratio.sqrt()),
        ]
    });
    let head =
        "limit state | surrogate | Q2 | leave-one-out Q2 | errors over predicted std (root mean square)"
            .split(" | ");
    let surrogates = Table::new("", head, surrogates).with_left(&[0, 1]);
    let meaning = format!(
        "R of the {} other simulations: counted, and with the surrogates in their place; difference: surrogates minus counted, with \
         its 95 % interval",
        found.points
    );
    let columns =
        |curve: &String| [format!("R {curve} counted"), "by surrogates".to_owned(), "difference".to_owned()];
    let rows = found.rows.iter().map(|row| {
        let curves = row.simulated.iter().zip(&row.predicted).zip(&row.standard_error);
        let cells = curves.flat_map(|((simulated, predicted), error)| {
            let difference = format!("{:+.4} ± {:.4}", predicted - simulated, REACH * error);
            [format!("{simulated:.4}"), format!("{predicted:.4}"), difference]
        });
        std::iter::once(row.cycles.to_string()).chain(cells).collect()
    });
    let head = std::iter::once("cycles".to_owned()).chain(found.curves.iter().flat_map(columns));
    let curves = Table::new("", head, rows).with_left(&[]);
    let largest = format!("largest difference of any curve: {:.4}", found.largest_difference());
    Answer {
        title: format!(
            "surrogates fitted to {} simulations, compared with {} others",
            found.learned_from, found.points
        ),
        parts: vec![
            AnswerPart::Table(surrogates),
            AnswerPart::Text(meaning),
            AnswerPart::Table(curves),
            AnswerPart::Text(largest),
        ],
        ..Answer::default()
    }
}
