//! Figures of designs: lives and reliabilities against the design variables with their intervals.

use super::answer::{Best, DesignAnswer};
use super::space::{DesignSpace, DesignVariable};
use crate::analyses::paired_results::spread;
use crate::presentation::report::format::shortest;
use crate::presentation::report::life::{LEVELS, LifeAt, end_of_life, life_at};
use crate::presentation::report::{Axis, Figure, Ink, Plot, SERIES, Series, Shape};

/// Most checkpoints in the figure of R.
const CHECKPOINTS: usize = 4;

/// Point of a curve with its limits: (x, y, lower, upper).
type Limited = (f64, f64, f64, f64);

/// The figures of these answers, those of a grid in the order of [`DesignSpace::grid`].
pub fn figures(space: &DesignSpace, answers: &[DesignAnswer], best: Option<&Best>) -> Vec<Figure> {
    if space.variables.len() == 1 {
        return [lives(space, answers)].into_iter().chain(reliabilities(space, answers)).collect();
    }
    let best = best.map_or(0, |best| best.index);
    LEVELS.map(|level| family(space, answers, best, level)).to_vec()
}

/// Life of the system with its limits; `None` where it is not resolved.
fn life(answer: &DesignAnswer, level: f64) -> Option<Limited> {
    let LifeAt::Cycles { life, lower, upper } = life_at(&answer.summary, "total", level) else { return None };
    Some((answer.values[0], life, lower, upper.unwrap_or(end_of_life(&answer.summary))))
}

/// A curve with dots at the designs and its band.
fn curve(label: &str, k: usize, points: &[Limited]) -> [Series; 2] {
    let band = points.iter().map(|(x, _, lower, upper)| (*x, *lower, *upper)).collect();
    let line = points.iter().map(|(x, y, _, _)| (*x, *y)).collect();
    [
        Series::unlisted(format!("{label}, 95 %"), Ink::Series(k), Shape::Band(band)),
        Series::new(label, Ink::Series(k), Shape::Dotted(line)),
    ]
}

/// Lives at the usual levels against the one design variable.
fn lives(space: &DesignSpace, answers: &[DesignAnswer]) -> Figure {
    let curves = LEVELS.iter().enumerate().flat_map(|(k, level)| {
        let points: Vec<Limited> = answers.iter().filter_map(|answer| life(answer, *level)).collect();
        curve(&format!("R = {level}"), k, &points)
    });
    let words = ("Life against the design", "Bands: 95 % interval; dots: designs assessed.");
    plot(space, "design-life", words, ("life [cycles]", range_of_lives(answers)), curves)
}

/// R of the system at the checkpoints where it depends most on the design; none if it depends on it at none.
fn reliabilities(space: &DesignSpace, answers: &[DesignAnswer]) -> Option<Figure> {
    let r = |answer: &DesignAnswer, n: usize| answer.summary.reliability[n].reliability["total"];
    let spread = |n: &usize| {
        let all = answers.iter().map(|answer| r(answer, *n));
        let (low, high) = all.fold((1.0f64, 0.0f64), |(low, high), r| (low.min(r), high.max(r)));
        high - low
    };
    let rows = &answers[0].summary.reliability;
    let mut chosen: Vec<usize> = (0..rows.len()).filter(|n| spread(n) > 0.01).collect();
    chosen.sort_by(|a, b| spread(b).total_cmp(&spread(a)));
    chosen.truncate(CHECKPOINTS);
    chosen.sort_unstable();
    if chosen.is_empty() {
        return None;
    }
    let curves = chosen.iter().enumerate().flat_map(|(k, n)| {
        let point = |answer: &DesignAnswer| {
            let range = answer.summary.reliability[*n].interval_of("total");
            let r = r(answer, *n);
            let (lower, upper) = range.map_or((r, r), |range| (range.lower, range.upper));
            (answer.values[0], r, lower, upper)
        };
        let points: Vec<Limited> = answers.iter().map(point).collect();
        curve(&format!("{} cycles", rows[*n].cycles), k, &points)
    });
    let caption = "R of the system at the checkpoints where the design matters most, with 95 % intervals.";
    let words = ("Reliability against the design", caption);
    Some(plot(space, "design-reliability", words, ("reliability R", (0.0, 1.0)), curves))
}

/// Life at a level against the first design variable, a curve for each value of the second; a third one has its value of the
/// design `best`.
fn family(space: &DesignSpace, answers: &[DesignAnswer], best: usize, level: f64) -> Figure {
    let second = &space.variables[1];
    let at_best = |answer: &&DesignAnswer| answer.values[2..].iter().eq(answers[best].values[2..].iter());
    let shown: Vec<&DesignAnswer> = answers.iter().filter(at_best).collect();
    let mut values: Vec<f64> = shown.iter().map(|answer| answer.values[1]).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    // As many curves as there are colours, spread over the range.
    let curves = spread(&values, SERIES).into_iter().enumerate().flat_map(|(k, value)| {
        let of_value = shown.iter().filter(|answer| answer.values[1].to_bits() == value.to_bits());
        let points: Vec<Limited> = of_value.filter_map(|answer| life(answer, level)).collect();
        curve(&format!("{} = {}", second.key, second.with_unit(value)), k, &points)
    });
    let held =
        |third: &DesignVariable| format!(" {} = {}.", third.key, third.with_unit(answers[best].values[2]));
    let third = space.variables.get(2).map_or(String::new(), held);
    let name = format!("design-life-{}", level.to_string().replace('.', "-"));
    let words = (format!("Life at R = {level} against the design"), format!("Bands: 95 % interval.{third}"));
    plot(space, &name, (&words.0, &words.1), ("life [cycles]", range_of_lives(answers)), curves)
}

/// From the shortest to the longest life of any design, with a margin.
fn range_of_lives(answers: &[DesignAnswer]) -> (f64, f64) {
    let all = answers.iter().flat_map(|answer| LEVELS.iter().filter_map(|level| life(answer, *level)));
    let wider = |(low, high): (f64, f64), (_, _, lower, upper): Limited| (low.min(lower), high.max(upper));
    let (low, high) = all.fold((f64::INFINITY, 0.0), wider);
    if low < high { (low - 0.05 * (high - low), high + 0.05 * (high - low)) } else { (0.0, 1.0) }
}

fn plot(
    space: &DesignSpace,
    name: &str,
    (title, caption): (&str, &str),
    (label, range): (&str, (f64, f64)),
    series: impl Iterator<Item = Series>,
) -> Figure {
    let first = &space.variables[0];
    let x_label = first.label();
    let x = Axis { text: |value| shortest(value, 6), ..Axis::linear(&x_label, (first.lower, first.upper)) };
    let series = &series.collect::<Vec<_>>();
    Plot { figure: name, x, y: Axis::linear(label, range), series }.figure(title, caption)
}
