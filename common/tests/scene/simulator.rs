//! Studies of an external simulator: how they are read, and their faults.

use common::random::Distribution;
use common::scene::{
    Condition, CycleProgram, CycleTier, Fails, FileExchange, JointKind, Life, OutputKind, Program,
    SceneSource, SimulatorKind,
};

const BEAM: &str = include_str!("beam.toml");

pub fn beam(from: &str, to: &str) -> String {
    assert!(BEAM.contains(from), "no \"{from}\"");
    BEAM.replacen(from, to, 1)
}

/// The faults of a scene, one per line.
fn faults(text: &str) -> String {
    SceneSource::parse(text, "beam.toml").expect_err("a faulty scene").to_string()
}

#[test]
fn a_study_of_a_program_is_read() {
    let source = SceneSource::parse(BEAM, "beam.toml").unwrap();
    let scene = source.nominal();
    let simulator = scene.simulator.as_ref().unwrap();
    assert_eq!(simulator.timeout, 120.0);
    let command = vec!["python3".to_owned(), "beam.py".to_owned()];
    assert_eq!(
        simulator.kind,
        SimulatorKind::Program(Program { command, folder: ".".into(), exchange: None, fmu: None })
    );
    assert!(scene.bodies.is_empty() && scene.joints.is_empty() && scene.loads.is_empty());
    assert_eq!(scene.life.checkpoints(), [100, 200, 300]);
    let kinds: Vec<_> = scene.outputs.iter().map(|output| output.kind.clone()).collect();
    assert_eq!(
        kinds,
        [
            OutputKind::External { unit: "mm".into(), single: false },
            OutputKind::External { unit: String::new(), single: true }
        ]
    );
    let limits: Vec<_> = scene.limit_states.iter().map(|l| (l.output, l.threshold, l.fails)).collect();
    assert_eq!(limits, [(0, 12.5, Fails::Above), (1, -0.5, Fails::Below)]);
    let [span, temperature] = source.variables() else { panic!() };
    assert_eq!(span.distribution, Distribution::truncated_normal(1.0, 0.01, 0.97, 1.03).unwrap());
    assert_eq!((span.unit.as_str(), temperature.unit.as_str()), ("mm", "K"));
    assert!(span.changes.is_empty());
    assert_eq!(source.means(), [1.0, 293.0]);
    assert!(source.unused_parameters.is_empty());
}

#[test]
fn files_and_a_version_are_read() {
    let keys =
        "version = \"2024.1\"\nresults = \"out/r.txt\"\ntemplates = [\"beam.inp\"]\nfiles = [\"mesh\"]";
    let text = beam("timeout = \"2 min\"", keys);
    let scene = SceneSource::parse(&text, "beam.toml").unwrap().nominal().clone();
    let simulator = scene.simulator.unwrap();
    assert_eq!(simulator.version, "2024.1");
    let SimulatorKind::Program(program) = simulator.kind else { panic!() };
    let [results, template, file] = ["out/r.txt", "beam.inp", "mesh"].map(str::to_owned);
    let exchange = FileExchange { results, templates: vec![template], files: vec![file] };
    assert_eq!(program.exchange, Some(exchange));
}

#[test]
fn an_fmu_is_run_with_its_mapping() {
    let keys =
        "fmu = \"beam.fmu\"\nmap = { span = \"L\", pin = { angle = \"phi\" }, \"*.force_x\" = \"*_fx\" }";
    let read =
        |keys: &str| SceneSource::parse(&beam("program = [\"python3\", \"beam.py\"]", keys), "beam.toml");
    let simulator = read(keys).unwrap().nominal().simulator.clone().unwrap();
    let SimulatorKind::Program(program) = simulator.kind else { panic!() };
    assert_eq!(program.fmu.as_deref(), Some("beam.fmu"));
    let (command, mut map) = (&program.command[..4], program.command[4..].to_vec());
    assert_eq!(command, ["python3", "-m", "hingewise.fmu", "beam.fmu"]);
    map.sort();
    assert_eq!(map, ["*.force_x=*_fx", "pin.angle=phi", "span=L"]);
    for (more, said) in [
        ("map = { span = 3 }", "simulator.map"),
        ("map = \"span\"", "a table of variables of the FMU by name"),
        ("levels = [\"a\", \"b\"]", "an FMU has none"),
        ("templates = [\"a\"]", "simulator.templates: unknown key"),
        ("umbridge = \"http://127.0.0.1:1\"", "more than one of program, fmu and umbridge"),
    ] {
        let found = read(&format!("fmu = \"beam.fmu\"\n{more}")).unwrap_err().to_string();
        assert!(found.contains(said), "{more}: {found}");
    }
}

