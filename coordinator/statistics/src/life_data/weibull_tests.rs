use super::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha12Rng;

/// Failures of both modes and suspensions of 38 shock absorbers [km]: Meeker, Escobar (1998), table C.2.
const SHOCK_FAILED: [f64; 11] =
    [6700., 9120., 12200., 13150., 14300., 17520., 20100., 20900., 22700., 26510., 27490.];
const SHOCK_RUNNING: [f64; 27] = [
    6950., 7820., 8790., 9660., 9820., 11310., 11690., 11850., 11880., 12140., 12870., 13330., 13470.,
    14040., 17540., 17890., 18420., 18960., 18980., 19410., 20100., 20150., 20320., 23490., 27410., 27890.,
    28100.,
];

/// Ball bearings [10^6 revolutions]: Lieblein, Zelen (1956), as in Lawless (2003), who has shape 2.10 and scale 81.9.
const BEARINGS: [f64; 23] = [
    17.88, 28.92, 33., 41.52, 42.12, 45.6, 48.48, 51.84, 51.96, 54.12, 55.56, 67.8, 68.64, 68.64, 68.88,
    84.12, 93.12, 98.64, 105.12, 105.84, 127.92, 128.04, 173.4,
];

fn data(failed: &[f64], running: &[f64], intervals: &[(f64, f64)]) -> Vec<UnitLife> {
    let failed = failed.iter().map(|t| UnitLife::Failed(*t));
    let running = running.iter().map(|t| UnitLife::Running(*t));
    failed.chain(running).chain(intervals.iter().map(|(a, b)| UnitLife::Interval(*a, *b))).collect()
}

/// Values, Fisher and likelihood-ratio bounds of the shape, the scale and the lives at R = 0.9 and 0.99.
struct Reference {
    data: Vec<UnitLife>,
    confidence: f64,
    ln_likelihood: f64,
    rows: [[f64; 5]; 4],
}

/// The maxima are those of the Python packages `lifelines` 0.30.3 (intervals too) and `reliability` 0.9.0, the Fisher bounds those of
/// the latter; the likelihood-ratio bounds are by Nelder-Mead, Brent's minimisation of the profile and Brent's root in SciPy.
fn references() -> [Reference; 4] {
    [
        Reference {
            data: data(&SHOCK_FAILED, &SHOCK_RUNNING, &[]),
            confidence: 0.95,
            ln_likelihood: -123.993_943_936,
            rows: [
                [3.160_579_6, 2.008_860_3, 4.972_602_4, 1.898_653_2, 4.771_430_3],
                [27_717.362, 22_347.069, 34_378.207, 23_329.116, 37_958.806],
                [13_599.704, 10_221.696, 18_094.058, 9_371.184_1, 17_290.739],
                [6_466.160_8, 3_607.742_9, 11_589.303, 2_855.654_3, 10_170.832],
            ],
        },
        Reference {
            data: data(&BEARINGS, &[], &[]),
            confidence: 0.9,
            ln_likelihood: -113.691_290_932,
            rows: [
                [2.102_058_9, 1.625_346_3, 2.718_590_9, 1.593_920_8, 2.674_591_4],
                [81.878_335, 68.886_492, 97.320_412, 68.257_072, 97.392_842],
                [28.069_415, 19.386_995, 40.640_237, 18.078_316, 38.689_995],
                [9.178_215_1, 4.835_754_4, 17.420_163, 4.218_820_7, 15.826_325],
            ],
        },
        // Abernethy (2008), The New Weibull Handbook: five failures, three suspensions.
        Reference {
            data: data(&[90., 96., 30., 49., 82.], &[100., 45., 10.], &[]),
            confidence: 0.9,
            ln_likelihood: -25.131_040_236,
            rows: [
                [3.017_018_6, 1.612_705_3, 5.644_181_3, 1.491_688_6, 5.331_235_9],
                [87.956_293, 68.922_239, 112.246_93, 67.802_600, 122.915_96],
                [41.718_677, 24.528_895, 70.955_011, 18.502_610, 61.547_492],
                [19.146_244, 7.113_268_4, 51.534_488, 3.996_949_8, 38.588_263],
            ],
        },
        Reference {
            data: data(
                &[310., 420.],
                &[250., 600., 600., 800.],
                &[(0., 200.), (200., 400.), (400., 500.), (400., 500.), (500., 700.)],
            ),
            confidence: 0.9,
            ln_likelihood: -26.073_013_685,
            rows: [
                [2.057_192_5, 1.176_207_9, 3.598_038_2, 1.079_139_9, 3.377_798_3],
                [605.153_07, 445.514_96, 821.993_15, 449.689_17, 927.510_50],
                [202.670_05, 106.240_56, 386.624_00, 75.938_477, 329.155_05],
                [64.673_516, 18.599_457, 224.880_95, 9.060_798_7, 158.596_05],
            ],
        },
    ]
}

