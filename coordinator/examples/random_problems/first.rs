//! The first family. Six of twelve problems belong to the two hard classes, islands and kinks, in either half.

use super::course::{Course, Growth};
use super::draw::{direction, directions, log_uniform, mixture, normals, phase, rng_range, scaled};
use super::family::Shape;
use super::problem::Class;
use super::response::{Response, Term};
use common::random::{standard_normal_cdf, standard_normal_quantile};
use rand::{Rng, RngExt};
use rand_distr::{Distribution as _, StandardNormal};

/// Classes in turn.
pub const TURN: [Class; 12] = [
    Class::Islands,
    Class::Kink,
    Class::Fourier,
    Class::Islands,
    Class::Kink,
    Class::System,
    Class::Islands,
    Class::Kink,
    Class::Lines,
    Class::History,
    Class::Jump,
    Class::Fourier,
];
/// A problem of a class of this family.
pub fn shape(rng: &mut impl Rng, class: Class) -> Shape {
    match class {
        Class::Kink => kink(rng),
        Class::Fourier => fourier(rng),
        Class::Lines => lines(rng),
        Class::System => system(rng),
        Class::Jump => jump(rng),
        Class::History => history(rng),
        _ => islands(rng),
    }
}

/// Products and sums of sines in two or three variables on a slope.
fn islands(rng: &mut impl Rng) -> Shape {
    let d = if rng.random_bool(0.6) { 2 } else { 3 };
    let fastest = if d == 2 { 4.0 } else { 2.5 };
    let wave = |rng: &mut _| rng_range(rng, 1.2, fastest);
    let product = |rng: &mut _| {
        let axes = directions(rng, d, d);
        Term::Product(axes.iter().map(|w| (scaled(w, wave(rng)), phase(rng))).collect())
    };
    let mut terms = Vec::new();
    let form = rng.random_range(0..3);
    if form != 1 {
        terms.push(product(rng));
    }
    if form != 0 {
        let count = rng.random_range(d..=d + 2);
        for w in directions(rng, d, count) {
            let amplitude = rng.random_range(0.3..1.0);
            terms.push(Term::Wave { amplitude, frequency: scaled(&w, wave(rng)), phase: phase(rng) });
        }
    }
    let slope = rng.random_range(0.0..0.3);
    terms.push(Term::Plane(scaled(&direction(rng, d), slope)));
    Shape {
        variables: normals(rng, d),
        modes: vec![Response::Sum(terms)],
        course: Course::Once,
        wanted: log_uniform(rng, 0.005, 0.1),
        centres: vec![],
    }
}

/// A line of `gentle` slope up to a kink along `w`, from where it rises to 1 at `beta`.
fn broken_line(w: &[f64], gentle: f64, kink: f64, beta: f64) -> Response {
    let at_kink = gentle * kink;
    let slope = (1.0 - at_kink) / (beta - kink) - gentle;
    Response::Sum(vec![Term::Plane(scaled(w, gentle)), Term::Hinge { slope, direction: w.to_vec(), kink }])
}