#[test]
fn without_a_life_there_is_one_checkpoint() {
    let text = beam("[life]\ncycles = 300\ncheckpoint_every = 100\n", "");
    let life = SceneSource::parse(&text, "beam.toml").unwrap().nominal().life;
    assert_eq!(life, Life { period: 0.0, cycles: 1, checkpoint_every: 1, settle_cycles: 0, turn_of: None });
}

#[test]
fn a_study_of_a_server_is_read() {
    let server = "umbridge = \"http://127.0.0.1:4242/\"\nmodel = \"posterior\"\nconfig = { level = 2 }\ntimeout = \"1 h\"";
    let text = beam("program = [\"python3\", \"beam.py\"]\ntimeout = \"2 min\"", server);
    let scene = SceneSource::parse(&text, "beam.toml").unwrap().nominal().clone();
    let SimulatorKind::UmBridge(model) = scene.simulator.unwrap().kind else { panic!() };
    assert_eq!((model.url.as_str(), model.model.as_str()), ("http://127.0.0.1:4242", "posterior"));
    assert_eq!(model.config["level"].as_integer(), Some(2));
}

#[test]
fn inputs_are_set_by_name_in_their_unit() {
    let source = SceneSource::parse(BEAM, "beam.toml").unwrap();
    let setting = source.parse_setting("span=990 mm").unwrap();
    assert_eq!(source.sample_with(&[setting]).unwrap(), [0.99, 293.0]);
    let setting = source.parse_setting("temperature=300").unwrap();
    assert_eq!(source.sample_with(&[setting]).unwrap(), [1.0, 300.0]);
    let error = source.parse_setting("span=3").unwrap_err().to_string();
    assert!(error.contains("expected a length"), "{error}");
    let error = source.sample_with(&[("parameters.length".into(), 1.0)]).unwrap_err().to_string();
    assert!(
        error.contains("there is no variable \"parameters.length\"") && error.contains("span"),
        "{error}"
    );
}

