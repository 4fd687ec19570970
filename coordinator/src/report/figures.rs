//! The figures of a report, one function each, from its input. Each function gives no figure where the input
//! holds nothing to show.

use super::format::{count, fixed, percent};
use super::input::{LimitStateInfo, OutputDistribution, ReportInput};
use super::life::{governing, rows_that_matter};
use super::palette::Ink;
use super::plot::{Plot, PlotError, Series, Shape, short};
use crate::summary::{ReliabilityRow, Round};

/// A figure: name (of its file too), title, caption, and an SVG document.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name, letters, digits and hyphens.
    pub name: String,
    /// Title, plain text.
    pub title: String,
    /// Caption, plain text.
    pub caption: String,
    /// SVG document.
    pub svg: String,
}

/// Cycles as the axes count them, and how the axes say so.
struct LifeAxis {
    divisor: f64,
    label: &'static str,
}

impl LifeAxis {
    fn of(input: &ReportInput) -> Self {
        let last = input.summary.reliability.last().map_or(0, |row| row.cycles);
        if last >= 10_000 {
            Self { divisor: 1000.0, label: "life [1000 cycles]" }
        } else {
            Self { divisor: 1.0, label: "life [cycles]" }
        }
    }

    fn at(&self, cycles: u32) -> f64 {
        f64::from(cycles) / self.divisor
    }
}

/// Colour of a limit state, the same in every figure.
pub(super) fn ink_of(input: &ReportInput, name: &str) -> Ink {
    input.limit_states.iter().position(|state| state.name == name).map_or(Ink::Ink, Ink::Series)
}

/// Reliability over life per limit state and in total, with bands of 1.96 standard errors.
///
/// # Errors
/// [`PlotError`].
pub fn reliability(input: &ReportInput) -> Result<Option<Figure>, PlotError> {
    let rows = rows_that_matter(&input.summary, 3);
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return Ok(None) };
    let axis = LifeAxis::of(input);
    let mut names: Vec<&str> = input.limit_states.iter().map(|state| state.name.as_str()).collect();
    if names.len() != 1 {
        names.push("total");
    }
    let value = |row: &ReliabilityRow, name: &str| row.reliability.get(name).copied().unwrap_or(f64::NAN);
    let mut series = Vec::new();
    for name in &names {
        let band = rows
            .iter()
            .map(|row| {
                let (r, error) = (value(row, name), row.standard_error.get(*name).copied().unwrap_or(0.0));
                (axis.at(row.cycles), (r - 1.96 * error).max(0.0), (r + 1.96 * error).min(1.0))
            })
            .collect();
        series.push(Series::new("", ink_of(input, name), Shape::Band(band)));
    }
    for name in &names {
        let points = rows.iter().map(|row| (axis.at(row.cycles), value(row, name))).collect();
        let shape = if *name == "total" { Shape::Dashed(points) } else { Shape::Line(points) };
        series.push(Series::new(*name, ink_of(input, name), shape));
    }
    let svg = Plot {
        figure: "reliability",
        x_label: axis.label,
        y_label: "reliability R",
        x: (axis.at(first.cycles), axis.at(last.cycles)),
        y: (0.0, 1.0),
        y_text: &short,
        series: &series,
    }
    .svg()?;
    let caption = "Probability that no failure has occurred up to this life, per limit state and for the whole \
                   mechanism, which fails by whichever comes first. Bands: 1.96 standard errors, sampling and \
                   surrogate together.";
    Ok(Some(figure("reliability", "Reliability over life", caption, svg)))
}

