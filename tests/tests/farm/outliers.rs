//! One value of sixty a hundred times too large, from a program that errs, in whole studies: y = x of N(10, 1) fails from 12 on.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use tests::{program, within};

/// Time limit of a test, on a machine that does other work too.
const MINUTES: Duration = Duration::from_secs(180);

/// Replies with y = x. Evaluation 7 is a hundred times too large, and with `always` every later one of the same sample.
const SCRIPT: &str = r#"
while read -r line; do
    id=${line#*\"id\":}
    id=${id%%,*}
    x=${line#*\"x\":}
    x=${x%%\}*}
    factor=
    if [ "$id" = 7 ] && [ "$1" != never ] && [ ! -e "$2" ]; then
        echo "$x" >"$2"
        factor=e2
    elif [ "$1" = always ] && [ -e "$2" ] && [ "$x" = "$(cat "$2")" ]; then
        factor=e2
    fi
    echo "{\"id\": $id, \"outputs\": {\"y\": [$x$factor]}}"
done
"#;

fn scene(folder: &Path, errs: &str) -> PathBuf {
    let (script, file) = (folder.join("script.sh"), folder.join(format!("{errs}.toml")));
    std::fs::write(&script, SCRIPT).unwrap();
    let text = format!(
        "scene = {{ name = \"outlier\" }}\n\
         simulator = {{ program = [\"sh\", '{}', \"{errs}\", '{}'], timeout = \"60 s\" }}\n\
         outputs = [{{ name = \"y\" }}]\n\
         limit_states = [{{ name = \"large\", output = \"y\", threshold = 12 }}]\n\
         variables = [{{ name = \"x\", mean = 10, std = 1 }}]\n",
        script.display(),
        folder.join(format!("{errs}-sample")).display()
    );
    std::fs::write(&file, text).unwrap();
    file
}

fn coordinator(arguments: &[&str], out: &Path) -> (Value, String) {
    let output = Command::new(program("coordinator")).args(arguments).output().unwrap();
    let log = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{log}");
    (serde_json::from_str(&std::fs::read_to_string(out.join("summary.json")).unwrap()).unwrap(), log)
}

fn study(file: &Path, out: &Path, workers: &str) -> (Value, String) {
    let (file, folder) = (file.to_str().unwrap(), out.to_str().unwrap());
    let run = ["run", file, "--workers", workers, "--initial", "60", "--max-evaluations", "80"];
    coordinator(&[&run[..], &["--seed", "3", "--samples", "20000", "--out", folder]].concat(), out)
}

fn used(summary: &Value) -> Vec<bool> {
    let [row] = &summary["outliers"].as_array().unwrap()[..] else { panic!("{}", summary["outliers"]) };
    let evaluations = row["evaluations"].as_array().unwrap();
    assert_eq!(evaluations[0]["number"], 7);
    assert!(evaluations.iter().all(|one| one["worker"].as_str().unwrap().contains('/')));
    evaluations.iter().map(|one| one["used"].as_bool().unwrap()).collect()
}

#[test]
fn issue_one_value_of_sixty_a_hundred_times_too_large_is_left_out() {
    within(MINUTES, || {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("once");
        let (summary, log) = study(&scene(folder.path(), "once"), &out, "2");
        let (right, _) = study(&scene(folder.path(), "never"), &folder.path().join("never"), "2");
        let right = right["reliability"][0]["total"].as_f64().unwrap();
        assert!((right - 0.97725).abs() < 0.002, "{right}");
        let interval = &summary["reliability"][0]["interval"]["total"];
        let [lower, upper] = ["lower", "upper"].map(|end| interval[end].as_f64().unwrap());
        assert!(lower <= right && right <= upper && upper - lower < 0.02, "{right}: {interval}");
        assert_eq!(used(&summary), [false, true, true]);
        assert!(log.contains("is left out: 2 further evaluations contradict it"), "{log}");
        let report = std::fs::read_to_string(out.join("report.html")).unwrap();
        assert!(report.contains("interquartile ranges from the median of all; left out: evaluation"));
        // Resumed, the study still leaves it out, and evaluates nothing of it again.
        let folder = out.to_str().unwrap();
        let (again, _) = coordinator(&["resume", folder, "--workers", "1", "--samples", "40000"], &out);
        assert_eq!(again["outliers"], summary["outliers"]);
    });
}

#[test]
fn an_extreme_value_that_a_second_evaluation_confirms_is_kept_whatever_the_number_of_workers() {
    within(MINUTES, || {
        let folder = tempfile::tempdir().unwrap();
        let file = scene(folder.path(), "always");
        let curves = ["1", "2"].map(|workers| {
            let out = folder.path().join(workers);
            let (summary, _) = study(&file, &out, workers);
            assert_eq!(used(&summary), [true, true]);
            let samples = std::fs::read_to_string(out.join("samples.csv")).unwrap();
            assert_eq!(samples.lines().filter(|line| line.starts_with("7,")).count(), 1, "{samples}");
            std::fs::read(out.join("reliability.csv")).unwrap()
        });
        assert_eq!(curves[0], curves[1]);
    });
}