/// Rare events behind kinks: one or two branches that fail beyond a kink 2 to 4 standard deviations out, and a
/// straight branch that shows from the mean and fails later than they do.
fn kink(rng: &mut impl Rng) -> Shape {
    let d = [2, 2, 2, 3, 3, 4, 6][rng.random_range(0..7)];
    let wanted = log_uniform(rng, 1e-7, 1e-3);
    let beta = -standard_normal_quantile(wanted);
    let place = |rng: &mut _, beta: f64| (beta - rng_range(rng, 0.2, 1.2)).clamp(2.0, 4.0);
    let axes = directions(rng, d, 2);
    let straight_at = beta + rng.random_range(0.3..1.5);
    let straight = Response::Sum(vec![Term::Plane(scaled(&axes[0], 1.0 / straight_at))]);
    let gentle = rng.random_range(-0.1..0.3) / beta;
    let mut centres = vec![scaled(&axes[0], straight_at)];
    let response = match rng.random_range(0..4) {
        // One branch, or two of different distance in opposite directions.
        form @ 0..=1 => {
            let mut parts = vec![straight];
            for (k, sign) in [1.0, -1.0].into_iter().enumerate().take(form + 1) {
                let beta = beta + if k == 0 { 0.0 } else { rng.random_range(0.0..0.5) };
                let w = scaled(&axes[1], sign);
                let at = place(rng, beta);
                parts.push(broken_line(&w, gentle, at, beta));
                centres.push(scaled(&w, beta));
            }
            Response::Largest(parts)
        }
        // The straight branch and the steep one add up.
        2 => {
            let at = place(rng, beta);
            let slope = 1.0 / (beta - at);
            let nearest = (1.0 + slope * at) / (slope.powi(2) + straight_at.powi(-2));
            let centre = axes[0].iter().zip(&axes[1]).map(|(a, b)| nearest * (a / straight_at + slope * b));
            centres.push(centre.collect());
            let hinge = Term::Hinge { slope, direction: axes[1].clone(), kink: at };
            Response::Sum(vec![Term::Plane(scaled(&axes[0], 1.0 / straight_at)), hinge])
        }
        // A branch that needs two broken lines at once: P_f = Phi(-beta_1) Phi(-beta_2) of that branch.
        _ => {
            let far = beta * rng.random_range(0.8..0.95);
            let near = -standard_normal_quantile((wanted / standard_normal_cdf(-far)).clamp(1e-6, 0.45));
            let across = scaled(&axes[0], -1.0);
            let at = place(rng, far).min(far - 0.2);
            let both = Response::Least(vec![
                broken_line(&axes[1], gentle, at, far),
                broken_line(&across, gentle, near - 0.5, near),
            ]);
            centres.push(axes[1].iter().zip(&across).map(|(a, b)| far * a + near.max(0.0) * b).collect());
            Response::Largest(vec![straight, both])
        }
    };
    Shape { variables: normals(rng, d), modes: vec![response], course: Course::Once, wanted, centres }
}

/// Waves of random frequencies with the given length scale, of variance 1 together.
fn features(rng: &mut impl Rng, d: usize, length: f64, count: usize) -> Vec<Term> {
    let amplitude = (2.0 / count as f64).sqrt();
    let mut one = || {
        let frequency = (0..d).map(|_| {
            let omega: f64 = StandardNormal.sample(rng);
            omega / length
        });
        let frequency = frequency.collect();
        Term::Wave { amplitude, frequency, phase: phase(rng) }
    };
    (0..count).map(|_| one()).collect()
}

/// Random Fourier features: on a plane with rare failures, or alone.
fn fourier(rng: &mut impl Rng) -> Shape {
    let d = rng.random_range(2..=6);
    let rare = rng.random_bool(0.35);
    // With more variables as many lengths across the population as in two.
    let length = log_uniform(rng, 0.2, 2.0) * (d as f64 / 2.0).sqrt();
    let mut terms = features(rng, d, length, 30);
    if !rare {
        let wanted = log_uniform(rng, 2e-3, 0.2);
        let variables = mixture(rng, d);
        return Shape {
            variables,
            modes: vec![Response::Sum(terms)],
            course: Course::Once,
            wanted,
            centres: vec![],
        };
    }
    let wanted = log_uniform(rng, 1e-6, 2e-3);
    let beta = -standard_normal_quantile(wanted);
    let (w, share) = (direction(rng, d), rng.random_range(1.0..4.0));
    terms.push(Term::Plane(scaled(&w, share)));
    let variables = normals(rng, d);
    let centres = vec![scaled(&w, beta), scaled(&w, 0.7 * beta)];
    Shape { variables, modes: vec![Response::Sum(terms)], course: Course::Once, wanted, centres }
}

/// A sum of random hinge functions on a plane.
fn lines(rng: &mut impl Rng) -> Shape {
    let d = rng.random_range(2..=8);
    let slope = rng.random_range(0.0..1.0);
    let mut terms = vec![Term::Plane(scaled(&direction(rng, d), slope))];
    for _ in 0..rng.random_range(2..=d + 2) {
        let (slope, kink) = (rng.random_range(-1.5..2.0), rng.random_range(-1.0..2.0));
        terms.push(Term::Hinge { slope, direction: direction(rng, d), kink });
    }
    let wanted = log_uniform(rng, 1e-3, 0.2);
    let variables = mixture(rng, d);
    Shape { variables, modes: vec![Response::Sum(terms)], course: Course::Once, wanted, centres: vec![] }
}