#[test]
fn every_slip_is_named() {
    for (from, to, parts) in [
        ("program = [\"python3\", \"beam.py\"]\n", "", &["simulator.program", "e.g. umbridge ="][..]),
        ("program = [\"python3\", \"beam.py\"]", "program = []", &["simulator.program", "is empty"]),
        (
            "program = [\"python3\", \"beam.py\"]",
            "program = \"beam.py\"",
            &["simulator.program", "a list of words"],
        ),
        (
            "timeout = \"2 min\"",
            "umbridge = \"http://127.0.0.1:1\"",
            &["simulator", "more than one of program, fmu and umbridge"],
        ),
        ("timeout = \"2 min\"", "timeout = \"2 mm\"", &["simulator.timeout", "expected a time"]),
        ("timeout = \"2 min\"", "time = \"2 min\"", &["simulator.time", "did you mean \"timeout\"?"]),
        ("timeout = \"2 min\"", "config = { a = 1 }", &["simulator.config", "unknown key"]),
        ("timeout = \"2 min\"", "version = 3", &["simulator.version", "a text"]),
        ("timeout = \"2 min\"", "templates = [\"a\"]", &["simulator.results", "is missing"]),
        ("timeout = \"2 min\"", "results = \"../r\"", &["simulator.results", "a relative path without .."]),
        (
            "timeout = \"2 min\"",
            "results = \"r\"\nfiles = [\"/etc/passwd\"]",
            &["simulator.files", "a relative path without .."],
        ),
        (
            "timeout = \"2 min\"",
            "results = \"r\"\ntemplates = [\"a\"]\nfiles = [\"a\"]",
            &["simulator.results", "\"a\", which is named twice"],
        ),
        (
            "timeout = \"2 min\"",
            "results = \"r\"\nfiles = [\"request.json\"]",
            &["simulator.results", "request.json are written for each evaluation"],
        ),
        (
            "timeout = \"2 min\"",
            "results = \"r\"\ntemplates = \"a\"",
            &["simulator.templates", "a list of file"],
        ),
        (
            "checkpoint_every = 100",
            "checkpoint_every = 70",
            &["life.cycles", "a multiple of checkpoint_every = 70"],
        ),
        (
            "values = 1",
            "values = 2",
            &["outputs.margin.values", "2 is out of range", "each of the 3 checkpoints"],
        ),
        ("unit = \"mm\"\n", "type = \"largest-wear\"\n", &["outputs.deflection.type", "unknown key"]),
        (
            "threshold = 12.5",
            "threshold = \"12.5 mm\"",
            &["limit_states.bent.threshold", "expected a plain number"],
        ),
        ("fails = \"below\"", "fails = \"under\"", &["limit_states.weak.fails", "allowed: above, below"]),
        ("mean = 293\n", "", &["variables.temperature.mean", "is missing"]),
        (
            "unit = \"K\"",
            "unit = \"mm\"",
            &["variables.temperature.unit", "not a unit of a plain number; write mean = \"293 mm\""],
        ),
        (
            "unit = \"K\"",
            "changes = [\"parameters.length\"]",
            &["variables.temperature.changes", "unknown key"],
        ),
        ("[parameters]", "[[bodies]]\nname = \"frame\"\n[parameters]", &["bodies: unknown key"]),
    ] {
        let said = faults(&beam(from, to));
        assert_eq!(said.lines().count(), 1, "{said}");
        for part in parts {
            assert!(said.contains(part), "no \"{part}\" in: {said}");
        }
    }
    let said = faults(&beam("program = [\"python3\", \"beam.py\"]", "umbridge = \"https://example.org\""));
    assert!(said.contains("simulator.umbridge") && said.contains("allowed: http://HOST:PORT"), "{said}");
    // Without outputs there is nothing to learn.
    let outputs = &BEAM[BEAM.find("[[outputs]]").unwrap()..BEAM.find("[[variables]]").unwrap()];
    let said = faults(&beam(outputs, ""));
    assert!(said.contains("outputs: is missing") && said.contains("limit_states: is missing"), "{said}");
}

/// Limits of a mechanism and of a simulator, and those that are refused.
#[test]
fn limits_are_above_below_or_two() {
    let four_bar = include_str!("../../scenes/four-bar.toml");
    let with = |limits: &str| {
        let text = four_bar.replacen("threshold = \"8 um\"", limits, 1);
        SceneSource::parse(&text, "four-bar.toml").map(|source| source.nominal().limit_states[0].clone())
    };
    let below = with("threshold = \"8 um\"\nfails = \"below\"").unwrap();
    assert_eq!((below.threshold, below.fails), (8e-6, Fails::Below));
    for limits in
        ["lower = \"2 um\"\nupper = \"8 um\"", "lower = \"2 um\"\nupper = \"8 um\"\nfails = \"outside\""]
    {
        let two = with(limits).unwrap();
        assert_eq!((two.threshold, two.fails), (8e-6, Fails::Outside { lower: 2e-6 }));
    }
    for [limits, expected] in crate::rows("limits_are_above_below_or_two") {
        let said = with(limits).unwrap_err().to_string();
        assert!(said.contains(expected), "{limits}: found {said}, expected {expected}");
    }
    // Values of a simulator may have any sign.
    let text = BEAM.replacen("threshold = -0.5\nfails = \"below\"", "lower = -0.5\nupper = 0.5", 1);
    assert_ne!(text, BEAM);
    let source = SceneSource::parse(&text, "beam.toml").unwrap();
    assert_eq!(source.nominal().limit_states[1].fails, Fails::Outside { lower: -0.5 });
}