/// One figure per limit state: its output's distribution at three checkpoints around the governing one.
///
/// # Errors
/// [`PlotError`].
pub fn distributions(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    let mut figures = Vec::new();
    for state in &input.limit_states {
        let shown = three_around_governing(input, state);
        if shown.is_empty() {
            continue;
        }
        let output = &input.outputs[state.output];
        let unit = output.unit;
        let threshold = unit.to_shown(state.threshold);
        let mut series = Vec::new();
        let (mut low, mut high, mut top) = (threshold, threshold, 0.0_f64);
        for (k, distribution) in shown.iter().enumerate() {
            let all: u64 = distribution.counts.iter().sum();
            let bars: Vec<_> = distribution
                .edges
                .windows(2)
                .zip(&distribution.counts)
                .map(|(edges, count)| {
                    let (left, right) = (unit.to_shown(edges[0]), unit.to_shown(edges[1]));
                    (left, right, *count as f64 / (all.max(1) as f64 * (right - left)))
                })
                .filter(|(left, right, height)| right > left && height.is_finite())
                .collect();
            for (left, right, height) in &bars {
                (low, high, top) = (low.min(*left), high.max(*right), top.max(*height));
            }
            let label = format!("{} cycles", count(u64::from(distribution.cycles)));
            series.push(Series::new(label, Ink::Series(k + 2), Shape::Steps(bars)));
        }
        series.push(Series::new("threshold", Ink::Limit, Shape::Upright(threshold)));
        let name = format!("distribution-{}", file_name(&state.name));
        let svg = Plot {
            figure: &name,
            x_label: &format!("{} [{}]", words(&output.name), unit.symbol()),
            y_label: &format!("density [1/({})]", unit.symbol()),
            x: (low - 0.03 * (high - low), high + 0.03 * (high - low)),
            y: (0.0, 1.08 * top),
            y_text: &short,
            series: &series,
        }
        .svg()?;
        let means: Vec<String> = shown
            .iter()
            .map(|d| {
                format!(
                    "{} ± {} {} at {}",
                    fixed(unit.to_shown(d.mean), 2),
                    fixed(unit.to_shown(d.std), 2),
                    unit.symbol(),
                    count(d.cycles.into())
                )
            })
            .collect();
        let caption = format!(
            "Over the whole population. Mean ± standard deviation: {} cycles. Beyond the threshold of {} {} the \
             mechanism has failed.",
            means.join(", "),
            short(threshold),
            unit.symbol()
        );
        figures.push(figure(
            &name,
            &capital(&format!("{} late in life", words(&output.name))),
            &caption,
            svg,
        ));
    }
    Ok(figures)
}

/// Distributions of a limit state's output at the governing checkpoint and two checkpoints before and after,
/// the governing one being moved to a multiple of two checkpoints; or the three nearest there are.
fn three_around_governing<'a>(input: &'a ReportInput, state: &LimitStateInfo) -> Vec<&'a OutputDistribution> {
    let name = &input.outputs[state.output].name;
    let mut shown: Vec<&OutputDistribution> =
        input.distributions.iter().filter(|d| d.output == *name && d.edges.len() > 1).collect();
    shown.sort_by_key(|d| d.cycles);
    let Some(governing) = governing(&input.summary) else { return shown.into_iter().take(3).collect() };
    let every = input.summary.reliability.first().map_or(1, |row| row.cycles).max(1);
    let centre = (governing.cycles + every) / (2 * every) * (2 * every);
    let wanted = [centre.saturating_sub(2 * every), centre, centre + 2 * every];
    let exact: Vec<_> = shown.iter().copied().filter(|d| wanted.contains(&d.cycles)).collect();
    if exact.len() == 3 {
        return exact;
    }
    shown.sort_by_key(|d| (d.cycles.abs_diff(centre), d.cycles));
    shown.truncate(3);
    shown.sort_by_key(|d| d.cycles);
    shown
}