/// Series and parallel systems of curved limit states; half of the series systems have two limit states.
fn system(rng: &mut impl Rng) -> Shape {
    let d = rng.random_range(2..=15);
    let parallel = rng.random_bool(0.35);
    let wanted = if parallel { log_uniform(rng, 1e-3, 0.1) } else { log_uniform(rng, 1e-6, 0.2) };
    let beta = -standard_normal_quantile(wanted);
    let count = if parallel { 2 } else { rng.random_range(2..=4) };
    let (mut parts, mut centres) = (Vec::new(), Vec::new());
    for w in directions(rng, d, count) {
        let distance = if parallel { 0.0 } else { beta.max(0.5) + rng.random_range(0.0..0.6) };
        let curvature = rng.random_range(-0.05..0.1);
        let bent = Term::Parabola { curvature, direction: direction(rng, d) };
        centres.push(scaled(&w, distance));
        // The limit is the same for all parts: nearer ones are raised by a steeper slope.
        let slope = if parallel { rng.random_range(0.5..1.5) } else { beta.max(0.5) / distance };
        parts.push(Response::Sum(vec![Term::Plane(scaled(&w, slope)), bent]));
    }
    if parallel || wanted > 5e-3 {
        centres.clear();
    }
    let modes = if parallel {
        vec![Response::Least(parts)]
    } else if rng.random_bool(0.5) {
        let second = parts.split_off(1);
        vec![parts.remove(0), Response::Largest(second)]
    } else {
        vec![Response::Largest(parts)]
    };
    let variables = if wanted > 5e-3 { mixture(rng, d) } else { normals(rng, d) };
    Shape { variables, modes, course: Course::Once, wanted, centres }
}

/// Smooth Fourier features with a jump.
fn jump(rng: &mut impl Rng) -> Shape {
    let d = rng.random_range(2..=4);
    let length = rng.random_range(1.0..2.0) * (d as f64 / 2.0).sqrt();
    let mut terms = features(rng, d, length, 30);
    terms.push(Term::Plane(direction(rng, d)));
    let (height, edge) = (rng.random_range(0.3..1.5), rng.random_range(-0.5..2.0));
    terms.push(Term::Jump { height, direction: direction(rng, d), edge });
    let wanted = log_uniform(rng, 0.005, 0.2);
    let variables = mixture(rng, d);
    Shape { variables, modes: vec![Response::Sum(terms)], course: Course::Once, wanted, centres: vec![] }
}

/// Growth over the life, monotone as wear is, or with an oscillation.
fn history(rng: &mut impl Rng) -> Shape {
    let d = rng.random_range(2..=5);
    let start = Response::Sum(vec![Term::Plane(scaled(&direction(rng, d), rng.random_range(0.05..0.2)))]);
    let mut log_rate = vec![Term::Plane(scaled(&direction(rng, d), rng.random_range(0.1..0.4)))];
    for _ in 0..3 {
        let (frequency, amplitude) = (scaled(&direction(rng, d), rng.random_range(0.5..1.5)), 0.08);
        log_rate.push(Term::Wave { amplitude, frequency, phase: phase(rng) });
    }
    let monotone = rng.random_bool(0.5);
    let growth = Growth {
        checkpoints: rng.random_range(5..=15),
        log_rate: Response::Sum(log_rate),
        exponent: rng.random_range(0.5..1.5),
        amplitude: if monotone { 0.0 } else { rng.random_range(0.1..0.4) },
        periods: rng.random_range(0.5..2.0),
        phase: Response::Sum(vec![Term::Plane(scaled(&direction(rng, d), rng.random_range(0.02..0.15)))]),
    };
    let wanted = log_uniform(rng, 0.01, 0.6);
    Shape {
        variables: mixture(rng, d),
        modes: vec![start],
        course: Course::Growth(growth),
        wanted,
        centres: vec![],
    }
}
