//! Figures of the rounds of learning.

use super::range;
use crate::presentation::report::figure::Figure;
use crate::presentation::report::format::{count, percent};
use crate::presentation::report::input::ReportInput;
use crate::presentation::report::palette::Ink;
use crate::presentation::report::plot::{Axis, Plot, PlotError, Series, Shape, short};
use crate::results::summary::Round;

/// How learning went, round by round.
///
/// # Errors
/// [`PlotError`].
pub fn learning(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    let rounds = &input.summary.convergence.rounds;
    let (Some(first), Some(last)) = (rounds.first(), rounds.last()) else { return Ok(vec![]) };
    let x = (first.evaluations as f64, last.evaluations as f64);
    let over = |value: &dyn Fn(&Round) -> Option<f64>| -> Vec<(f64, f64)> {
        rounds.iter().filter_map(|round| Some((round.evaluations as f64, value(round)?))).collect()
    };
    // Shares fall by powers of ten; what is zero is shown at the bottom.
    let log = |share: f64| share.max(1e-5).log10();
    let shares = [
        Series::new(
            "uncertain share (U < 2)",
            Ink::Series(0),
            Shape::Dotted(over(&|r| Some(log(r.share_uncertain)))),
        ),
        Series::new(
            "error of surrogate",
            Ink::Series(1),
            Shape::Dotted(over(&|r| Some(log(r.surrogate_error)))),
        ),
        Series::new(
            "change of R",
            Ink::Series(2),
            Shape::Dotted(over(&|r| r.change_of_r.map(|c| log(c.abs())))),
        ),
    ];
    let min_u = over(&|round| Some(round.min_u));
    let reliability = over(&|round| Some(round.reliability_total));
    let (low, high) = range(reliability.iter().map(|p| p.1));
    let u_top = range(min_u.iter().map(|p| p.1)).1.max(2.0) * 1.1;
    let r_margin = (0.15 * (high - low)).max(0.01);
    let of_r = format!("R of the {}", input.subject());
    let plots = [
        (
            "learning-reliability",
            "R at the governing checkpoint",
            of_r.as_str(),
            ((low - r_margin).max(0.0), (high + r_margin).min(1.0)),
            vec![Series::unlisted("R", Ink::Ink, Shape::Dotted(reliability))],
            format!("At the checkpoint where R is nearest 1/2, at the end {} cycles.", count(last.cycles.into())),
        ),
        (
            "learning-shares",
            "What was still uncertain",
            "share",
            (-5.0, 0.0),
            shares.to_vec(),
            format!("At the end {} of the population uncertain.", percent(last.share_uncertain)),
        ),
        (
            "learning-min-u",
            "Smallest learning function",
            "min U",
            (0.0, u_top),
            vec![
                Series::new("U = 2", Ink::Limit, Shape::Level(2.0)),
                Series::unlisted("min U", Ink::Series(0), Shape::Dotted(min_u)),
            ],
            "The distance of the surrogate's mean from the threshold in its own standard deviations, the smallest \
             over population, limit states and checkpoints."
                .into(),
        ),
    ];
    let mut figures = Vec::new();
    for (name, title, y_label, y, series, caption) in plots {
        let linear = Axis::linear(y_label, y);
        let y = if name == "learning-shares" {
            let power = |v: f64| format!("{}\u{a0}%", short(10f64.powf(v + 2.0)));
            Axis { text: power, value: |v| 10f64.powf(v), ..linear }
        } else {
            linear
        };
        let x = Axis::linear("evaluations", x);
        figures.push(Plot { figure: name, x, y, series: &series }.figure(title, &caption)?);
    }
    Ok(figures)
}