#[test]
fn fits_and_bounds_are_those_of_other_programs() {
    for Reference { data, confidence, ln_likelihood, rows } in references() {
        let fit = WeibullFit::new(&data).unwrap();
        assert!((fit.ln_likelihood - ln_likelihood).abs() < 1e-8, "{fit:?}");
        let found = [
            fit.shape(confidence),
            fit.life((-1.0_f64).exp(), confidence),
            fit.life(0.9, confidence),
            fit.life(0.99, confidence),
        ];
        for (FitBounds { value, fisher, likelihood_ratio }, expected) in found.iter().zip(rows) {
            let [lower, upper] = likelihood_ratio.map(Option::unwrap);
            for (found, expected) in [*value, fisher[0], fisher[1], lower, upper].iter().zip(expected) {
                // The references' differences of second order have 1e-5 of their digits.
                assert!((found / expected - 1.0).abs() < 2e-5, "{found} {expected}");
            }
        }
    }
}

#[test]
fn the_band_of_r_is_that_of_the_lives() {
    let fit = WeibullFit::new(&data(&SHOCK_FAILED, &SHOCK_RUNNING, &[])).unwrap();
    // At the scale ln(-ln R) has the deviation of shape ln(scale): R falls to exp(-exp(-+z sd)).
    let [lower, upper] = fit.reliability(fit.law.scale, 0.95);
    let fisher = fit.life((-1.0_f64).exp(), 0.95).fisher;
    let half = fit.law.shape * (fisher[1] / fit.law.scale).ln();
    assert!((upper - (-(-half).exp()).exp()).abs() < 1e-9 && (lower - (-half.exp()).exp()).abs() < 1e-9);
}

#[test]
fn one_life_that_explains_all_failures_determines_no_distribution() {
    for (failed, running, intervals) in [
        (&[][..], &[100.0, 200.0][..], &[][..]),
        (&[500.0], &[100.0, 500.0], &[]),
        (&[500.0, 500.0], &[], &[(400.0, 600.0)]),
        (&[], &[300.0], &[(200.0, 400.0), (300.0, 500.0)]),
        // Failures only before the suspensions, as of a shape that goes to 0.
        (&[], &[200.0], &[(0.0, 100.0)]),
    ] {
        let refused = WeibullFit::new(&data(failed, running, intervals));
        assert_eq!(refused, Err(NoMaximum { failed: failed.len() + intervals.len() }), "{failed:?}");
    }
    assert!(WeibullFit::new(&data(&[500.0], &[900.0], &[])).is_ok());
}

/// 300 fleets of 20 units, of which about 60 % are suspended: the likelihood-ratio bounds of B10 hold in the stated share.
#[test]
fn bounds_hold_as_often_as_stated() {
    let law = WeibullLaw { shape: 3.0, scale: 1000.0 };
    let b10 = law.life_at(0.9);
    let mut rng = ChaCha12Rng::seed_from_u64(4);
    let (mut held, total) = (0, 300);
    for _ in 0..total {
        let unit = |_| {
            let life = law.life_at(rng.random_range(1e-9..1.0));
            let age: f64 = rng.random_range(500.0..1100.0);
            if life > age { UnitLife::Running(age) } else { UnitLife::Failed(life) }
        };
        let fleet: Vec<UnitLife> = (0..20).map(unit).collect();
        let Ok(fit) = WeibullFit::new(&fleet) else { continue };
        let [lower, upper] = fit.life(0.9, 0.9).likelihood_ratio;
        held += usize::from(lower.is_none_or(|l| l <= b10) && upper.is_none_or(|u| b10 <= u));
    }
    // 90 % of 300 are 270 with a standard error of 5.2; with few failures the bounds are somewhat narrow.
    assert!((252..=286).contains(&held), "{held}");
}
