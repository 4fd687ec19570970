//! The cheapest design on the present surrogates: continuous quantities, then grades.

use super::reliability::{DesignReliability, FreeDesign, TargetValue};
use super::result::Grades;
use crate::statistics::optimisation::{Program, cheapest_choice, minimise, nearest};

/// Constraint that counts as met [1].
const MET: f64 = -1e-4;
/// Most combinations of grades that are searched whole; above it those next to the relaxed optimum are.
const MOST_COMBINATIONS: usize = 100_000;
/// Most combinations examined, without and with continuous quantities besides.
const MOST_EXAMINED: (usize, usize) = (2000, 40);

/// The best design found.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    /// Places of the quantities between their bounds `(q,)`.
    pub y: Vec<f64>,
    /// Cost of the design.
    pub cost: f64,
    /// Targets at the design.
    pub values: Vec<TargetValue>,
    /// Rise of the cost per unit of a larger reliability index `(targets,)`, of the relaxed problem.
    pub multipliers: Vec<f64>,
    /// True if every target is met; else the design is the one whose worst target is nearest.
    pub feasible: bool,
    /// Cost if every value between the bounds were allowed.
    pub relaxed_cost: f64,
    /// The search over grades, if there are any.
    pub grades: Option<Grades>,
}

/// Finds the cheapest design, from several starts `(q,)`.
pub(super) fn solve(reliability: &mut DesignReliability<'_>, starts: &[Vec<f64>]) -> Solved {
    let relaxed = solve_relaxed(reliability, starts);
    if reliability.problem.is_discrete() { solve_grades(reliability, relaxed) } else { relaxed }
}

/// Finds the cheapest design with continuous quantities.
pub(super) fn solve_relaxed(reliability: &mut DesignReliability<'_>, starts: &[Vec<f64>]) -> Solved {
    // Reliability indices of a design; all solutions compared have the same targets.
    let least_index = |solved: &Solved| least(solved.values.iter().map(|value| value.beta));
    let better = |a: &Solved, b: &Solved| match (a.feasible, b.feasible) {
        (true, true) => a.cost <= b.cost,
        (false, false) => least_index(a) >= least_index(b),
        (is_met, _) => is_met,
    };
    let found = starts.iter().map(|start| from_start(reliability, start));
    found.reduce(|a, b| if better(&a, &b) { a } else { b }).expect("at least one start")
}

fn least(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(f64::INFINITY, f64::min)
}

fn from_start(reliability: &mut DesignReliability<'_>, start: &[f64]) -> Solved {
    let count = reliability.constraints.len();
    let all: Vec<usize> = (0..start.len()).collect();
    let mut y = start.to_vec();
    let mut multipliers = vec![0.0; count];
    let mut feasible = false;
    // Lines are placed for a design: those of the first descent for its start, of the second for its end.
    for _ in 0..2 {
        reliability.place_lines(&y);
        let design = FreeDesign { reliability, free: all.clone(), at: y.clone() };
        let mut found = minimise(&design, count, &y);
        if !found.feasible {
            let best = nearest(&design, count, &found.x);
            if least(design.constraints(&best).into_iter()) < MET {
                (y, feasible) = (best, false);
                continue;
            }
            found = minimise(&design, count, &best);
        }
        let scale = design.reliability.cost_scale;
        (y, feasible) = (found.x, found.feasible);
        multipliers = found.multipliers.iter().map(|lambda| lambda * scale).collect();
    }
    finished(reliability, y, multipliers, feasible)
}

fn finished(reliability: &DesignReliability, y: Vec<f64>, multipliers: Vec<f64>, feasible: bool) -> Solved {
    let cost = reliability.cost(&y);
    let values = reliability.targets(&y).unwrap_or_default();
    Solved { cost, values, multipliers, feasible, relaxed_cost: cost, grades: None, y }
}

/// Chooses grades, from the relaxed optimum.
fn solve_grades(reliability: &mut DesignReliability<'_>, relaxed: Solved) -> Solved {
    let problem = reliability.problem;
    let count = reliability.constraints.len();
    let is_graded = |k: &usize| !problem.quantities[*k].grades.is_empty();
    let (graded, free): (Vec<usize>, Vec<usize>) = (0..relaxed.y.len()).partition(is_graded);
    let places = |k: &usize| {
        let quantity = &problem.quantities[*k];
        quantity.grades.iter().map(|grade| quantity.place(grade.width)).collect()
    };
    let mut allowed: Vec<Vec<f64>> = graded.iter().map(places).collect();
    let combinations = allowed.iter().map(Vec::len).fold(1, usize::saturating_mul);
    let whole = combinations <= MOST_COMBINATIONS;
    if !whole {
        for (options, k) in allowed.iter_mut().zip(&graded) {
            let at = relaxed.y[*k];
            let above = options.partition_point(|y| *y < at).min(options.len() - 1);
            *options = options[above.saturating_sub(1)..=above].to_vec();
        }
    }
    let cost_of = |k: usize, y: f64| {
        let quantity = &problem.quantities[k];
        quantity.cost_at(quantity.value(y)).0
    };
    let costs_at = |(places, k): (&Vec<f64>, &usize)| places.iter().map(|y| cost_of(*k, *y)).collect();
    let costs: Vec<Vec<f64>> = allowed.iter().zip(&graded).map(costs_at).collect();
    // A cost between bounds is least at one of 21 places, to the accuracy of a bound.
    let cheapest = |k: &usize| least((0..=20).map(|i| cost_of(*k, f64::from(i) / 20.0)));
    let rest = free.iter().map(cheapest).sum::<f64>();
    let most = if free.is_empty() { MOST_EXAMINED.0 } else { MOST_EXAMINED.1 };
    let known = if relaxed.feasible { relaxed.cost } else { f64::NEG_INFINITY };
    let mut best: Option<(Vec<f64>, f64)> = None;
    let search = cheapest_choice(&costs, rest, known, most, |chosen| {
        let mut y = relaxed.y.clone();
        for ((k, options), chosen) in graded.iter().zip(&allowed).zip(chosen) {
            y[*k] = options[*chosen];
        }
        if !free.is_empty() {
            let start: Vec<f64> = free.iter().map(|k| y[*k]).collect();
            let design = FreeDesign { reliability, free: free.clone(), at: y };
            y = design.all(&minimise(&design, count, &start).x);
        }
        let values = reliability.targets(&y)?;
        let constraints = values.iter().zip(&reliability.constraints).map(|(v, c)| v.beta - c.beta);
        let cost = reliability.cost(&y);
        let met = least(constraints) >= MET;
        if met && best.as_ref().is_none_or(|(_, least)| cost < *least) {
            best = Some((y, cost));
        }
        met.then_some(cost)
    });
    let relaxed_cost = relaxed.cost;
    let (examined, proved) = (search.examined, search.proved && whole);
    let grades = Some(Grades { examined, proved, relaxed_cost });
    let feasible = best.is_some();
    // The narrowest grades come nearest.
    let narrowest = (0..relaxed.y.len()).map(|k| if graded.contains(&k) { 0.0 } else { relaxed.y[k] });
    let y = best.map_or_else(|| narrowest.collect(), |(y, _)| y);
    Solved { grades, relaxed_cost, ..finished(reliability, y, relaxed.multipliers, feasible) }
}
