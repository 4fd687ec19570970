//! The wear step under a frozen contact history: its order, its agreement with many small steps, and that it
//! does not zig-zag however long its blocks are.

use crate::bore::Profile;
use crate::contact::{Contact, Foundation, JointForce, LocalHertz, Surface};
use crate::wear::amounts::{BoreSizes, SurfaceSizes};
use crate::wear::archard::FrozenContacts;
use crate::wear::{
    BoreWearRate, ContactHistory, ContactInstant, NoEquilibrium, WearLaw, WearStep, WearStepFailed,
    WearStepStats,
};
use std::f64::consts::TAU;

pub(super) const SURFACE: Surface = Surface {
    journal_radius: 1.5e-3,
    clearance: 23.5e-6,
    stiffness: 3.264e10,
    damping: 0.0,
    restitution: None,
    friction: 0.0,
    per_friction_speed: 1.0 / 2.4e-3,
    film: 0.0,
};
pub(super) const COEFFICIENT: f64 = 1.288e-13;
pub(super) const WIDTH: f64 = 4e-3;
pub(super) const POINTS: usize = 36;

pub(super) fn foundation() -> Contact {
    Contact::Foundation(Foundation::new(SURFACE, POINTS))
}

/// A cycle like those of the flapping-wing's rods: the load swings through a wide angle and back, grows to 6
/// N on one side and turns round quickly on the other; 9 mm of sliding in the cycle.
fn cycle() -> ContactHistory {
    const SAMPLES: u32 = 300;
    let mut history = ContactHistory::new(1.0, SAMPLES as usize, false);
    for k in 0..SAMPLES {
        let phase = TAU * f64::from(k) / f64::from(SAMPLES);
        let psi = 2.0 + 0.9 * phase.sin() + 0.35 * (2.0 * phase).cos();
        let normal = 3.5 + 2.0 * (phase - 0.7).cos() + 0.5 * (3.0 * phase).sin();
        let penetration = (normal / SURFACE.stiffness).powf(2.0 / 3.0);
        let reach = SURFACE.clearance + penetration;
        let u = [psi.cos(), psi.sin()];
        let sliding = 9e-3 * (1.0 + 0.6 * (phase + 0.4).cos());
        let contact = JointForce { normal, direction: u, penetration, sliding, ..JointForce::default() };
        history.push(1.0 / f64::from(SAMPLES), &ContactInstant::new([reach * u[0], reach * u[1]], &contact));
        history.close_interval();
    }
    history
}

fn rate(contact: &Contact) -> BoreWearRate {
    let mut rate = BoreWearRate::new(
        [COEFFICIENT, 0.0],
        WIDTH,
        contact,
        &Profile::round(SURFACE.journal_radius + SURFACE.clearance, POINTS),
    );
    rate.freeze(&cycle());
    rate
}

/// What a number of blocks came to.
struct Worn {
    depth: Vec<f64>,
    stats: WearStepStats,
}

/// Wears a bore from `start` by `blocks` blocks of `cycles` each.
fn wear(contact: &Contact, start: &[f64], blocks: u32, cycles: f64, tolerance: f64) -> Worn {
    let (mut rate, mut step) = (rate(contact), WearStep::new(POINTS, Some(tolerance)));
    let mut worn = Worn { depth: start.to_vec(), stats: WearStepStats::default() };
    for _ in 0..blocks {
        step.advance(&mut rate, &mut worn.depth, cycles, &[], |_, _| {}, &mut worn.stats)
            .expect("the wear step reaches its tolerance");
    }
    worn
}

/// Depth after explicit jumps from an unworn bore.
fn jump(contact: &Contact, blocks: u32, cycles: f64) -> Vec<f64> {
    let mut rate = rate(contact);
    let (mut depth, mut per_cycle) = (vec![0.0; POINTS], vec![0.0; POINTS]);
    for _ in 0..blocks {
        rate.rate(&depth, &mut per_cycle).expect("the force has an equilibrium");
        depth.iter_mut().zip(&per_cycle).for_each(|(h, r)| *h += cycles * r);
    }
    depth
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// Amplitude of the highest Fourier mode, the one that alternates from point to point.
fn alternating(values: &[f64]) -> f64 {
    let sum: f64 = values.iter().enumerate().map(|(i, v)| if i % 2 == 0 { *v } else { -v }).sum();
    sum / values.len() as f64
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

/// Accepts every sub-step that is stable.
const ANY: f64 = 1e9;

#[test]
fn order_two_is_observed() {
    // From a bore worn for 4000 cycles, 2000 more in 8 to 64 steps. Where the pressure ends within the arc
    // its derivative has kinks, so single halvings scatter about the order.
    let contact = foundation();
    let start = wear(&contact, &[0.0; POINTS], 8, 500.0, 1e-4).depth;
    let after = |steps: u32| wear(&contact, &start, steps, 2000.0 / f64::from(steps), ANY).depth;
    let reference = after(256);
    let errors = [8, 16, 32, 64].map(|steps| distance(&after(steps), &reference));
    println!("errors at 8 to 64 steps [m]: {errors:?}");
    assert!(errors[3] < 1e-6 * largest(&reference));
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.5).contains(&order), "order {order} in {errors:?}");
    }
    let order = (errors[0] / errors[3]).log2() / 3.0;
    assert!((order - 2.0).abs() < 0.2, "order {order}");
}

