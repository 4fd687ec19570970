//! Plans and comparisons with the real `coordinator`: `test-plan`, `weibull`, and `run --variants`.

use crate::{coordinator, json, refused};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value}"))
}

#[test]
fn plans_of_textbooks() {
    let plan = |more: &[&str]| {
        let line = ["test-plan", "--reliability", "0.99", "--at", "50000", "--json"];
        json(&[&line[..], more].concat())
    };
    // ln 0.1 / ln 0.99 = 229.1; with one and two failures 388 and 531 (tables of the binomial distribution).
    let units: Vec<f64> =
        plan(&[])["plans"].as_array().unwrap().iter().map(|plan| number(&plan["units"])).collect();
    assert_eq!(units, [230.0, 388.0, 531.0]);
    // Twice the life with shape 2 counts as four lives; 58 units need twice the life.
    let longer = plan(&["--shape", "2", "--length", "100000", "--allowed", "0", "--inspect-every", "25000"]);
    assert_eq!(number(&longer["plans"][0]["units"]), 58.0);
    // R0^(58 x^2) at the beginning of every quarter, x = 0, 0.5, 1, 1.5 lives.
    let running: f64 = [0.0, 0.5, 1.0, 1.5].iter().map(|x: &f64| 0.99_f64.powf(58.0 * x * x)).sum();
    let mean = number(&longer["plans"][0]["mean_cycles"]);
    assert!((mean / (25_000.0 * running) - 1.0).abs() < 1e-9, "{mean}");
    let sought = plan(&["--shape", "2", "--units", "58", "--allowed", "0", "--group", "5"]);
    let cycles = number(&sought["plans"][0]["cycles"]);
    assert!((cycles - 50_000.0 * (0.1_f64.ln() / 0.99_f64.ln() / 58.0).sqrt()).abs() < 1.0, "{cycles}");
    assert_eq!(sought["groups"].as_array().unwrap().len(), 6);
    let line = ["test-plan", "--reliability", "0.99", "--at", "50000"];
    for (more, says) in [
        (&["--length", "60000"][..], "--shape"),
        (&["--group", "5"], "--shape"),
        (&["--units", "1", "--shape", "2", "--allowed", "1"], "above the number of allowed failures"),
        (&["--confidence", "100%"], "between 0 and 1"),
        (&["--curve", "wear"], "DIR"),
    ] {
        let message = refused(&[&line[..], more].concat(), 2);
        assert!(message.contains(says), "{more:?}: {message}");
    }
}

#[test]
fn a_study_with_variants_is_a_prior_and_is_compared_with_lives() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (study, file, out) = (crate::finished_study().to_str().unwrap(), at("fleet.csv"), at("weibull"));
    std::fs::write(at("wrong.toml"), "[[variants]]\nname = \"a\"\nset = { \"joints.x.width\" = 1 }\n")
        .unwrap();
    let message = refused(&["run", "four-bar", "--variants", &at("wrong.toml"), "--out", &at("none")], 2);
    assert!(message.contains("wrong.toml:3") && !Path::new(&at("none")).exists(), "{message}");
    let summary = crate::finished_summary();
    let rows = summary["variants"].as_array().unwrap();
    let median =
        |row: usize| ["value", "lower", "upper"].map(|key| number(&rows[row]["changes_of_lives"][2][key]));
    assert_eq!((rows.len(), median(1)), (2, [0.0; 3]), "the study itself");
    let [change, lower, upper] = median(0);
    assert!(change != 0.0 && lower < change && change < upper, "{change} {lower} {upper}");
    assert!(upper - lower < 200.0 && number(&rows[0]["evaluations"]) >= 6.0, "{lower} {upper}");
    let page = std::fs::read_to_string(Path::new(study).join("report.html")).unwrap();
    assert!(page.contains("With 2 variants of the model") && page.contains("Variants of the model"));
    for name in ["variants.svg", "variants.csv"] {
        assert!(Path::new(study).join("figures").join(name).is_file(), "{name}");
    }
    // What is finished is not simulated again.
    let copied = Command::new("cp").args(["-r", study, &at("study")]).status().unwrap();
    let again = coordinator(&["resume", &at("study"), "--workers", "0"]);
    assert!(
        copied.success()
            && again.status.success()
            && String::from_utf8_lossy(&again.stdout).contains("With 2 variants of the model")
    );

    let with_prior = json(&[
        "test-plan",
        study,
        "--reliability",
        "0.99",
        "--at",
        "5000",
        "--prior-units",
        "300",
        "--json",
    ]);
    let plans = with_prior["plans"].as_array().unwrap();
    let plan = plans.iter().find(|plan| number(&plan["cycles"]) == 5000.0).unwrap();
    assert!(number(&with_prior["shape"]) > 5.0 && number(&plan["cycles"]) == 5000.0);
    assert!(number(&plan["with_prior"]["units"]) < number(&plan["units"]));
    assert!(number(&plan["with_prior"]["wrongly_passed"]) <= 0.1);
    assert!(
        refused(&["test-plan", study, "--reliability", "0.99", "--at", "90000"], 2)
            .contains("the study ends at")
    );

    let life = |k: usize| {
        summary["lives"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|l| l["limit_state"] == "total")
            .nth(k)
            .map(|l| number(&l["cycles"]))
            .unwrap()
    };
    let (first, median) = (life(0), life(2));
    let fleet = |factor: f64| {
        let mut text = "unit,cycles,state,mode,from\n".to_owned();
        for k in 0..12 {
            let cycles = factor * (median + (median - first) * 0.4 * (f64::from(k) / 6.0 - 1.0));
            text += &match k % 3 {
                0 => format!("{k},{:.0},running\n", cycles - 50.0),
                1 => format!("{k},{cycles:.0},failed,wear\n"),
                _ => format!("{k},{:.0},interval,wear,{:.0}\n", cycles + 50.0, cycles - 50.0),
            };
        }
        text
    };
    std::fs::write(&file, fleet(1.0)).unwrap();
    let agrees = json(&["weibull", &file, "--study", study, "--out", &out, "--json"]);
    assert_eq!(
        (number(&agrees["failures"]), &agrees["study"]["contradicted"]),
        (8.0, &Value::from(false)),
        "{agrees}"
    );
    for name in ["weibull.html", "weibull.json", "figures/weibull.svg"] {
        assert!(Path::new(&out).join(name).is_file(), "{name}");
    }
    std::fs::write(&file, fleet(0.6)).unwrap();
    let contradicts = json(&["weibull", &file, "--study", study, "--mode", "wear", "--json"]);
    assert_eq!(contradicts["study"]["contradicted"], true, "{contradicts}");
    let evidence = &contradicts["study"];
    assert!(
        number(&evidence["ln_evidence_weibull"]) > number(&evidence["ln_evidence_study"]) + 10.0,
        "{evidence}"
    );
    let text = String::from_utf8(coordinator(&["weibull", &file, "--study", study]).stdout).unwrap();
    assert!(text.contains("The data contradict the study:"), "{text}");
    std::fs::write(&file, "unit,cycles,state\nA,900000,failed\nB,10,gone\n").unwrap();
    let message = refused(&["weibull", &file, "--study", study], 2);
    assert!(message.contains("fleet.csv:2:3") && message.contains("fleet.csv:3:6"), "{message}");
    std::fs::write(&file, "unit,cycles,state\nA,900,failed\nB,10,running\n").unwrap();
    assert!(refused(&["weibull", &file], 2).contains("failures at different lives"));
}
