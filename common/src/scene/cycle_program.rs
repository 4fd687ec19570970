//! Scenes whose simulator gives one cycle: the joints that wear, the outputs of the wear and those of the program, and the life. The bodies
//! are those of the program, which the scene does not describe.

use super::body_row::{BodyRow, MotionWord};
use super::clearance::materials;
use super::context::Range;
use super::joints::{JointRow, worn_joint};
use super::key_reading::Named;
use super::key_table::Form;
use super::model::{Life, Motion};
use super::output::{Output, OutputKind};
use super::outputs::{OutputRow, typed_output, typed_words};
use super::quantity::TIME;
use super::section::Section;
use super::simulator::{checkpoints, declared_outputs};

/// What a scene says about the cycles of a program, as far as it could be read.
pub(super) struct CycleModel {
    pub(super) body: BodyRow,
    pub(super) joints: Vec<JointRow>,
    pub(super) outputs: Vec<OutputRow>,
    pub(super) life: Option<Life>,
}

/// Reads joints, outputs and life of a program that gives cycles.
pub(super) fn cycle_model(file: &mut Section) -> CycleModel {
    let materials = materials(file);
    let mut joints = Vec::new();
    for (name, mut row) in file.rows("joints") {
        joints.push(worn_joint(&mut row, name, &materials));
        row.finish();
    }
    if joints.is_empty() {
        file.missing("joints", "at least one joint that wears, [[joints]]");
    }
    let life = life(file);
    let outputs = outputs(file, &joints);
    let body = BodyRow {
        name: "mechanism".to_owned(),
        word: Some(MotionWord::Fixed),
        motion: Some(Motion::Fixed),
        points: vec![],
    };
    CycleModel { body, joints, outputs, life }
}

fn life(file: &mut Section) -> Option<Life> {
    let mut section = file.section("life", "a table [life] with period, cycles and checkpoint_every")?;
    let period = section.quantity("period", TIME, Range::Positive);
    let life = checkpoints(&mut section);
    section.finish();
    Some(Life { period: period?, settle_cycles: 1, ..life? })
}

/// Reads `[[outputs]]`: rows with a `type` are outputs of the wear, the others those of the program.
fn outputs(file: &mut Section, joints: &[JointRow]) -> Vec<OutputRow> {
    let of_wear =
        OutputKind::KINDS.iter().filter(|kind| kind.keys.iter().any(|key| key.form == Form::WornJoints));
    let words: Vec<_> = of_wear.flat_map(typed_words).collect();
    declared_outputs(file, |name, row| {
        if row.peek("type").is_some() {
            return typed_output(name, row, &words, Named { bodies: &[], joints });
        }
        let unit = row.text_or("unit", "a unit, as it is to be shown", "");
        let kind = unit.map(|unit| OutputKind::External { unit: unit.to_owned(), single: false });
        OutputRow::declared(name, kind.map(|kind| Output { name: name.to_owned(), kind }))
    })
}