#[test]
fn blocks_of_any_length_agree_with_small_steps_and_do_not_zig_zag() {
    const LIFE: u32 = 16_000;
    let contact = foundation();
    let zero = [0.0; POINTS];
    let fine = wear(&contact, &zero, LIFE / 50, 50.0, 1e-4).depth;
    let deepest = largest(&fine);
    // How much of the alternating mode is in what a depth has beside the fine one.
    let zigzag = |depth: &[f64]| {
        let beside: Vec<f64> = depth.iter().zip(&fine).map(|(a, b)| a - b).collect();
        alternating(&beside).abs() / deepest
    };
    for cycles in [100, 1000, 4000, 8000] {
        let (blocks, length) = (LIFE / cycles, f64::from(cycles));
        let explicit = jump(&contact, blocks, length);
        for tolerance in [2e-2, 5e-3, 1e-3] {
            let worn = wear(&contact, &zero, blocks, length, tolerance);
            let off = distance(&worn.depth, &fine) / deepest;
            println!(
                "{cycles} cycles at {tolerance}: off {off:.1e}, alternating {:.1e}, {:?}; explicit {:.1e}, {:.1e}",
                zigzag(&worn.depth),
                worn.stats,
                distance(&explicit, &fine) / deepest,
                zigzag(&explicit),
            );
            assert!(off < 0.1 * tolerance, "{cycles} cycles at {tolerance}: {off}");
            assert!(zigzag(&worn.depth) < 0.05 * zigzag(&explicit), "{cycles} cycles at {tolerance}");
            assert_eq!(worn.stats.held, 0);
        }
        if cycles >= 4000 {
            assert!(zigzag(&explicit) > 5e-3, "the explicit jump of {cycles} cycles zig-zags");
        }
    }
}

#[test]
fn following_a_rest_through_a_block_costs_a_few_evaluations() {
    // Newton's method from the equilibrium on the bore of the stage before: one evaluation there and one after each of one or two
    // steps, for samples in groups.
    let mut rate = rate(&foundation());
    let (mut step, mut stats) = (WearStep::new(POINTS, Some(2e-2)), WearStepStats::default());
    let mut depth = vec![0.0; POINTS];
    for _ in 0..8 {
        step.advance(&mut rate, &mut depth, 2000.0, &[], |_, _| {}, &mut stats)
            .expect("the force has an equilibrium");
    }
    let FrozenContacts::Foundation(contacts) = &rate.contacts else { panic!("a foundation") };
    let each = contacts.evaluations as f64 / (stats.stages as f64 * cycle().samples.len() as f64);
    println!("{each} evaluations of the contact per equilibrium, {stats:?}");
    assert!(each > 0.2 && each < 1.2, "{each}");
}

/// The rates of single samples, which have no others to be grouped with.
struct OneByOne(Vec<BoreWearRate>);

impl WearLaw for OneByOne {
    type History = ContactHistory;

    fn freeze(&mut self, history: &ContactHistory) {
        for (rate, sample) in self.0.iter_mut().zip(&history.samples) {
            let mut alone = history.clone();
            alone.clear();
            alone.samples.push(*sample);
            rate.freeze(&alone);
        }
    }

    fn sizes(&self) -> SurfaceSizes {
        WearLaw::sizes(&self.0[0])
    }

    fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), NoEquilibrium> {
        let mut of_one = vec![0.0; rate.len()];
        rate.fill(0.0);
        for one in &mut self.0 {
            one.rate(depth, &mut of_one)?;
            rate.iter_mut().zip(&of_one).for_each(|(sum, one)| *sum += one);
        }
        Ok(())
    }
}

