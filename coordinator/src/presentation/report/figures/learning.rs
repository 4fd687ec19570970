//! Figures of the rounds of learning.

use super::range;
use crate::presentation::report::figure::Figure;
use crate::presentation::report::format::{count, percent};
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Plot, Points, Scale, Series, Shape, tick_label};
use crate::results::summary::Round;

/// Smallest share on the logarithmic axis [1]; smaller ones are drawn there.
const SMALLEST_SHARE: f64 = 1e-5;

/// Convergence over the rounds: reliability, remaining uncertainty, and smallest learning function.
pub fn learning(input: &ReportInput) -> Vec<Figure> {
    let rounds = &input.summary.convergence.rounds;
    let (Some(first), Some(last)) = (rounds.first(), rounds.last()) else { return vec![] };
    let x = Axis::linear("evaluations", (first.evaluations as f64, last.evaluations as f64));
    vec![
        reliability(rounds, last, x, &format!("R of the {}", input.subject())),
        uncertainty(rounds, last, x),
        smallest_u(rounds, x),
    ]
}

/// A quantity of every round over its number of evaluations, where it is known.
fn over(rounds: &[Round], value: impl Fn(&Round) -> Option<f64>) -> Points {
    rounds.iter().filter_map(|round| Some((round.evaluations as f64, value(round)?))).collect()
}

fn reliability(rounds: &[Round], last: &Round, x: Axis<'_>, label: &str) -> Figure {
    let reliability = over(rounds, |round| Some(round.reliability_total));
    let (low, high) = range(reliability.iter().map(|point| point.1));
    let margin = (0.15 * (high - low)).max(0.01);
    let plot = Plot {
        figure: "learning-reliability",
        x,
        y: Axis::linear(label, ((low - margin).max(0.0), (high + margin).min(1.0))),
        series: &[Series::unlisted("R", Ink::Ink, Shape::Dotted(reliability))],
    };
    let caption =
        format!("At the checkpoint where R is nearest 1/2: at the end {} cycles.", count(last.cycles.into()));
    plot.figure("R at the governing checkpoint", &caption)
}

fn uncertainty(rounds: &[Round], last: &Round, x: Axis<'_>) -> Figure {
    let log = |share: f64| share.max(SMALLEST_SHARE).log10();
    let uncertain = over(rounds, |round| Some(log(round.share_uncertain)));
    let error = over(rounds, |round| Some(log(round.surrogate_error)));
    let change = over(rounds, |round| round.change_of_r.map(|change| log(change.abs())));
    let plot = Plot {
        figure: "learning-shares",
        x,
        y: Axis {
            text: |power| format!("{}\u{a0}%", tick_label(10f64.powf(power + 2.0))),
            scale: Scale::Logarithm,
            ..Axis::linear("share", (SMALLEST_SHARE.log10(), 0.0))
        },
        series: &[
            Series::new("uncertain share (U < 2)", Ink::Series(0), Shape::Dotted(uncertain)),
            Series::new("surrogate error", Ink::Series(1), Shape::Dotted(error)),
            Series::new("change of R", Ink::Series(2), Shape::Dotted(change)),
        ],
    };
    let caption = format!("At the end {} of the population is uncertain.", percent(last.share_uncertain));
    plot.figure("Remaining uncertainty", &caption)
}

fn smallest_u(rounds: &[Round], x: Axis<'_>) -> Figure {
    let min_u = over(rounds, |round| Some(round.min_u));
    let top = range(min_u.iter().map(|point| point.1)).1.max(2.0) * 1.1;
    let plot = Plot {
        figure: "learning-min-u",
        x,
        y: Axis::linear("min U", (0.0, top)),
        series: &[
            Series::new("U = 2", Ink::Limit, Shape::Level(2.0)),
            Series::unlisted("min U", Ink::Series(0), Shape::Dotted(min_u)),
        ],
    };
    plot.figure(
        "Smallest learning function",
        "U: distance of the surrogate's mean from the threshold in units of its standard deviation; the smallest over \
         population, limit states and checkpoints.",
    )
}
