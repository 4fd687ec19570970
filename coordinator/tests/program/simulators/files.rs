//! Programs that run once per evaluation, with a template and a results file.

use super::{RIGHT, StudyFolder, model, study};

/// The strength problem as a program that runs once per evaluation, with a template and a results file.
const FILES: &str = r#"
program = ["python3", "{folder}/solver.py"]
templates = ["deck.inp"]
files = ["tables/steel.txt"]
results = "results.out"
"#;

const SOLVER: &str = r#"
import json, os, sys, time
assert open('tables/steel.txt').read() == 'steel {R}\n'
values = dict(line.split(' = ') for line in open('deck.inp') if ' = ' in line)
request = json.load(open('request.json'))
R, S = float(values['strength']), float(values['load'])
assert (R, S) == (request['sample']['R'], request['sample']['S']), 'every bit arrives'
assert sorted(os.listdir('.')) == ['deck.inp', 'request.json', 'tables']
print('solved in', os.getcwd())
REPLY
"#;

/// A study with files; `reply` writes the results.
fn with_files(reply: &str, timeout: &str) -> Option<StudyFolder> {
    let study = study("", timeout)?;
    let text = std::fs::read_to_string(study.file("study.toml")).unwrap();
    let (from, to) = (text.find("program").unwrap(), text.find(", timeout").unwrap());
    let inline = FILES.trim().replace('\n', ", ");
    std::fs::write(study.file("study.toml"), text.replace(&text[from..to], &inline)).unwrap();
    std::fs::write(study.file("solver.py"), SOLVER.replace("REPLY", reply)).unwrap();
    std::fs::write(study.file("deck.inp"), "{{deck}} {1}\nstrength = {R}\nload = {S}\n").unwrap();
    std::fs::create_dir(study.file("tables")).unwrap();
    std::fs::write(study.file("tables/steel.txt"), "steel {R}\n").unwrap();
    Some(study)
}

#[test]
fn a_program_with_files_gives_the_same_answer() {
    let Some(lines) = study(&model("", RIGHT), "1 min") else { return };
    const RUN: &str = "run study.toml --workers 2 --seed 3 --samples 4000 --initial 20 --max-evaluations 20 --out two --quiet";
    lines.done(RUN);
    let Some(study) = with_files("open('results.out', 'w').write(f'{R - S!r} margin\\n')", "1 min") else {
        return;
    };
    study.done("check study.toml");
    let explained = study.done("explain study.toml");
    assert!(
        explained.contains("runs once per evaluation, in a folder with deck.inp, tables/steel.txt"),
        "{explained}"
    );
    study.done(RUN);
    assert_eq!(study.summary("two")["reliability"], lines.summary("two")["reliability"]);
}

#[test]
fn a_program_with_files_fails_like_one_with_lines() {
    let right = "open('results.out', 'w').write(f'{R - S}')";
    let own = [
        ("open('results.out', 'w').write('FAIL it diverged')", "the simulator reports: FAIL it diverged"),
        ("open('results.out', 'w').write('nan')", "returned nan for output margin at cycle 1"),
        ("sys.exit('singular matrix')", "ended with exit status: 1: "),
        ("None", "ended with exit status: 0 and no results.out"),
        ("time.sleep(600)", "the simulator gave no answer within 5 s"),
    ];
    // The evaluations from 5 on have one fault each.
    let mut reply = right.to_owned();
    for (k, (fault, _)) in own.iter().enumerate() {
        reply = format!("{fault} if request['id'] == {} else {reply}", 5 + k);
    }
    let Some(study) = with_files(&reply, "5 s") else { return };
    study.done(
        "run study.toml --workers 2 --seed 3 --samples 4000 --initial 30 --max-evaluations 30 --out out --quiet",
    );
    assert_eq!(study.summary("out")["evaluations"]["failed"], own.len());
    let samples = std::fs::read_to_string(study.file("out").join("samples.csv")).unwrap();
    for (k, (_, cause)) in own.iter().enumerate() {
        let row = samples.lines().find(|line| line.starts_with(&format!("{},", 5 + k))).unwrap();
        assert!(row.contains(cause), "no \"{cause}\" in: {row}");
    }
    // What cannot be a results file ends the study, with its name and line; a wrong template before it begins.
    let Some(study) = with_files("open('results.out', 'w').write('margin 3')", "1 min") else { return };
    let said = study.refused("run study.toml --workers 1 --out out --quiet", 1);
    assert!(said.contains("results.out: line 1: \"margin 3\" does not begin with a number"), "{said}");
    std::fs::write(study.file("deck.inp"), "strength = {r}\n").unwrap();
    let said = study.refused("check study.toml", 2);
    assert!(said.contains("deck.inp: line 1: {r} is not an input; the inputs are R, S"), "{said}");
    std::fs::remove_file(study.file("deck.inp")).unwrap();
    assert!(study.refused("run study.toml --out out2", 2).contains("deck.inp: "));
}
