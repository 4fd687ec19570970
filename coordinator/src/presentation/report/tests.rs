use super::*;
use crate::results::summary::Convergence;
use crate::tests::test_study;

/// Cells with the digits that they lack before the decimal point, which only a style sheet shows, removed.
fn without_pads(html: &str) -> String {
    let mut pieces = html.split("<td data-pad=\"");
    let first = pieces.next().unwrap_or_default().to_owned();
    pieces.fold(first, |text, piece| text + "<td>" + piece.split_once("\">").unwrap().1)
}

/// Every link leads to a place on the page that there is once, or to a file of one of its figures.
fn assert_links(report: &Page, html: &str) {
    let mut links = 0;
    for target in html.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()) {
        links += 1;
        let found = match target.strip_prefix('#') {
            Some(id) => html.matches(&format!("id=\"{id}\"")).count() == 1,
            None => report.figures.iter().any(|figure| {
                [format!("figures/{}.svg", figure.name), format!("figures/{}.csv", figure.name)]
                    .contains(&target.to_owned())
            }),
        };
        assert!(found, "{target}");
    }
    assert!(links > 5 + 2 * report.figures.len(), "{links}");
    for (k, figure) in report.figures.iter().enumerate() {
        let at = html.find(&format!("<figure id=\"{}\"", figure.name)).unwrap();
        let number = format!("<strong>Figure {}.</strong>", k + 1);
        assert!(html[at..].split("</figure>").next().unwrap().contains(&number), "{}: {number}", figure.name);
    }
}

/// Checks that hold for every report: no external reference, figures that are XML and have their numbers, no value that is
/// not a number, no word of Rust for a missing value.
fn assert_sound(report: &Page) {
    // The page without its script.
    let text = report.html(None);
    let html = &match text.split_once("<script") {
        Some((page, _)) => page.to_string() + "</details></main>\n</body>\n</html>",
        None => report.html(None).clone(),
    };
    for outside in ["http", "src=", "@import", "url(", "<link", "//www"] {
        assert!(!report.html(None).contains(outside), "{outside}");
    }
    for outside in ["onclick", " style=\""] {
        assert!(!html.contains(outside), "{outside}");
    }
    assert_links(report, html);
    let words: Vec<&str> = html.split(|c: char| !c.is_ascii_alphanumeric()).collect();
    for bad in ["NaN", "nan", "None", "inf", "Some", "null"] {
        assert!(!words.contains(&bad), "{bad}");
    }
    for figure in &report.figures {
        let name = &figure.name;
        assert!(html.contains(&format!("<figure id=\"{name}\"")), "{name}");
        let mut lines = figure.csv.lines();
        let columns = lines.next().unwrap().split(',').count();
        assert!(columns >= 3 && lines.count() > 1, "{name}: {}", figure.csv);
        assert!(!figure.csv.contains("NaN") && !figure.csv.contains("inf"), "{name}");
        let alone = page::standalone(figure);
        let document = roxmltree::Document::parse(&alone).unwrap_or_else(|error| panic!("{name}: {error}"));
        let root = document.root_element();
        assert!(
            root.has_tag_name(("http://www.w3.org/2000/svg", "svg")) && root.has_attribute("viewBox"),
            "{name}"
        );
        assert!(!alone.contains("NaN") && !alone.contains("inf\""), "{name}");
    }
    // HTML that closes what it opens: the body is well-formed XML too, but for the elements that have no end.
    let body = &html[html.find("<body>").unwrap()..html.find("</html>").unwrap()];
    let body = body.replace("<br>", "<br/>").replace("aria-label=\"instant of the cycle\">", "/>");
    let body = body.replace("aria-label=\"life of the bores\">", "/>");
    roxmltree::Document::parse(&body).unwrap();
}

fn names(report: &Page) -> Vec<&str> {
    report.figures.iter().map(|figure| figure.name.as_str()).collect()
}

