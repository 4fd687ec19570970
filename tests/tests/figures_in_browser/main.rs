//! Reports in a browser: letters of figures that do not cover each other, large enough, and with enough contrast, on narrow and wide
//! screens, in light and in dark; and the sliders, which answer as `what-if` does.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use tests::deployed::if_installed;
use tests::program;

/// Widths of the screens [CSS pixels].
const WIDTHS: [u32; 3] = [400, 1000, 1600];

/// Least size of letters [CSS pixels], and least contrast by WCAG 2.
const LEAST_SIZE: f64 = 11.0;
const LEAST_CONTRAST: f64 = 4.5;

/// Small studies of four built-in scenes.
const STUDIES: [(&str, &[&str]); 4] = [
    ("four-bar", &["--accuracy", "draft", "--initial", "20", "--max-evaluations", "30"]),
    ("slider-crank", &["--levels", "draft", "--initial", "8", "--max-evaluations", "10"]),
    ("flapping-wing", &["--levels", "draft", "--initial", "12", "--max-evaluations", "14"]),
    ("flapping-wing-tolerances", &["--accuracy", "draft", "--method", "monte-carlo", "--samples", "4"]),
];

/// Loads the page in frames of every width in light and in dark, and measures each: letters of figures that cover each other, the
/// smallest letters, and the least contrasts of texts and of the colours of figures against the paper.
const MEASURE: &str = include_str!("measure.js");

/// The first browser that is installed.
fn browser() -> Option<&'static str> {
    let found = ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|name| Command::new(name).arg("--version").output().is_ok());
    if found.is_none() {
        if_installed("figures in a browser", &mut Command::new("chromium"));
    }
    found
}

/// The report of one of the small studies, which is run once.
fn report(place: usize) -> &'static Path {
    static REPORTS: [OnceLock<PathBuf>; 4] = [const { OnceLock::new() }; 4];
    REPORTS[place].get_or_init(|| {
        let (scene, options) = STUDIES[place];
        let study = Path::new(env!("CARGO_TARGET_TMPDIR")).join("figures").join(scene);
        let _ = std::fs::remove_dir_all(&study);
        let mut command = Command::new(program("coordinator"));
        let output =
            command.args(["run", scene, "-q"]).args(options).arg("--out").arg(&study).output().unwrap();
        assert!(output.status.success(), "{scene}: {}", String::from_utf8_lossy(&output.stderr));
        study.join("report.html")
    })
}

/// What a browser measures on a page.
fn measured(browser: &str, page: &Path, folder: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(page).unwrap();
    // Within a script, `</` would end it.
    let text = serde_json::to_string(&text).unwrap().replace("</", "<\\/").replace("<!--", "<\\!--");
    let widths = serde_json::to_string(&WIDTHS).unwrap();
    let around = format!(
        "<!DOCTYPE html><html><head><meta charset=\"utf-8\"></head><body><script>const WIDTHS = {widths}, page = {text};{MEASURE}</script></body></html>"
    );
    let result = run_page(browser, &around, ("", &["--virtual-time-budget=60000"]), folder);
    result.as_array().unwrap().clone()
}

/// The result that the scripts of a page, opened at `fragment` with these options, write into its element `result`.
fn run_page(browser: &str, page: &str, (fragment, options): (&str, &[&str]), folder: &Path) -> Value {
    let path = folder.join("measure.html");
    std::fs::write(&path, page).unwrap();
    let mut command = Command::new(browser);
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1700,1300"]);
    command.args(options).arg("--dump-dom");
    command.arg(format!("--user-data-dir={}", folder.join("profile").display()));
    command.arg(format!("file://{}{fragment}", path.display()));
    let output = command.output().unwrap();
    let dom = String::from_utf8_lossy(&output.stdout);
    let result = dom.rsplit_once("<pre id=\"result\">").and_then(|(_, rest)| rest.split("</pre>").next());
    let Some(result) = result else { panic!("no result: {}", String::from_utf8_lossy(&output.stderr)) };
    let result =
        result.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&").replace("&nbsp;", " ");
    serde_json::from_str(&result).unwrap_or_else(|error| panic!("{error}: {result}"))
}

/// Ten settings of the sliders: their places from -100 to 100.
const SETTINGS: &str = r#"[
  {"wear_coefficient.mean": 40}, {"wear_coefficient.mean": -30}, {"wear_coefficient.std": 100},
  {"wear_coefficient.std": -100, "load_torque.mean": 50}, {"wear.threshold": 25}, {"wear.threshold": -20},
  {"clearance_crank.mean": 60}, {"clearance_crank.std": 70, "friction.mean": -60}, {"friction.std": 100, "load_torque.std": 100},
  {"load_torque.mean": -30, "wear.threshold": 10, "wear_coefficient.std": 30}]"#;