#[test]
fn groups_of_samples_wear_a_bore_as_the_samples_one_by_one() {
    let grouped = wear(&foundation(), &[0.0; POINTS], 8, 2000.0, 1e-3).depth;
    let mut all = OneByOne(vec![rate(&foundation()); cycle().samples.len()]);
    all.freeze(&cycle());
    let (mut step, mut depth) = (WearStep::new(POINTS, Some(1e-3)), vec![0.0; POINTS]);
    for _ in 0..8 {
        step.advance(&mut all, &mut depth, 2000.0, &[], |_, _| {}, &mut WearStepStats::default())
            .expect("the force has an equilibrium");
    }
    let off = distance(&grouped, &depth) / largest(&depth);
    println!("depths with groups are off by {off:.1e}");
    assert!(off < 2e-4, "{off}");
}

#[test]
fn what_a_step_would_give_back_is_held_and_counted() {
    // A rough bore: one long step takes more from the high spots than is there to bear on others before them.
    let rough: Vec<f64> = (0..POINTS).map(|i| 5e-6 * (1.0 + (7.3 * (i * i) as f64).sin())).collect();
    let contact = foundation();
    let mut wearing = vec![0.0; POINTS];
    rate(&contact).rate(&rough, &mut wearing).expect("the force has an equilibrium");
    let worn = wear(&contact, &rough, 1, 8000.0, ANY);
    assert!(worn.depth.iter().zip(&rough).all(|(new, old)| new >= old));
    let still = (0..POINTS).filter(|&i| worn.depth[i] == rough[i] && wearing[i] > 0.0).count();
    assert!(worn.stats.held > 0 && worn.stats.held == still as u64, "{} {still}", worn.stats.held);
    assert!(wearing.contains(&0.0), "points that don't wear at all are not counted");
}

#[test]
fn the_local_law_takes_tight_tolerances_and_keeps_them() {
    // The wear rate has kinks where patches of the contact appear and join: the errors made there are part of the sum that
    // the tolerance bounds.
    let contact = Contact::LocalHertz(LocalHertz { surface: SURFACE });
    let zero = [0.0; POINTS];
    let fine = wear(&contact, &zero, 4, 2000.0, 2e-5).depth;
    for tolerance in [1e-2, 1e-3, 2e-4, 1e-4] {
        let worn = wear(&contact, &zero, 4, 2000.0, tolerance);
        let off = distance(&worn.depth, &fine) / largest(&fine);
        println!("local-hertz at {tolerance}: off {off:.1e}, {:?}", worn.stats);
        assert!(off < tolerance, "{tolerance}: {off}");
    }
}

/// A wear rate that is the same at all points of a bore, as a function of the depth there [m/cycle].
struct Alike(fn(f64) -> f64);

impl WearLaw for Alike {
    type History = ContactHistory;

    fn freeze(&mut self, _history: &ContactHistory) {}

    fn sizes(&self) -> SurfaceSizes {
        let radii = [SURFACE.journal_radius + SURFACE.clearance, SURFACE.journal_radius];
        SurfaceSizes::Bore(BoreSizes { points: POINTS, radii, width: WIDTH })
    }

    fn rate(&mut self, depth: &[f64], rate: &mut [f64]) -> Result<(), NoEquilibrium> {
        rate.iter_mut().zip(depth).for_each(|(rate, depth)| *rate = (self.0)(*depth));
        Ok(())
    }
}

/// Ends of a block of 1000 cycles under this rate, with what it took.
fn block(rate: fn(f64) -> f64) -> (Result<(), WearStepFailed>, WearStepStats) {
    let (mut step, mut stats) = (WearStep::new(POINTS, Some(1e-2)), WearStepStats::default());
    let ended = step.advance(&mut Alike(rate), &mut [0.0; POINTS], 1000.0, &[], |_, _| {}, &mut stats);
    (ended, stats)
}

#[test]
fn issue_a_bore_was_worn_deeper_than_its_radius() {
    assert_eq!(block(|_| 0.7e-6).0, Ok(()));
    let (ended, stats) = block(|_| 0.8e-6);
    let Err(WearStepFailed::TooDeep([depth, bound])) = ended else { panic!("{ended:?}") };
    assert!(depth > bound && bound == 0.5 * (SURFACE.journal_radius + SURFACE.clearance), "{depth} {bound}");
    assert!(stats.stages < 20, "{stats:?}");
}

#[test]
fn issue_a_wear_step_went_on_without_end() {
    // Its rate rises and falls with every few nanometres of depth.
    let (ended, stats) = block(|depth| 1e-9 * (1.0 + 0.9 * (1e9 * depth).sin()));
    assert_eq!(ended, Err(WearStepFailed::TooManyStages));
    assert!(stats.stages > WearStep::MOST_EVALUATIONS && stats.stages < WearStep::MOST_EVALUATIONS + 100);
}
