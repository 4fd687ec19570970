//! Learned correlations, parameters of correlated variables, and limit states that compete, against closed forms.

use super::tests::{WEAR, agrees, learned, study, wear};
use super::*;
use common::random::{standard_normal_cdf, standard_normal_quantile};

/// Measured rates and offsets of ten units: standard normals with a correlation near 0.7.
fn measured() -> Vec<[f64; 2]> {
    let unit = |k: u32| {
        let a = standard_normal_quantile((f64::from(k) + 0.5) / 10.0);
        let b = standard_normal_quantile((f64::from(3 * k % 10) + 0.5) / 10.0);
        [25.0 + 3.0 * a, 2.0 + 0.5 * (0.7 * a + 0.51_f64.sqrt() * b)]
    };
    (0..10).map(unit).collect()
}

/// Standard deviations of the errors of both.
const ERRORS: [f64; 2] = [0.3, 0.05];

fn rows(measured: &[[f64; 2]]) -> String {
    let row = |(k, [rate, offset]): (usize, &[f64; 2])| {
        format!("U{k},,rate,{rate},{}\nU{k},,offset,{offset},{}\n", ERRORS[0], ERRORS[1])
    };
    measured.iter().enumerate().map(row).collect()
}

fn defaults(settings: &mut LearnSettings) {
    *settings = LearnSettings { ranks: false, points: 4000, ..LearnSettings::new(3) };
    settings.units.population = 4000;
}

/// Mean and standard deviation of r with the density of a bivariate normal of the measured values, by quadrature; `prior` is that of r.
fn exact(measured: &[[f64; 2]], prior: impl Fn(f64) -> f64) -> (f64, f64) {
    let (mut total, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for i in 0..4000 {
        let r = (f64::from(i) + 0.5) / 2000.0 - 1.0;
        let [a, b] = [9.0 + ERRORS[0].powi(2), 0.25 + ERRORS[1].powi(2)];
        let c = r * 1.5;
        let determinant = a * b - c * c;
        let log = |[rate, offset]: &[f64; 2]| {
            let (x, y) = (rate - 25.0, offset - 2.0);
            -0.5 * (b * x * x - 2.0 * c * x * y + a * y * y) / determinant - 0.5 * determinant.ln()
        };
        let weight = (measured.iter().map(log).sum::<f64>() + 20.0).exp() * prior(r);
        total += weight;
        sum += weight * r;
        squares += weight * r * r;
    }
    let mean = sum / total;
    (mean, (squares / total - mean * mean).sqrt())
}

#[test]
fn a_correlation_of_two_measured_dimensions_is_that_of_the_bivariate_normal() {
    let data = measured();
    let stated = |r: f64| (-0.5 * ((r - 0.2) / 0.15).powi(2)).exp();
    for (prior, (mean, std)) in [("", exact(&data, |_| 1.0)), (",0.2,0.15", exact(&data, stated))] {
        let text = format!("population,,correlation(offset rate){prior}\n{}", rows(&data));
        let report = learned(study(WEAR, wear), &text, defaults).unwrap();
        let [found] = &report.parameters[..] else { panic!("{:?}", report.parameters) };
        assert_eq!(found.name, "correlation(rate,offset)");
        assert!(agrees(found, mean, std, report.effective_size), "{found:?}; exact {mean} {std}");
        let scene = report.scene_of_one_more(study(WEAR, wear).0.nominal());
        assert_eq!(scene.correlations.len(), 1);
        assert!((scene.correlations[0].coefficient - found.mean).abs() < 1e-12);
    }
}

#[test]
fn the_mean_of_a_correlated_variable_has_the_conjugate_closed_form() {
    // The study knows the correlation r and all of the offsets: the rates scatter by s sqrt(1 - r^2) around what the offsets let expect.
    let r = 0.7;
    let text =
        format!("{WEAR}correlations = [{{ variables = [\"rate\", \"offset\"], coefficient = {r} }}]\n");
    let data: Vec<[f64; 2]> = measured().iter().map(|[rate, offset]| [rate + 1.5, *offset]).collect();
    let fleet: String = (0..data.len())
        .map(|k| format!("U{k},,rate,{},0.01\nU{k},,offset,{},0.002\n", data[k][0], data[k][1]))
        .collect();
    let report = learned(study(&text, wear), &format!("population,,rate.mean\n{fleet}"), defaults).unwrap();
    let n = data.len() as f64;
    let mean = data.iter().map(|[rate, offset]| rate - r * 6.0 * (offset - 2.0)).sum::<f64>() / n;
    let std = 3.0 * (1.0_f64 - r * r).sqrt() / n.sqrt();
    let [found] = &report.parameters[..] else { panic!("{:?}", report.parameters) };
    assert!(agrees(found, mean, std, report.effective_size), "{found:?}; exact {mean} {std}");
}

/// Two wears that compete, each proportional to another rate.
const COMPETING: &str = r#"
scene = { name = "competing" }
simulator = { program = ["closure"] }
life = { cycles = 3000, checkpoint_every = 100 }
outputs = [{ name = "wear", unit = "um" }, { name = "play", unit = "um" }]
limit_states = [
    { name = "worn", output = "wear", threshold = 30 },
    { name = "loose", output = "play", threshold = 30 },
]
variables = [
    { name = "rate", distribution = "lognormal", mean = 25, std = 3 },
    { name = "opening", distribution = "lognormal", mean = 24, std = 3 },
]
"#;

#[test]
fn limit_states_and_first_failures_have_their_closed_form() {
    // What is not known is known nearly: the bounds are those of the curves.
    let fleet = "population,,rate.mean,25,0.01\nA,,rate,25,3\n";
    let report = learned(study(COMPETING, |x, n| x[0] * n / 1000.0), fleet, defaults).unwrap();
    let log = |mean: f64| {
        let variance = (3.0_f64 / mean).powi(2).ln_1p();
        (mean.ln() - 0.5 * variance, variance)
    };
    let [(rate, s2), (opening, t2)] = [log(25.0), log(24.0)];
    let first = standard_normal_cdf((rate - opening) / (s2 + t2).sqrt());
    let [worn, loose] = &report.confident.limit_states[..] else { panic!("two limit states") };
    assert_eq!([&*worn.limit_state, &*loose.limit_state], ["worn", "loose"]);
    let last = [worn, loose].map(|own| *own.first_failures.last().unwrap());
    assert!(
        (last[0].median - first).abs() < 0.02 && (last[0].mean + last[1].mean - 1.0).abs() < 1e-9,
        "{last:?} {first}"
    );
    assert!(last[0].at_least <= last[0].median && last[0].interval[0] <= last[0].interval[1], "{last:?}");
    for (own, (m, variance)) in [(worn, (rate, s2)), (loose, (opening, t2))] {
        let exact = 1000.0 * (30.0_f64.ln() - m - 1.281_552 * variance.sqrt()).exp();
        let life = own.lives[1].median.unwrap();
        assert!((life / exact - 1.0).abs() < 0.01, "{life} {exact}");
    }
    let text = answer(&report).text();
    assert!(text.contains("fails first by") && text.contains("Lives by each limit state"), "{text}");
}