/// Puts the sliders to every setting and notes the answer, the command that the page states, and the time of the redraw; before that what
/// the address of the page has set.
const SLIDE: &str = include_str!("slide.js");

#[test]
fn sliders_answer_as_what_if_within_its_intervals() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = report(0);
    let text = std::fs::read_to_string(page).unwrap();
    let about = text.split("id=\"surrogates\">").nth(1).unwrap().split("</script>").next().unwrap().len();
    assert!(
        text.len() < 2_000_000 && about < 1_000_000,
        "{} bytes, {about} of them for the sliders",
        text.len()
    );
    let probe = format!("<script>const SETTINGS = {SETTINGS};{SLIDE}</script></body>");
    let found = run_page(
        browser,
        &text.replace("</body>", &probe),
        // Time that passes, to measure it.
        ("#what-if=friction.mean:-20;wear.threshold:10", &[]),
        folder.path(),
    );
    assert_eq!(found["restored"], serde_json::json!(["wear.threshold:10", "friction.mean:-20"]));
    let answers = found["answers"].as_array().unwrap();
    assert_eq!(answers[0]["link"], "#what-if=wear_coefficient.mean:40");
    let mut redraws = Vec::new();
    for found in answers {
        let command = found["command"].as_str().unwrap();
        let mut what_if = Command::new(program("coordinator"));
        what_if.arg("what-if").arg(page.parent().unwrap()).arg("--json");
        for set in command.split("--set '").skip(1) {
            what_if.args(["--set", set.trim().trim_end_matches('\'')]);
        }
        let output = what_if.output().unwrap();
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
        let expected: Value = serde_json::from_slice(&output.stdout).unwrap();
        let curve = found["answer"].as_array().unwrap().last().unwrap();
        let times = curve["times"].as_array().unwrap();
        let is_within = |value: f64, interval: &Value| {
            value >= interval["lower"].as_f64().unwrap() - 1e-4
                && interval["upper"].as_f64().is_none_or(|upper| value <= upper + 1e-4)
        };
        for row in expected["reliability"].as_array().unwrap() {
            let place = times.iter().position(|time| time.as_f64() == row["cycles"].as_f64()).unwrap();
            let shown = curve["reliability"][place].as_f64().unwrap();
            assert!(is_within(shown, &row["interval"]["total"]), "{command}: {shown} against {row}");
        }
        let lives = expected["lives"].as_array().unwrap().iter();
        for (row, shown) in
            lives.filter(|row| row["limit_state"] == "total").zip(curve["lives"].as_array().unwrap())
        {
            assert!(is_within(shown.as_f64().unwrap(), &row["interval"]), "{command}: {shown} against {row}");
        }
        redraws.push(found["milliseconds"].as_f64().unwrap());
    }
    redraws.sort_by(f64::total_cmp);
    let [median, longest] = [redraws[redraws.len() / 2], redraws[redraws.len() - 1]];
    println!("{} bytes, {about} for the sliders; redraw {median:.0} ms, longest {longest:.0} ms", text.len());
    // On an idle machine every redraw takes less than 50 ms; on a busy one a single redraw may wait.
    assert!(median < 200.0, "{redraws:?} ms");
}

#[test]
fn letters_of_a_four_bar_are_apart_large_and_clear() {
    letters_are_clear(0);
}

#[test]
fn letters_of_a_slider_crank_are_apart_large_and_clear() {
    letters_are_clear(1);
}

#[test]
fn letters_of_the_drive_are_apart_large_and_clear() {
    letters_are_clear(2);
}

#[test]
fn letters_of_the_drive_with_tolerances_are_apart_large_and_clear() {
    letters_are_clear(3);
}

/// Checks the figures of the report of one study.
fn letters_are_clear(place: usize) {
    let Some(browser) = browser() else { return };
    assert!(
        MEASURE.contains(&format!("px < {}", LEAST_SIZE - 0.01))
            && MEASURE.contains(&format!("c < {LEAST_CONTRAST}"))
    );
    let folder = tempfile::tempdir().unwrap();
    let mut faults = Vec::new();
    let scene = STUDIES[place].0;
    let all = measured(browser, report(place), folder.path());
    assert_eq!(all.len(), 2 * WIDTHS.len(), "{scene}");
    for one in all {
        let at = format!("{scene} at {} px, dark {}", one["width"], one["dark"]);
        assert!(one["texts"].as_u64().unwrap() > 100, "{at}: {one}");
        for key in ["overlaps", "small", "faint"] {
            let found = one[key].as_array().unwrap();
            let shown = found.iter().take(5);
            faults.extend(shown.map(|what| format!("{at}, {key} ({}): {what}", found.len())));
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}