/// One figure per limit state: its output over the whole life, nominal mechanism and population.
///
/// # Errors
/// [`PlotError`].
pub fn histories(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    let axis = LifeAxis::of(input);
    let mut figures = Vec::new();
    for state in &input.limit_states {
        let output = &input.outputs[state.output];
        let unit = output.unit;
        let threshold = unit.to_shown(state.threshold);
        let key = |what: &str| format!("{}_{what}_{}", state.name, unit.suffix());
        let band: Vec<_> = input
            .summary
            .moments
            .iter()
            .filter_map(|row| {
                let mean = unit.file_to_shown(*row.get(&key("mean"))?);
                let spread = 2.0 * unit.file_to_shown(*row.get(&key("std"))?);
                Some((row.get("cycles")? / axis.divisor, mean - spread, mean + spread))
            })
            .filter(|(_, low, high)| low.is_finite() && high.is_finite())
            .collect();
        let nominal: Vec<_> = input.nominal.as_ref().map_or(vec![], |nominal| {
            let history = nominal.histories.get(state.output).map_or(&[][..], Vec::as_slice);
            nominal.cycles.iter().zip(history).map(|(n, v)| (axis.at(*n), unit.to_shown(*v))).collect()
        });
        let last = nominal.last().map(|p| p.0).into_iter().chain(band.last().map(|p| p.0)).reduce(f64::max);
        let Some(last) = last else { continue };
        let values = nominal.iter().map(|p| p.1).chain(band.iter().flat_map(|p| [p.1, p.2]));
        let (low, high) = values.fold((threshold, threshold), |(low, high), v| (low.min(v), high.max(v)));
        let low = if low < 0.5 * high { 0.0 } else { low - 0.1 * (high - low) };
        let mut series = vec![Series::new("threshold", Ink::Limit, Shape::Level(threshold))];
        if !band.is_empty() {
            series.push(Series::new(
                "population, mean ± 2 std",
                ink_of(input, &state.name),
                Shape::Band(band),
            ));
        }
        if !nominal.is_empty() {
            series.push(Series::new("nominal", Ink::Ink, Shape::Line(nominal)));
        }
        let name = format!("history-{}", file_name(&state.name));
        let svg = Plot {
            figure: &name,
            x_label: axis.label,
            y_label: &format!("{} [{}]", words(&output.name), unit.symbol()),
            x: (0.0, last),
            y: (low, high + 0.05 * (high - low)),
            y_text: &short,
            series: &series,
        }
        .svg()?;
        let caption = "Each value belongs to the profile worn to that many cycles. The nominal mechanism has every \
                       variable at its mean.";
        figures.push(figure(&name, &capital(&format!("{} over life", words(&output.name))), caption, svg));
    }
    Ok(figures)
}

/// Joint forces, angles and angular velocities of the settled first cycle of the unworn nominal mechanism.
///
/// # Errors
/// [`PlotError`].
pub fn first_cycle(input: &ReportInput) -> Result<Vec<Figure>, PlotError> {
    let Some(cycle) = input.nominal.as_ref().and_then(|nominal| nominal.first_cycle.as_ref()) else {
        return Ok(vec![]);
    };
    let time: Vec<f64> = cycle.time.iter().map(|t| t * 1e3).collect();
    let trace = |values: &[f64], factor: f64| -> Vec<(f64, f64)> {
        time.iter().zip(values).map(|(t, v)| (*t, v * factor)).collect()
    };
    let forces: Vec<_> =
        cycle.joint_force.iter().map(|(n, f)| (format!("joint {n}"), trace(f, 1.0))).collect();
    let degrees = 180.0 / std::f64::consts::PI;
    let rpm = 30.0 / std::f64::consts::PI;
    let angles = cycle.bodies.iter().map(|body| (body.label.clone(), trace(&body.angle, degrees))).collect();
    let speeds = cycle.bodies.iter().map(|body| (body.label.clone(), trace(&body.speed, rpm))).collect();
    let peaks: Vec<String> = cycle
        .joint_force
        .iter()
        .map(|(name, force)| format!("{name}: {} N", fixed(force.iter().copied().fold(0.0, f64::max), 2)))
        .collect();
    let extremes: Vec<String> = cycle
        .bodies
        .iter()
        .map(|body| {
            let (low, high) = range(body.angle.iter().map(|angle| angle * degrees));
            format!("{}: {}° to {}°", body.label, fixed(low, 3), fixed(high, 3))
        })
        .collect();
    let sides: [(&str, &str, &str, Vec<(String, Vec<(f64, f64)>)>, String); 3] = [
        (
            "joint-forces",
            "Contact forces of the first cycle",
            "contact force [N]",
            forces,
            format!("Unworn nominal mechanism, settled. Peaks of joints {}.", peaks.join(", ")),
        ),
        ("angles", "Angles of the first cycle", "angle [°]", angles, format!("{}.", extremes.join("; "))),
        (
            "angular-velocities",
            "Angular velocities of the first cycle",
            "angular velocity [r/min]",
            speeds,
            "Of the bodies above, in the same sense.".into(),
        ),
    ];
    let mut figures = Vec::new();
    for (name, title, y_label, traces, caption) in sides {
        if traces.is_empty() || time.len() < 2 {
            continue;
        }
        let (low, high) = range(traces.iter().flat_map(|(_, points)| points.iter().map(|p| p.1)));
        // Traces of mirrored halves nearly coincide: every second one is broken, so that both are seen.
        let series: Vec<_> = traces
            .into_iter()
            .enumerate()
            .map(|(k, (label, points))| {
                let shape = if k % 2 == 1 { Shape::Dashed(points) } else { Shape::Line(points) };
                Series::new(label, Ink::Series(k), shape)
            })
            .collect();
        let margin = 0.04 * (high - low);
        let svg = Plot {
            figure: name,
            x_label: "time [ms]",
            y_label,
            x: (time[0], time[time.len() - 1]),
            y: (if low >= 0.0 { 0.0 } else { low - margin }, high + margin),
            y_text: &short,
            series: &series,
        }
        .svg()?;
        figures.push(figure(name, title, &caption, svg));
    }
    Ok(figures)
}