/// A scene that extends another one replaces one limit by two and the reverse.
#[test]
fn limits_of_an_extended_scene_are_replaced() {
    let changed = |limits: &str| {
        let text = format!(
            "[scene]\nextends = \"four-bar\"\nname = \"changed\"\n[[limit_states]]\nname = \"wear\"\n{limits}\n"
        );
        let source = SceneSource::parse(&text, "changed.toml").unwrap_or_else(|faults| panic!("{faults}"));
        source.nominal().limit_states[0].clone()
    };
    let two = changed("lower = \"1 um\"\nupper = \"9 um\"");
    assert_eq!((two.threshold, two.fails), (9e-6, Fails::Outside { lower: 1e-6 }));
    assert_eq!(changed("threshold = \"7 um\"").fails, Fails::Above);
    assert_eq!(changed("fails = \"below\"").fails, Fails::Below);
}

#[test]
fn a_program_runs_in_the_folder_of_its_scene() {
    let folder = std::env::temp_dir().join(format!("hingewise-scene-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("model")).unwrap();
    let file = folder.join("beam.toml");
    let runs_in = |text: &str| {
        std::fs::write(&file, text).unwrap();
        let loaded = SceneSource::load(file.to_str().unwrap()).unwrap();
        // What is stored knows the folder too.
        let stored = SceneSource::parse(loaded.text(), "campaign.db").unwrap();
        assert_eq!(stored.nominal(), loaded.nominal());
        match stored.nominal().clone().simulator.unwrap().kind {
            SimulatorKind::Program(program) => program.folder,
            SimulatorKind::UmBridge(_) => panic!("a program"),
        }
    };
    let whole = folder.canonicalize().unwrap();
    let found = [runs_in(BEAM), runs_in(&beam("timeout = \"2 min\"", "folder = \"model\""))];
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(found, [whole.display().to_string(), whole.join("model").display().to_string()]);
}

const CYCLE: &str = include_str!("../scenes/cycle.toml");

#[test]
fn joints_of_a_program_that_gives_cycles_are_read() {
    let source = SceneSource::parse(CYCLE, "cycle.toml").unwrap();
    let scene = source.nominal();
    let program = &scene.simulator.as_ref().unwrap().cycles;
    let journal = Some("cycles".to_owned());
    assert_eq!(*program, Some(CycleProgram { tier: CycleTier::Contact, journal }));
    assert_eq!((scene.life.period, scene.life.settle_cycles), (0.05, 1));
    assert_eq!(scene.accuracy.name, "draft");
    let JointKind::Clearance(pin) = &scene.joints[0].kind else { panic!("a joint with clearance") };
    assert_eq!(pin.wear_coefficients(), [2e-13, 2e-13]);
    let declared = OutputKind::External { unit: "N m".into(), single: false };
    assert!(scene.outputs[0].kind.wear().is_some() && scene.outputs[1].kind == declared);
    // A variable that changes a joint, and one that is only an input.
    let worn = source.resolve_sample(&[3e-13, 4.0]).unwrap();
    let JointKind::Clearance(pin) = &worn.joints[0].kind else { panic!("a joint with clearance") };
    assert_eq!(pin.wear_coefficients(), [3e-13; 2]);
    // Each condition has the value of what any of them changes.
    let of = |condition: &Condition| (condition.name.clone(), condition.share, condition.parameters.clone());
    let expected = |name: &str, share, value| (name.to_owned(), share, [("worn".to_owned(), value)].into());
    assert_eq!(
        worn.conditions.iter().map(of).collect::<Vec<_>>(),
        [expected("usual", 0.8, 3e-13), expected("hot", 0.2, 6e-13)]
    );
    assert!(source.unused_parameters.is_empty());
    // What a variable changes reaches the program.
    let text = CYCLE.replace("[parameters]\n", "[parameters]\nrod = \"40 mm\"\nspare = 1\n")
        + "\n[[variables]]\nname = \"rod\"\nchanges = [\"parameters.rod\"]\nstd = \"1 %\"\n";
    let source = SceneSource::parse(&text, "cycle.toml").unwrap_or_else(|faults| panic!("{faults}"));
    assert_eq!(source.unused_parameters, ["spare"]);
}

#[test]
fn faults_of_a_program_that_gives_cycles_are_named() {
    for [from, to, said] in crate::rows("faults_of_a_program_that_gives_cycles_are_named") {
        assert!(CYCLE.contains(from), "{from}");
        let faults =
            SceneSource::parse(&CYCLE.replacen(from, to, 1), "cycle.toml").expect_err(to).to_string();
        assert!(faults.contains(said), "{to}: {faults}");
    }
}
