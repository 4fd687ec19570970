//! What this project adds to the published learning, each addition to be left out singly, or all.

use clap::ValueEnum;
use coordinator::statistics::learning::{LearningFunction, StoppingTargets};
use coordinator::statistics::surrogate::{FormSettings, Kernel, Trend};
use coordinator::study::{Method, Settings};

/// An addition of this project to the published learning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Addition {
    /// Results over which a rule must hold, of which three of four explore.
    Hold,
    /// The stop by the estimated error.
    ErrorRule,
    /// The linear trend, where cross-validation prefers it.
    Trend,
    /// The Matern kernels, where cross-validation prefers one.
    Kernel,
    /// The learning function that lowers the estimated error, in the place of U.
    Gain,
    /// Everything: the published method, with 200 initial points and at most 2000 evaluations.
    All,
}

impl Addition {
    fn take_from(self, settings: &mut Settings, targets: &mut StoppingTargets) {
        match self {
            Self::Hold => *targets = StoppingTargets { hold: 1, hold_points: 0, ..*targets },
            Self::ErrorRule => targets.error = 0.0,
            Self::Trend => settings.forms = FormSettings { trend: Some(Trend::Constant), ..settings.forms },
            Self::Kernel => {
                settings.forms = FormSettings { kernel: Some(Kernel::Gaussian), ..settings.forms }
            }
            Self::Gain => settings.learning = LearningFunction::U,
            Self::All => {
                settings.method = Method::AkMcs;
                settings.make_as_published();
            }
        }
    }
}

/// Leaves the addition, if any, out of the settings and of their targets, which are returned.
pub fn leave_out(addition: Option<Addition>, settings: &mut Settings) -> StoppingTargets {
    let mut targets = settings.targets();
    if let Some(addition) = addition {
        addition.take_from(settings, &mut targets);
    }
    targets
}
