//! The figure of cost against reliability: the least cost for stricter and looser targets.

use super::result::{FrontPoint, OptimisationResult};
use crate::presentation::report::palette::Ink;
use crate::presentation::report::{Axis, Figure, Plot, PlotError, Scale, Series, Shape};

/// The figure; `None` with fewer than two targets that any design meets.
///
/// # Errors
/// [`PlotError`].
pub fn front_figure(result: &OptimisationResult) -> Result<Option<Figure>, PlotError> {
    let known = |point: &FrontPoint| Some((point.factor.log10(), point.cost?));
    let mut front: Vec<(f64, f64)> = result.front.iter().filter_map(known).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [Some(first), Some(last)] = [front.first(), front.last()] else { return Ok(None) };
    if front.len() < 2 {
        return Ok(None);
    }
    let x = Axis {
        label: "failure probability allowed, times that of the targets",
        range: (first.0, last.0),
        text: |exponent| three_digits(10f64.powf(exponent)),
        scale: Scale::Logarithm,
    };
    let costs = front.iter().map(|(_, cost)| *cost).chain([result.cost]);
    let (low, high) = costs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), c| (l.min(c), h.max(c)));
    let margin = 0.05 * (high - low).max(0.01 * high.abs());
    let series = [
        Series::new("least cost", Ink::Series(0), Shape::Dotted(front.clone())),
        Series::new("optimum", Ink::Limit, Shape::Marked(vec![((0.0, result.cost), String::new())])),
        Series::unlisted("cost of the study's design", Ink::Muted, Shape::Level(result.cost_before)),
    ];
    // The design of the study is drawn where it lies in the range of the others.
    let shown = if (low..=high).contains(&result.cost_before) { &series[..] } else { &series[..2] };
    let plot = Plot {
        figure: "cost-against-reliability",
        x,
        y: Axis::linear("cost", (low - margin, high + margin)),
        series: shown,
    };
    let caption = "Least costs on the surrogates, with every tolerance between grades allowed; 1 stands for the targets.";
    plot.figure("Cost against reliability", caption).map(Some)
}

/// A factor with three digits.
fn three_digits(factor: f64) -> String {
    let rounded: f64 = format!("{factor:.2e}").parse().unwrap_or(factor);
    rounded.to_string()
}
