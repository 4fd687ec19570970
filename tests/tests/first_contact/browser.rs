//! Reports in a real browser: no script fails, every figure is drawn and legible, nothing sticks out, it opens at once.

use crate::tutorial::followed;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{PoisonError, RwLock};
use tests::skipped;

/// Largest size of a report [bytes].
const LARGEST: u64 = 5 << 20;

/// A browser that measures its time has no other beside it.
static BROWSERS: RwLock<()> = RwLock::new(());

/// Longest time to open one [ms].
const LONGEST: f64 = 1000.0;

/// Collects what goes wrong from the first line on.
const WATCH: &str = "<script>var wrong = [];
addEventListener('error', (event) => wrong.push(String(event.message)));
addEventListener('unhandledrejection', (event) => wrong.push(String(event.reason)));</script>";

/// Says what is seen once the page is open, and of the mechanism when its slider is moved too.
const PROBE: &str = "<script>addEventListener('load', () => {
  document.querySelectorAll('details').forEach((one) => { one.open = true; });
  const box = (node) => { const b = node.getBoundingClientRect(); return [b.left, b.right, b.width, b.height]; };
  const figures = [...document.querySelectorAll('figure')].map((figure) => {
    const svg = figure.querySelector('svg');
    const texts = [...svg.querySelectorAll('text')].filter((text) => text.textContent.trim());
    const [left, right, width, height] = box(svg);
    return {
      id: figure.id, width, height, left, right,
      shapes: svg.querySelectorAll('path, polyline, polygon, rect, circle, line').length,
      outside: texts.filter((t) => box(t)[0] < left - 1 || box(t)[1] > right + 1).map((t) => t.textContent.trim()),
      letters: Math.min(...texts.map((text) => box(text)[3])),
    };
  });
  const body = () => document.querySelector('[data-body]')?.getAttribute('transform');
  const seen = {
    wrong, figures, opened: performance.now(), width: innerWidth, page: document.documentElement.scrollWidth,
    paper: getComputedStyle(document.body).backgroundColor, ink: getComputedStyle(document.body).color,
    fetched: performance.getEntriesByType('resource').map((entry) => entry.name), before: body(),
    button: document.querySelector('.moving .controls button')?.textContent,
  };
  const place = document.querySelector('.moving .controls input');
  if (place) { place.value = 30; place.dispatchEvent(new Event('input')); }
  seen.after = body();
  seen.then = document.querySelector('.moving .controls button')?.textContent;
  const said = parent.document.createElement('pre');
  said.id = 'seen';
  said.hidden = true;
  said.textContent = encodeURIComponent(JSON.stringify(seen));
  parent.document.body.append(said);
});</script>";

/// A Chromium on the path.
fn browser() -> Option<PathBuf> {
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    names.iter().find_map(|name| folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file()))
}

/// `%41` and the like turned back.
fn decoded(text: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = text.bytes();
    while let Some(byte) = rest.next() {
        let hex = |c: Option<u8>| (c.unwrap_or(b'0') as char).to_digit(16).unwrap_or(0) as u8;
        bytes.push(if byte == b'%' { 16 * hex(rest.next()) + hex(rest.next()) } else { byte });
    }
    String::from_utf8(bytes).unwrap()
}

/// What is seen of a page in a frame of this width; `None`, visibly, without a browser.
fn seen(page: &Path, width: u32, options: &[&str]) -> Option<Value> {
    let _beside = BROWSERS.read().unwrap_or_else(PoisonError::into_inner);
    opened(page, width, options)
}

/// The same without a look at other browsers. The browser's own window has a least width, above that of a phone.
fn opened(page: &Path, width: u32, options: &[&str]) -> Option<Value> {
    let Some(browser) = browser() else {
        skipped("reports in a browser", "no Chromium on the path");
        return None;
    };
    let html = std::fs::read_to_string(page).unwrap();
    let html = html.replacen("<head>", &format!("<head>{WATCH}"), 1).replacen(
        "</body>",
        &format!("{PROBE}</body>"),
        1,
    );
    let folder = tempfile::tempdir().unwrap();
    let watched = folder.path().join("page.html");
    let frame = html.replace('&', "&amp;").replace('"', "&quot;");
    let host = format!(
        "<!DOCTYPE html><html><head><meta name=\"color-scheme\" content=\"light dark\"></head><body style=\"margin:0\">\
         <iframe style=\"border:0;width:{width}px;height:20000px\" srcdoc=\"{frame}\"></iframe></body></html>"
    );
    std::fs::write(&watched, host).unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg("--window-size=1600,20000")
        .args(options)
        .arg("--dump-dom")
        .arg(format!("file://{}", watched.display()))
        .output()
        .expect("the browser starts");
    let dom = String::from_utf8(output.stdout).unwrap();
    let said =
        dom.split_once("<pre id=\"seen\" hidden=\"\">").and_then(|(_, rest)| rest.split_once("</pre>"));
    let (said, _) =
        said.unwrap_or_else(|| panic!("no word from the page\n{}", String::from_utf8_lossy(&output.stderr)));
    Some(serde_json::from_str(&decoded(said)).unwrap())
}