/// One polar figure per joint of the nominal mechanism with wear, all on one scale.
pub fn bores(input: &ReportInput) -> Vec<Figure> {
    let Some(nominal) = &input.nominal else { return vec![] };
    let deepest = |wear: &[f64]| wear.iter().copied().fold(0.0, f64::max);
    let largest = nominal.joints.iter().map(|joint| deepest(&joint.wear_depth)).fold(0.0, f64::max);
    let full = super::bore::full_scale(largest);
    let worn = nominal.joints.iter().filter(|joint| !joint.wear_depth.is_empty());
    worn.map(|joint| {
        let wear = &joint.wear_depth;
        let place = (0..wear.len()).max_by(|a, b| wear[*a].total_cmp(&wear[*b])).unwrap_or(0);
        let caption = format!(
            "Deepest {} µm at {}°; peak force {} N.",
            fixed(1e6 * deepest(wear), 2),
            fixed(360.0 * place as f64 / wear.len() as f64, 0),
            fixed(joint.peak_force, 2)
        );
        let name = format!("bore-{}", file_name(&joint.name));
        figure(
            &name,
            &format!("Bore of joint {}", joint.name),
            &caption,
            super::bore::svg(&joint.name, wear, full),
        )
    })
    .collect()
}

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
    let plots = [
        (
            "learning-reliability",
            "R at the governing checkpoint",
            "R of the mechanism",
            ((low - r_margin).max(0.0), (high + r_margin).min(1.0)),
            vec![Series::new("", Ink::Ink, Shape::Dotted(reliability))],
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
                Series::new("", Ink::Series(0), Shape::Dotted(min_u)),
            ],
            "The distance of the surrogate's mean from the threshold in its own standard deviations, the smallest \
             over population, limit states and checkpoints."
                .into(),
        ),
    ];
    let mut figures = Vec::new();
    for (name, title, y_label, y, series, caption) in plots {
        let power = |v: f64| format!("{}\u{a0}%", short(10f64.powf(v + 2.0)));
        let y_text: &dyn Fn(f64) -> String = if name == "learning-shares" { &power } else { &short };
        let svg =
            Plot { figure: name, x_label: "evaluations", y_label, x, y, y_text, series: &series }.svg()?;
        figures.push(figure(name, title, &caption, svg));
    }
    Ok(figures)
}

fn figure(name: &str, title: &str, caption: &str, svg: String) -> Figure {
    Figure { name: name.into(), title: title.into(), caption: caption.into(), svg }
}

/// Smallest and largest finite value; (0, 1) if there is none.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let both = values.filter(|v| v.is_finite()).fold(None, |range: Option<(f64, f64)>, v| {
        Some(range.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
    });
    both.unwrap_or((0.0, 1.0))
}

/// A name of a scene as part of a file's name.
pub(super) fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || c == '-' { c } else { '-' }).collect()
}

/// An identifier as words.
pub(super) fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// With a capital first letter.
pub(super) fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}