#[test]
fn a_whole_study_has_every_figure_and_its_lives() {
    let input = test_study::report_input();
    let report = render(&input, true);
    assert_sound(&report);
    let mut expected = vec!["reliability", "drawing", "first-failure", "history-wear", "history-asymmetry"];
    expected.extend(["sensitivity-wear", "sensitivity-asymmetry", "sobol-wear", "sobol-asymmetry"]);
    expected.extend(["parallel-coordinates", "mechanism", "predicted-wear", "predicted-asymmetry"]);
    expected.extend(["learning-reliability", "parts-of-interval"]);
    // What is not folded: goal of 15 figures.
    let body = report.html(None).split_once("<details class=\"appendix\">").unwrap().0.to_owned();
    assert_eq!((body.matches("<figure id=").count(), expected.len()), (15, 15));
    expected.extend(["weibull-paper", "lognormal-paper"]);
    expected.extend([
        "distribution-wear",
        "cumulative-wear",
        "distribution-asymmetry",
        "cumulative-asymmetry",
    ]);
    expected.extend(["bore-1", "bore-2", "bore-3", "bore-4", "bore-5", "bore-6"]);
    expected.extend(["orbit-1", "orbit-2", "orbit-3", "orbit-4", "orbit-5", "orbit-6"]);
    expected.extend(["joint-forces", "angles", "angular-velocities"]);
    expected.extend(["difference-angular-velocity-difference", "joint-forces-worn"]);
    assert_eq!(names(&report), expected);
    let html = without_pads(&report.html(None)).replace('\u{a0}', " ");
    for text in [
        "Hingewise",
        "<h2>What was studied</h2>",
        "SHA-256 of <code>scene.toml</code>",
        "<strong>Table 1.</strong> Lives",
        "All checkpoints: <code>reliability.csv</code>.",
        "Most frequent failure: wear (max wear depth reaching 30 µm)",
        "64 000 cycles",
        "68 000 cycles",
        "seed 20260101",
        "coordinator run --scene flapping-wing --workers auto --out study",
        "six &lt; seven &amp; more",
        "the bound of 200000 steps per cycle was reached",
        "local-hertz",
        "stayed below 0.006",
        "nominal at 72 000 cycles",
        "<td>0.250 µm</td>",
        "wear depth 0.8 %, at most",
        "every response is off by its stated error in the same direction",
        "<th>R wear (95 %)</th>",
        "<td>0.100 r/min</td>",
        "1 of 216 simulations gave no result and are excluded; up to an estimated 0.4 % of the population, near these, cannot be simulated: R is extrapolated there, and its intervals contain both extremes, that all or none of these points fail",
        "First cause of these failures: 5",
        "cross-validation of the surrogates: wear Q<sup>2</sup> = 0.9700",
        "thin lines: after 12 000, 24 000, 36 000, 48 000, 60 000.",
        "predicted by the surrogates for a population of 100 000 mechanisms",
        "<td>R = 0.99</td>",
        "Q2 = 0.9900",
        "Wear: by 62 000 cycles, when 1.4 % of the population have failed",
        "largest eccentricity: first cycle 24.0 µm, last cycle 24.0 µm",
        "<code>scene.toml</code>",
    ] {
        assert!(html.contains(text), "{text}");
    }
}

/// Cautions come from many places; the page makes sentences of all of them.
#[test]
fn issue_a_caution_began_in_lower_case_and_had_no_full_stop() {
    let mut input = test_study::report_input();
    input.summary.control_points = vec![crate::results::summary_rows::ControlPointsRow {
        output: "asymmetry".into(),
        unit: "r/min".into(),
        cycles: 66_000,
        value: 24.58,
        with_twice: 26.37,
        with_four_times: 34.39,
        error: 19.6,
        converges: false,
        stated: true,
    }];
    let written = ReportInput::of_one(&input.scene, input.summary.clone(), input.nominal.clone());
    input.notes = written.notes;
    input.notes.push("ends with one already.".into());
    let html = render(&input, true).html(None);
    let cautions: Vec<&str> = html.split("<strong>Caution:</strong> ").skip(1).collect();
    assert!(cautions.len() >= 3, "{}", cautions.len());
    for caution in cautions {
        let text = caution.split("</p>").next().unwrap();
        assert!(
            text.starts_with(char::is_uppercase) && text.ends_with('.') && !text.ends_with(".."),
            "{text}"
        );
    }
    assert!(html.contains("</strong> Asymmetry does not converge with the number of control points"));
}

#[test]
fn the_sentences_carry_the_numbers_of_the_curves() {
    let input = test_study::report_input();
    let text = words::sentences(&input).join(" ").replace('\u{a0}', " ");
    assert!(
        text.contains(
            "216 simulations (1 without a result), 96 of them placed by learning, represent a population"
        ),
        "{text}"
    );
    assert!(text.contains("total time 3 min 41 s"), "{text}");
}

#[test]
fn issue_the_report_said_nothing_of_the_jobs_asked_for() {
    let mut input = test_study::report_input();
    let said = |input: &ReportInput| render(input, true).html(None).contains("at most 4 at a time");
    assert!(!said(&input));
    let system = "Slurm".to_owned();
    input.summary.scale = Some(crate::results::summary::ScaleRow { system, most: 4, asked: 9, failed: 2 });
    assert!(said(&input) && render(&input, true).html(None).contains("Slurm was asked for 9 jobs"));
}

