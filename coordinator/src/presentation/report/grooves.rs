//! Evaluations in which a groove of a worn bore was narrower than its journal, counted by joint.

use common::outputs::NarrowGroove;

/// The evaluations of a study in which a joint had such a groove.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GroovedJoint {
    /// Number of evaluations.
    pub evaluations: u64,
    /// Earliest life at which one was there [cycles].
    pub since: u32,
    /// The most open one.
    pub widest: NarrowGroove,
}

/// Adds the grooves of one evaluation to the counts of their joints.
pub(super) fn add(grooved: &mut Vec<GroovedJoint>, grooves: &[NarrowGroove]) {
    for groove in grooves {
        match grooved.iter_mut().find(|joint| joint.widest.joint == groove.joint) {
            Some(known) => {
                known.evaluations += 1;
                known.since = known.since.min(groove.since);
                if groove.open > known.widest.open {
                    known.widest.clone_from(groove);
                }
            }
            None => {
                grooved.push(GroovedJoint { evaluations: 1, since: groove.since, widest: groove.clone() })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grooves_are_counted_by_joint_and_the_most_open_one_is_kept() {
        let groove = |joint: &str, since, open| NarrowGroove {
            joint: joint.into(),
            since,
            angle: 1.0,
            width: 0.2,
            open,
        };
        let mut grooved = vec![];
        for evaluation in [
            vec![groove("a", 4000, 1e-6)],
            vec![],
            vec![groove("a", 2000, 2e-6), groove("b", 8000, 5e-7)],
            vec![groove("a", 3000, 1.5e-6)],
        ] {
            add(&mut grooved, &evaluation);
        }
        let found: Vec<_> = grooved.iter().map(|j| (j.evaluations, j.since, j.widest.open)).collect();
        assert_eq!(found, [(3, 2000, 2e-6), (1, 8000, 5e-7)]);
    }
}