/// Nothing failed, nothing was fetched, nothing sticks out, every figure is drawn and its words are inside and legible.
fn assert_sound(seen: &Value, figures: usize, width: u32) {
    assert_eq!(seen["wrong"], Value::Array(vec![]));
    assert_eq!(seen["fetched"], Value::Array(vec![]));
    assert_eq!(seen["width"], width);
    assert!(seen["page"].as_u64().unwrap() <= u64::from(width), "the page is {} wide", seen["page"]);
    let drawn = seen["figures"].as_array().unwrap();
    assert!(drawn.len() >= figures, "{} figures", drawn.len());
    for figure in drawn {
        let number = |key: &str| figure[key].as_f64().unwrap();
        assert!(number("width") > 150.0 && number("height") > 80.0, "{figure}");
        assert!(number("left") >= 0.0 && number("right") <= f64::from(width), "{figure}");
        assert!(number("shapes") > 4.0, "{figure}");
        assert_eq!(figure["outside"], Value::Array(vec![]), "{figure}");
        assert!(number("letters") >= 9.0, "{figure}");
    }
}

fn are_drawn_whole(width: u32) {
    for (page, figures) in [("first/report.html", 15), ("press/report.html", 20), ("compare.html", 3)] {
        let Some(seen) = seen(&followed().join(page), width, &[]) else { return };
        assert_sound(&seen, figures, width);
    }
}

#[test]
fn reports_are_drawn_whole_on_a_phone() {
    are_drawn_whole(400);
}

#[test]
fn reports_are_drawn_whole_on_a_desk() {
    are_drawn_whole(1600);
}

#[test]
fn a_report_opens_at_once_and_is_small() {
    let page = followed().join("press/report.html");
    let size = std::fs::metadata(&page).unwrap().len();
    assert!(size < LARGEST, "{size} bytes");
    // The machine may be busy: the quickest of some says what the page takes.
    let _alone = BROWSERS.write().unwrap_or_else(PoisonError::into_inner);
    let mut times: Vec<f64> = Vec::new();
    while times.len() < 8 && times.iter().all(|time| *time >= LONGEST) {
        let Some(seen) = opened(&page, 1600, &[]) else { return };
        times.push(seen["opened"].as_f64().unwrap());
    }
    assert!(times.iter().any(|time| *time < LONGEST), "{times:?} ms");
}

#[test]
fn the_mechanism_moves_unless_motion_is_not_wanted() {
    let page = followed().join("press/report.html");
    let Some(moving) = seen(&page, 1600, &[]) else { return };
    assert_eq!(moving["wrong"], Value::Array(vec![]));
    let still = seen(&page, 1600, &["--force-prefers-reduced-motion"]).unwrap();
    assert_eq!((moving["button"].as_str(), still["button"].as_str()), (Some("Pause"), Some("Play")));
    // The slider stops the motion and puts the mechanism where it says, whether it moved before or not.
    for page in [&moving, &still] {
        assert_eq!(page["then"], "Play");
        assert!(page["before"].is_string() && page["before"] != page["after"], "{}", page["after"]);
    }
    assert_eq!(moving["after"], still["after"]);
}

#[test]
fn a_dark_system_gets_a_dark_page() {
    let page = followed().join("press/report.html");
    let Some(light) = seen(&page, 1600, &["--blink-settings=preferredColorScheme=1"]) else { return };
    let dark = seen(&page, 1600, &["--blink-settings=preferredColorScheme=0"]).unwrap();
    assert_eq!([&light["paper"], &light["ink"]], ["rgb(255, 255, 255)", "rgb(27, 31, 36)"]);
    assert_eq!([&dark["paper"], &dark["ink"]], ["rgb(20, 24, 29)", "rgb(232, 235, 238)"]);
    assert_sound(&dark, 20, 1600);
}