/// A page that is sent by mail and opened at once.
#[test]
fn a_report_of_thirty_variables_and_two_hundred_samples_is_small() {
    let report = render(&test_study::report_with_samples(), true);
    assert_sound(&report);
    let size = report.html(None).len();
    assert!(size < 1_500_000, "{size} bytes");
    // Every chart names its axes for the script that shows values, and the script is there once.
    let charts = report.figures.iter().filter(|figure| figure.drawing.axes.is_some()).count();
    assert!(charts > 15 && report.html(None).matches(" data-axes=\"").count() == charts, "{charts}");
    assert_eq!(report.html(None).matches("svg[data-axes]").count(), 1);
}

#[test]
fn the_same_input_gives_the_same_text() {
    let input = test_study::report_input();
    let text = || render(&input, true).html(None);
    assert_eq!(text(), text());
}

#[test]
fn a_study_without_optional_results_is_reported() {
    let mut input = test_study::report_input();
    input.nominal = None;
    input.distributions.clear();
    input.stated.clear();
    input.summary.surrogates.clear();
    input.summary.lives.clear();
    input.summary.reliability.iter_mut().for_each(|row| row.parts.clear());
    input.summary.curves.clear();
    input.summary.sensitivity.clear();
    input.summary.sobol.clear();
    input.summary.first_failure.clear();
    input.summary.failures = crate::results::summary::Failures::default();
    input.summary.moments.clear();
    input.summary.workers.clear();
    input.summary.convergence = Convergence::default();
    input.failures.clear();
    input.samples.clear();
    input.summary.predictions.clear();
    input.summary.failure_points.clear();
    input.meta.settings = serde_json::Value::Null;
    input.meta.command.clear();
    let report = render(&input, true);
    assert_sound(&report);
    assert_eq!(names(&report), ["reliability"]);
    assert!(!render(&input, false).html(None).contains("figures/"));
    assert!(report.html(None).contains("The nominal evaluation has no first cycle."));
    assert!(report.html(None).contains("The simulations state no numerical errors."));
    for said in [
        "Every evaluation has a result.",
        "The study stored no most probable failures.",
        "The study stored no predictions of its surrogates.",
    ] {
        assert!(report.html(None).contains(said), "{said}");
    }
    input.summary.method = "monte-carlo".into();
    assert!(render(&input, true).html(None).contains("there are no surrogates."));
}

/// Old campaigns, whose evaluations lack the bores over life and the last cycle, are reported as well.
#[test]
fn the_report_of_an_old_campaign_names_what_is_missing() {
    let mut input = test_study::report_input();
    let nominal = input.nominal.as_mut().unwrap();
    nominal.worn = None;
    nominal.first_cycle.as_mut().unwrap().motion.clear();
    let report = render(&input, true);
    assert_sound(&report);
    let found = names(&report);
    assert!(found.contains(&"bore-6") && found.contains(&"joint-forces"));
    for missing in ["mechanism", "orbit-1", "joint-forces-worn", "difference-angular-velocity-difference"] {
        assert!(!found.contains(&missing), "{missing}");
    }
    for said in [
        "The nominal evaluation does not include the motion of every body.",
        "this campaign stores the bores at the end of life only",
        "The nominal evaluation does not include the motion of journals and bushings.",
        "The nominal evaluation has no last cycle.",
    ] {
        assert!(report.html(None).contains(said), "{said}");
    }
    assert!(!report.html(None).contains("id=\"motion\""));
}

#[test]
fn one_limit_state_needs_no_total() {
    let mut input = test_study::report_input();
    input.scene.limit_states.truncate(1);
    input.summary.limit_states.truncate(1);
    for row in &mut input.summary.reliability {
        row.reliability.remove("asymmetry");
        row.standard_error.remove("asymmetry");
        let wear = row.reliability["wear"];
        row.reliability.insert("total".into(), wear);
    }
    let report = render(&input, true);
    assert_sound(&report);
    assert!(report.html(None).contains("The mechanism fails by wear"));
    assert!(!report.html(None).contains("asymmetry-"));
    let html = without_pads(&report.html(None)).replace('\u{a0}', " ");
    assert!(html.contains("R wear (95 %)") && !html.contains("R total (95 %)"));
}

