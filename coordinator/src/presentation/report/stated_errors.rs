//! The numerical errors that the evaluations of a campaign state of their outputs.

/// Stated errors of one output over all evaluations, at one checkpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedAt {
    /// Checkpoint of the errors [cycles].
    pub cycles: u32,
    /// Median over the evaluations [SI unit of the output].
    pub typical: f64,
    /// Largest of any evaluation [SI unit of the output].
    pub largest: f64,
}

/// Adds the errors of an evaluation to those of all, by output and checkpoint, one value per evaluation `(outputs)(m)(n)`; one that states no
/// errors adds nothing.
pub fn add_errors(all: &mut Vec<Vec<Vec<f64>>>, errors: &[Vec<f64>]) {
    all.resize_with(errors.len().max(all.len()), Vec::new);
    for (all, errors) in all.iter_mut().zip(errors) {
        all.resize_with(errors.len().max(all.len()), Vec::new);
        all.iter_mut().zip(errors).for_each(|(all, error)| all.push(*error));
    }
}

/// Typical and largest of these errors per output and checkpoint `(outputs)(m,)`.
pub fn over_life(cycles: &[u32], all: Vec<Vec<Vec<f64>>>) -> Vec<Vec<StatedAt>> {
    let statistics = |(cycles, mut errors): (&u32, Vec<f64>)| {
        errors.sort_unstable_by(f64::total_cmp);
        let largest = *errors.last()?;
        Some(StatedAt { cycles: *cycles, typical: errors[errors.len() / 2], largest })
    };
    all.into_iter().map(|all| cycles.iter().zip(all).filter_map(statistics).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::test_study;

    #[test]
    fn typical_is_the_median_and_largest_the_largest() {
        let mut evaluation = test_study::report_input().nominal.unwrap();
        let mut stated = vec![];
        for error in [3.0, 1.0, 2.0, 9.0, 1.5] {
            evaluation.errors.iter_mut().for_each(|errors| errors.fill(error));
            evaluation.errors[1][7] = 0.5 * error;
            add_errors(&mut stated, &evaluation.errors);
        }
        evaluation.errors.clear();
        add_errors(&mut stated, &evaluation.errors);
        let over_life = over_life(&evaluation.cycles, stated);
        assert_eq!((over_life.len(), over_life[0].len()), (2, 72));
        assert_eq!(over_life[0][3], StatedAt { cycles: 4000, typical: 2.0, largest: 9.0 });
        assert_eq!(over_life[1][7], StatedAt { cycles: 8000, typical: 1.0, largest: 4.5 });
    }
}
