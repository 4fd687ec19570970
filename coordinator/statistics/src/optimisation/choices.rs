//! The cheapest combination of discrete choices that is feasible, by examining combinations in the order of their cost.
//!
//! With cost c_k(o) of option o of choice k and a bound b on whatever else costs, no combination costs less than
//! b + sum_k c_k(o_k). Combinations are enumerated by ascending bound (best first), each once, from a heap; the first
//! whose bound is not below the cheapest feasible one found proves that one the cheapest. Combinations cheaper than the
//! optimum of the relaxed problem, which lets every choice vary continuously, are infeasible and are not examined.
//!
//! # Source
//! Best-first branch and bound: Land, Doig (1960), An automatic method of solving discrete programming problems,
//! Econometrica 28(3). Enumeration of sums in ascending order: Lawler (1972), A procedure for computing the K best
//! solutions to discrete optimization problems, Management Science 18(7).

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

/// Most combinations that are enumerated, examined or not.
const MOST_ENUMERATED: usize = 500_000;

/// Result of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct ChoiceSearch {
    /// Options of the cheapest feasible combination `(choices,)` and its cost; `None` if no examined one is feasible.
    pub best: Option<(Vec<usize>, f64)>,
    /// Number of combinations examined.
    pub examined: usize,
    /// True if the search has proved that no other combination is cheaper.
    pub proved: bool,
}

/// A combination with its cost: places of its options in the lists sorted by cost, and the last choice that was raised.
#[derive(PartialEq)]
struct Combination {
    cost: f64,
    places: Vec<usize>,
    raised: usize,
}

impl Eq for Combination {}

impl Ord for Combination {
    fn cmp(&self, other: &Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then_with(|| self.places.cmp(&other.places))
    }
}

impl PartialOrd for Combination {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Searches the cheapest feasible combination of options with `costs` `(choices)(options,)`.
///
/// `rest` is a lower bound on all other costs, `relaxed` the cost of the relaxed optimum (minus infinity if it is not
/// known). `examine` returns the total cost of a combination `(choices,)` if it is feasible; it is called for at most
/// `most` combinations.
pub fn cheapest_choice(
    costs: &[Vec<f64>],
    rest: f64,
    relaxed: f64,
    most: usize,
    mut examine: impl FnMut(&[usize]) -> Option<f64>,
) -> ChoiceSearch {
    let by_cost = |costs: &Vec<f64>| {
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
        order
    };
    let order: Vec<Vec<usize>> = costs.iter().map(by_cost).collect();
    let cost_of = |places: &[usize]| -> f64 {
        rest + places.iter().enumerate().map(|(k, place)| costs[k][order[k][*place]]).sum::<f64>()
    };
    let first = vec![0; costs.len()];
    let mut heap =
        BinaryHeap::from([Reverse(Combination { cost: cost_of(&first), places: first, raised: 0 })]);
    let mut found = ChoiceSearch { best: None, examined: 0, proved: false };
    let margin = 1e-9 * relaxed.abs();
    for _ in 0..MOST_ENUMERATED {
        let best = found.best.as_ref().map_or(f64::INFINITY, |(_, cost)| *cost);
        let Some(Reverse(next)) = heap.pop().filter(|next| next.0.cost < best) else {
            found.proved = true;
            break;
        };
        // Each combination has one parent: the one with its last raised choice lowered by one.
        for k in next.raised..costs.len() {
            if next.places[k] + 1 < order[k].len() {
                let mut places = next.places.clone();
                places[k] += 1;
                heap.push(Reverse(Combination { cost: cost_of(&places), places, raised: k }));
            }
        }
        // Without other costs the bound is the cost.
        if rest == 0.0 && next.cost < relaxed - margin {
            continue;
        }
        if found.examined == most {
            break;
        }
        found.examined += 1;
        let options: Vec<usize> = next.places.iter().enumerate().map(|(k, place)| order[k][*place]).collect();
        if let Some(cost) = examine(&options).filter(|cost| *cost < best) {
            found.best = Some((options, cost));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_finds_what_trying_all_finds() {
        // Spreads 1, 2, 4, 8 at costs 8, 4, 2, 1 times a factor; the sum of squares is bounded.
        let spread = |o: usize| f64::from(1 << o);
        let factors = [1.0, 1.7, 0.6, 2.3];
        let costs: Vec<Vec<f64>> =
            factors.iter().map(|f| (0..4).map(|o| f * 8.0 / spread(o)).collect()).collect();
        for bound in [5.0, 20.0, 60.0, 150.0, 3.0] {
            let feasible = |o: &[usize]| o.iter().map(|o| spread(*o).powi(2)).sum::<f64>() <= bound;
            let cost = |o: &[usize]| o.iter().enumerate().map(|(k, o)| costs[k][*o]).sum::<f64>();
            let all = (0..256usize).map(|i| [i % 4, i / 4 % 4, i / 16 % 4, i / 64]);
            let exact = all.filter(|o| feasible(o)).map(|o| cost(&o)).fold(f64::INFINITY, f64::min);
            let search =
                |relaxed: f64| cheapest_choice(&costs, 0.0, relaxed, 1000, |o| feasible(o).then(|| cost(o)));
            let found = search(f64::NEG_INFINITY);
            assert!(found.proved);
            assert_eq!(found.best.as_ref().map_or(f64::INFINITY, |(_, cost)| *cost), exact, "{bound}");
            if exact.is_finite() {
                // The relaxed optimum, (sum sqrt(f)^(2/3))^(3/2) scaled, saves the infeasible ones.
                let relaxed =
                    8.0 * factors.iter().map(|f| f.powf(2.0 / 3.0)).sum::<f64>().powf(1.5) / bound.sqrt();
                let narrowed = search(relaxed);
                assert_eq!(narrowed.best, found.best);
                assert!(narrowed.examined <= found.examined);
            }
        }
    }

    #[test]
    fn a_search_that_ends_early_proves_nothing() {
        let costs = vec![vec![1.0, 2.0, 3.0]; 3];
        let found = cheapest_choice(&costs, 0.0, f64::NEG_INFINITY, 2, |_| None);
        assert_eq!((found.best, found.examined, found.proved), (None, 2, false));
        let all = cheapest_choice(&costs, 1.0, f64::NEG_INFINITY, 100, |_| None);
        assert_eq!((all.examined, all.proved), (27, true));
    }
}