#[test]
fn values_that_are_not_numbers_become_dashes() {
    let mut input = test_study::report_input();
    for row in &mut input.summary.reliability {
        row.standard_error.values_mut().for_each(|error| *error = f64::NAN);
    }
    input.summary.reliability[40].reliability.insert("wear".into(), f64::NAN);
    for row in &mut input.summary.sensitivity {
        row.d_pf_d_std = f64::NAN;
        row.scaled.d_pf_d_std = f64::INFINITY;
    }
    for round in &mut input.summary.convergence.rounds {
        round.min_u = f64::INFINITY;
        round.cov_pf = f64::NAN;
    }
    let nominal = input.nominal.as_mut().unwrap();
    nominal.joints[0].wear_depth.fill(f64::NAN);
    nominal.histories[0].fill(f64::NAN);
    nominal.first_cycle.as_mut().unwrap().bodies[0].angle.fill(f64::NAN);
    assert_sound(&render(&input, true));
}

#[test]
fn nothing_fails_and_nothing_at_all() {
    let mut input = test_study::report_input();
    for row in &mut input.summary.reliability {
        row.reliability.values_mut().for_each(|r| *r = 1.0);
    }
    input.summary.lives.clear();
    input.summary.curves.clear();
    input.summary.first_failure.clear();
    let report = render(&input, true);
    assert_sound(&report);
    assert!(report.html(None).contains("No limit state is reached within the life studied."));
    // Neither "1.0000 ± 0.0000" nor any other certainty.
    assert!(!report.html(None).contains("± 0.0000") && !report.html(None).contains("± 0<"), "a certainty");
    input.summary.reliability.clear();
    assert_sound(&render(&input, true));
}

/// Writes the report; if `HINGEWISE_REPORT_SAMPLE` names a folder, it is kept there for inspection.
#[test]
fn page_and_figures_are_written_from_the_campaign_file_alone() {
    let temporary = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("HINGEWISE_REPORT_SAMPLE").map(PathBuf::from);
    let dir = kept.as_deref().unwrap_or(temporary.path());
    let study = tempfile::tempdir().unwrap();
    drop(test_study::campaign(study.path()));
    let campaign = CampaignFile::open(study.path()).unwrap();
    let input = ReportInput::from_campaign(&campaign, &test_study::scene()).unwrap().unwrap();
    assert_eq!((input.work.evaluations, input.failures.len()), (11, 1));
    let path = write(dir, &input).unwrap();
    let report = render(&input, true);
    assert_eq!(std::fs::read_to_string(path).unwrap(), report.html(None));
    for figure in &report.figures {
        let text = std::fs::read_to_string(dir.join("figures").join(format!("{}.svg", figure.name))).unwrap();
        assert_eq!(text, page::standalone(figure));
        let numbers =
            std::fs::read_to_string(dir.join("figures").join(format!("{}.csv", figure.name))).unwrap();
        assert_eq!(numbers, figure.csv);
    }
}

#[test]
fn a_delivered_study_has_every_file_and_they_can_be_rewritten() {
    let dir = tempfile::tempdir().unwrap();
    let mut campaign = test_study::campaign(dir.path());
    let study = test_study::study();
    let mut broken = study.summary.clone();
    broken.convergence.rounds[0].min_u = f64::INFINITY;
    assert!(deliver(&mut campaign, &test_study::scene(), &broken, &[]).is_err());
    let page = deliver(&mut campaign, &test_study::scene(), &study.summary, &study.distributions).unwrap();
    let names = [
        "summary.json",
        "reliability.csv",
        "samples.csv",
        "scene.toml",
        "report.html",
        "figures/reliability.svg",
        "figures/reliability.csv",
    ];
    let read = || names.map(|name| std::fs::read_to_string(dir.path().join(name)).unwrap());
    let first = read();
    names.iter().for_each(|name| std::fs::remove_file(dir.path().join(name)).unwrap());
    drop(campaign);
    let campaign = CampaignFile::open(dir.path()).unwrap();
    assert_eq!(write_all(&campaign, &test_study::scene(), dir.path(), &[]).unwrap(), Some(page));
    assert_eq!(read(), first);
}

#[test]
fn an_unfinished_study_has_no_report_yet() {
    let dir = tempfile::tempdir().unwrap();
    let meta = test_study::campaign(&dir.path().join("finished")).meta.clone();
    let scene = test_study::scene();
    let campaign = CampaignFile::create(&dir.path().join("new"), &meta, &scene).unwrap();
    assert_eq!(ReportInput::from_campaign(&campaign, &scene).unwrap(), None);
}
