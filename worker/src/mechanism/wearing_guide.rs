//! A guide with clearance of an island, with its faces and those of its slider as worn so far.

use super::frame::{End, Frame};
use super::guide::{Guide, Guiding};
use super::load::LoadForce;
use super::wearing_joint::WearingPair;
use super::worn_guide::WornGuide;
use crate::contact::GuideReaction;
use crate::rail::{MOST_NODES, RailFaces, RailLayout, play};
use crate::wear::{FinerBore, RailHistory, RailWearRate, StepTolerance, WearHistory, WearRate};
use common::scene::GuideClearance;

/// A guide with clearance and its surfaces.
#[derive(Debug, Clone)]
pub struct WearingGuide {
    /// The guide with flat faces, and the damping of its pads.
    pub flat: Guide,
    /// The worn surfaces; `None` if none wears.
    worn: Option<Box<WornSurfaces>>,
}

/// Surfaces of a guide and its slider of which one wears at least.
#[derive(Debug, Clone)]
struct WornSurfaces {
    scene_joint: usize,
    /// Wear coefficient K_H of guide and slider, zero for a surface that does not wear `(2,)` [1/Pa].
    coefficients: [f64; 2],
    /// Clearance on each side [m] and stiffness of a whole face [N/m].
    clearance: f64,
    stiffness: f64,
    /// The faces as worn so far.
    faces: RailFaces,
}

impl WearingGuide {
    /// Joint number `scene_joint` of a checked scene, unworn.
    pub(super) fn new(scene_joint: usize, guide: &GuideClearance, ends: [End; 2]) -> Self {
        let flat = Guide::new(scene_joint, guide, ends);
        let coefficients = guide.wear_coefficients();
        let wear = guide.wear.as_ref().filter(|_| coefficients != [0.0; 2]);
        let worn = wear.map(|wear| {
            Box::new(WornSurfaces {
                scene_joint,
                coefficients,
                clearance: flat.clearance(),
                stiffness: flat.stiffness(),
                faces: RailFaces::new(RailLayout::new(guide, wear)),
            })
        });
        WearingGuide { flat, worn }
    }

    /// True if a surface wears.
    pub(crate) fn wears(&self) -> bool {
        self.worn.is_some()
    }

    /// Range of `lambda[0]` times the offset plus `lambda[1]` times the tilt that the worn faces leave the slider with its middle at `s` [m];
    /// `None` if no surface wears.
    pub(crate) fn play(&self, lambda: [f64; 2], s: f64) -> Option<f64> {
        self.worn.as_ref().map(|worn| play(&worn.faces, worn.clearance, lambda, s))
    }

    /// Depth of guide and slider together at the first or the `last` corner of the slider's `face`, which lies at `s` [m] along the guide [m], and its
    /// slope along the guide [1]; zero if no surface wears.
    pub(super) fn corner_depth(&self, face: usize, last: bool, s: f64) -> (f64, f64) {
        self.worn.as_ref().map_or((0.0, 0.0), |worn| {
            let node = if last { worn.faces.layout.nodes() - 1 } else { 0 };
            let [depth, slope, _] = worn.faces.guide_depth(face, s);
            (depth + worn.faces.slider[face][node], slope)
        })
    }

    /// The two surfaces, if one of them wears.
    pub(super) fn pair(&self) -> Option<&dyn WearingPair> {
        self.worn.as_deref().map(|worn| worn as &dyn WearingPair)
    }

    /// The two surfaces to be worn, if one of them wears.
    pub(super) fn pair_mut(&mut self) -> Option<&mut dyn WearingPair> {
        self.worn.as_deref_mut().map(|worn| worn as &mut dyn WearingPair)
    }
}

impl WornSurfaces {
    fn rate_at(&self, layout: RailLayout) -> WearRate {
        let rate = RailWearRate::new(self.coefficients, layout, self.clearance, self.stiffness);
        WearRate::Rail(Box::new(rate))
    }
}

impl WearingPair for WornSurfaces {
    fn scene_joint(&self) -> usize {
        self.scene_joint
    }

    fn wear_coefficients(&self) -> [f64; 2] {
        self.coefficients
    }

    fn first_depths(&self) -> usize {
        self.faces.layout.guide_depths()
    }

    fn depths(&self) -> usize {
        self.faces.layout.depths()
    }

    fn set_depth(&mut self, depth: &[f64]) {
        self.faces.set_depth(depth);
    }

    fn refine(&mut self, times: u32) -> bool {
        let layout = (0..times).fold(self.faces.layout, |layout, _| layout.finer());
        let fits = layout.elements < MOST_NODES;
        if fits {
            self.faces = RailFaces::new(layout);
        }
        fits
    }

    fn empty_history(&self, period: f64, samples: usize) -> WearHistory {
        WearHistory::Rail(RailHistory::new(period, samples, &self.faces.layout))
    }

    fn wear_rate(&self) -> WearRate {
        self.rate_at(self.faces.layout)
    }

    fn finer_copy(&self, tolerance: StepTolerance) -> FinerBore<WearRate> {
        let finer = self.faces.layout.finer();
        FinerBore::new(self.rate_at(finer), finer.depths(), tolerance)
    }
}

impl Guiding<f64> for WearingGuide {
    #[inline(always)]
    fn ends(&self) -> [End; 2] {
        self.flat.ends
    }

    #[inline(always)]
    fn force<const JACOBIAN: bool>(&self, frames: &[Frame]) -> (LoadForce, GuideReaction) {
        match &self.worn {
            None => self.flat.force::<JACOBIAN>(frames),
            Some(worn) => WornGuide { flat: &self.flat, faces: &worn.faces }.force::<JACOBIAN>(frames),
        }
    }

    #[inline(always)]
    fn begun(&self, frames: &[Frame], before: &GuideReaction, h: f64) -> [f64; 6] {
        match &self.worn {
            None => self.flat.begun(frames, before, h),
            Some(worn) => WornGuide { flat: &self.flat, faces: &worn.faces }.begun(frames, before, h),
        }
    }
}
