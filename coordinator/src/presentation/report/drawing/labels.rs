//! Places labels near their points so that no two overlap, and as few lines as possible are covered: a search over rings of
//! candidates around each point.

/// A rectangle of a drawing, y downward [drawing units].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LabelArea {
    /// Left upper corner `(2,)` [drawing units].
    pub from: [f64; 2],
    /// Right lower corner `(2,)` [drawing units].
    pub to: [f64; 2],
}

impl LabelArea {
    /// True if two rectangles have more than an edge in common.
    pub fn overlaps(&self, other: &LabelArea) -> bool {
        (0..2).all(|axis| self.from[axis] < other.to[axis] && other.from[axis] < self.to[axis])
    }

    /// True if a point lies in the rectangle.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        (0..2).all(|axis| (self.from[axis]..=self.to[axis]).contains(&point[axis]))
    }

    /// The point of the rectangle nearest to another one.
    pub fn nearest(&self, point: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis: usize| point[axis].clamp(self.from[axis], self.to[axis]))
    }
}

/// A text that belongs to a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// The text, one line.
    pub text: String,
    /// Point to which it belongs `(2,)` [drawing units].
    pub at: [f64; 2],
    /// Distance that it keeps from the point [drawing units].
    pub clear: f64,
    /// Number of the body that it names, for its style; `None` for a joint, a load or a drive.
    pub body: Option<usize>,
}

/// A label with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedLabel {
    /// The label that is placed.
    pub label: Label,
    /// Rectangle of its text [drawing units].
    pub area: LabelArea,
    /// Distance of the rectangle from the point [drawing units].
    pub distance: f64,
}

/// Sizes of the text of labels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LetterSize {
    /// Width of a letter [drawing units].
    pub width: f64,
    /// Height of a line [drawing units].
    pub height: f64,
    /// Distance of two rings of candidates [drawing units].
    pub step: f64,
    /// True if rectangles lie on a grid of whole units, as in a terminal.
    pub whole: bool,
}

/// Directions of the candidates, the preferred ones first: right, left, above, below, and between them.
const DIRECTIONS: [[f64; 2]; 16] = [
    [DIAGONAL, -DIAGONAL],
    [1.0, 0.0],
    [DIAGONAL, DIAGONAL],
    [-DIAGONAL, -DIAGONAL],
    [-1.0, 0.0],
    [-DIAGONAL, DIAGONAL],
    [0.0, -1.0],
    [0.0, 1.0],
    [0.9239, -0.3827],
    [0.9239, 0.3827],
    [-0.9239, -0.3827],
    [-0.9239, 0.3827],
    [0.3827, -0.9239],
    [0.3827, 0.9239],
    [-0.3827, -0.9239],
    [-0.3827, 0.9239],
];

/// Both coordinates of a diagonal direction.
const DIAGONAL: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Rings within which the best candidate is chosen; beyond them the first one that is free.
const RINGS: usize = 12;

/// Cost of an obstacle that a label covers, in rings of distance.
const COVERED: f64 = 2.5;

/// Width of bold letters against that of others.
const BOLD: f64 = 1.15;

/// Places the labels in their order; `obstacles` are points of lines and symbols `(n, 2)` that labels should not cover.
pub fn place_labels(labels: &[Label], obstacles: &[[f64; 2]], size: LetterSize) -> Vec<PlacedLabel> {
    let mut placed: Vec<PlacedLabel> = Vec::with_capacity(labels.len());
    for label in labels {
        let mut best: Option<(f64, PlacedLabel)> = None;
        for ring in 0.. {
            if ring >= RINGS && best.is_some() {
                break;
            }
            for (preference, direction) in DIRECTIONS.iter().enumerate() {
                let candidate = candidate(label, *direction, ring as f64 * size.step, size);
                if placed.iter().any(|other| other.area.overlaps(&candidate.area)) {
                    continue;
                }
                let covered = obstacles.iter().filter(|point| candidate.area.contains(**point)).count();
                let cost = ring as f64 + COVERED * covered as f64 + 0.05 * preference as f64;
                if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                    best = Some((cost, candidate));
                }
            }
        }
        placed.extend(best.map(|(_, label)| label));
    }
    placed
}

fn candidate(label: &Label, way: [f64; 2], farther: f64, size: LetterSize) -> PlacedLabel {
    // Names of bodies are bold.
    let wider = if size.whole || label.body.is_none() { 1.0 } else { BOLD };
    let half = [0.5 * wider * size.width * label.text.chars().count() as f64, 0.5 * size.height];
    let distance = label.clear + farther;
    // On a diagonal the nearest corner lies at the distance, above and beside the point the nearest edge.
    let beside = |share: f64| (share / DIAGONAL).clamp(-1.0, 1.0);
    let snap = |value: f64| if size.whole { value.round() } else { value };
    let from = [0, 1].map(|axis: usize| {
        let centre = label.at[axis] + way[axis] * distance + beside(way[axis]) * half[axis];
        snap(centre - half[axis])
    });
    let area = LabelArea { from, to: [from[0] + 2.0 * half[0], from[1] + 2.0 * half[1]] };
    let [x, y] = area.nearest(label.at);
    PlacedLabel { label: label.clone(), area, distance: (x - label.at[0]).hypot(y - label.at[1]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LETTERS: LetterSize = LetterSize { width: 8.0, height: 18.0, step: 7.0, whole: false };

    fn label(text: &str, at: [f64; 2]) -> Label {
        Label { text: text.into(), at, clear: 8.0, body: None }
    }

    #[test]
    fn labels_of_one_point_stand_side_by_side() {
        let labels: Vec<Label> = (0..40).map(|k| label(&format!("joint {k}"), [0.0, 0.0])).collect();
        for size in [LETTERS, LetterSize { width: 1.0, height: 1.0, step: 1.0, whole: true }] {
            let placed = place_labels(&labels, &[], size);
            assert_eq!(placed.len(), 40);
            for (k, a) in placed.iter().enumerate() {
                assert!(placed[k + 1..].iter().all(|b| !a.area.overlaps(&b.area)), "{k}");
            }
        }
        // The first stands where it is preferred, at its distance from the point.
        let first = &place_labels(&labels, &[], LETTERS)[0];
        assert!(first.area.from[0] > 0.0 && first.area.to[1] < 0.0 && first.distance < 12.0, "{first:?}");
    }

    #[test]
    fn a_label_avoids_lines() {
        // A line to the upper right, where the label would stand.
        let line: Vec<[f64; 2]> = (0..40).map(|k| [3.0 * f64::from(k), -1.5 * f64::from(k)]).collect();
        let placed = place_labels(&[label("crank", [0.0, 0.0])], &line, LETTERS);
        assert!(line.iter().all(|point| !placed[0].area.contains(*point)), "{placed:?}");
        assert!(placed[0].distance < 20.0, "{placed:?}");
    }
}
