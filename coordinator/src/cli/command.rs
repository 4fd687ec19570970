//! The command line as typed: all commands, their help and their order on the first page of the help.

#[cfg(test)]
mod tests;

use super::scene_options::SceneName;
use super::study_options::{ResumeArguments, RunArguments};
use super::{AccuracyArguments, SceneArguments, Verbosity, scene_name};
use super::{
    calibrate, check, compare, designs, doctor, draw, init, learn, optimise, replace, results, simulate,
    status, test_plan, tradeoff, update, weibull, what_if,
};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use std::fmt::Write;
use std::path::PathBuf;

/// Groups of the first page of the help: the commands of a study from its scene to its decisions.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Study", &["run", "resume", "report", "compare"]),
    ("Decide", &["what-if", "designs", "optimise", "learn", "update", "replace"]),
    ("Look", &["simulate", "explain", "draw", "status", "scenes"]),
    ("Prepare", &["init", "check", "calibrate"]),
];

/// Commands that the first page of the help names without a description.
const MORE: [&str; 8] =
    ["sensitivity", "test-plan", "weibull", "doctor", "tradeoff", "schema", "completions", "man"];

const EXAMPLE: &str = "\
Without a command, `coordinator --workers auto` runs a study with the options of `run`.
Exit codes: 0 done, 2 bad input, 1 failure, 130 interrupted (all finished evaluations are saved).
Example, about 3 s: coordinator run four-bar --accuracy draft --out study";

/// Hingewise: reliability over life of mechanisms with wearing hinges
#[derive(Debug, Parser)]
#[command(name = "coordinator", version, after_help = EXAMPLE)]
pub struct CommandLine {
    #[command(flatten)]
    pub verbosity: Verbosity,
    /// Scene of a study, if no command is given
    #[arg(long)]
    pub scene: Option<String>,
    /// Options of a study, if no command is given.
    #[command(flatten)]
    pub run: RunArguments,
    #[command(subcommand)]
    pub command: Option<CommandArguments>,
}

impl CommandLine {
    /// Reads the command line of this process; ends the process with a message if it is wrong.
    pub fn read() -> Self {
        let matches = accept_negative_numbers(grouped()).get_matches();
        Self::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
    }
}

/// Reads `-1` after an option as its value, so that the message says what is allowed.
fn accept_negative_numbers(command: clap::Command) -> clap::Command {
    let accept = |argument: clap::Arg| {
        let has_value = argument.get_action().takes_values() && !argument.is_positional();
        if has_value { argument.allow_negative_numbers(true) } else { argument }
    };
    command.mut_args(accept).mut_subcommands(|command| command.mut_args(accept))
}

/// The command line, with a first help page on one screen: the commands in groups, and none of the options of `run`.
pub fn grouped() -> clap::Command {
    let command = CommandLine::command();
    let own = Verbosity::augment_args(clap::Command::new("own"));
    let is_own = |argument: &clap::Arg| own.get_arguments().any(|own| own.get_id() == argument.get_id());
    let page = format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{}Options:\n{{options}}{{after-help}}",
        groups(&command)
    );
    command
        // Without long texts `--help` prints one line per option, as `-h` does.
        .mut_args(|argument| {
            let argument = argument.long_help(None::<&str>);
            if is_own(&argument) { argument } else { argument.hide(true) }
        })
        .help_template(page)
}

/// The commands by group, one line each.
fn groups(command: &clap::Command) -> String {
    let mut text = String::new();
    for (group, names) in GROUPS {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{group}:");
        for name in names {
            let about =
                command.find_subcommand(name).and_then(clap::Command::get_about).map(ToString::to_string);
            let _ = writeln!(text, "  {name:12} {}", about.unwrap_or_default());
        }
    }
    let _ = writeln!(text, "More (COMMAND --help): {}\n", MORE.join(", "));
    text
}

/// The commands of the program.
#[derive(Debug, Subcommand)]
pub enum CommandArguments {
    /// Run a reliability study
    #[command(after_help = "\
Examples:
  coordinator run --workers auto
  coordinator run flapping-wing-tolerances --workers 2 --out tolerances --seed 7
  coordinator run my.toml --method monte-carlo --samples 500
  coordinator run four-bar --set parameters.width='12 mm' --set friction=0.06 --out wider
  coordinator run four-bar --design 'parameters.clearance=18 um..30 um' --out clearances
  coordinator run four-bar --max-error 1%
  coordinator run --workers 0 --listen tcp/0.0.0.0:7447 --config tls.json5")]
    Run {
        #[command(flatten)]
        scene: SceneName,
        #[command(flatten)]
        options: Box<RunArguments>,
    },
    /// Continue an interrupted study, or go on with other settings; no finished evaluation is run again
    #[command(after_help = "\
With another budget, target error or share of failures the result is that of a study that had these settings from the \
start. A larger population (ak) keeps all results and grows once learning has ended on the present one.

Examples:
  coordinator resume hingewise-flapping-wing --workers auto
  coordinator resume study --max-evaluations 120
  coordinator resume direct --samples 2000")]
    Resume(ResumeArguments),
    /// Run one evaluation in this process; print it as JSON, or on a terminal in lines
    #[command(after_help = "\
Examples:
  coordinator simulate four-bar --accuracy draft --report one.html
  coordinator simulate flapping-wing --out nominal.json
  coordinator simulate flapping-wing --set rod_length=40.05mm --set friction=0.03
  coordinator simulate my.toml --set parameters.crank_speed='500 r/min' --accuracy draft")]
    Simulate(simulate::SimulateArguments),
    /// Measure time against error for the accuracy settings of a scene
    #[command(after_help = "\
Runs the presets and settings near them at the nominal point and at random points of the variables, and compares them \
with `reference`: time, error of each output, coverage of the stated errors, and the effect on the reliability. \
Prints tradeoff.md; with --out it writes tradeoff.md, tradeoff.html, tradeoff.csv (one line per setting) and values.csv (one line \
per value) to this folder. If interrupted, it writes the points that are complete.

Examples:
  coordinator tradeoff four-bar --out four-bar-tradeoff
  coordinator tradeoff my.toml --settings quick --samples 10 --out my-tradeoff
  coordinator tradeoff --setting balanced --setting draft --samples 201 --out stated-errors
  coordinator tradeoff --workers 0 --listen tcp/127.0.0.1:7447 --out tradeoff")]
    Tradeoff(tradeoff::TradeoffArguments),
    /// Fit free parameters of a scene to measured or published targets
    #[command(after_help = "\
The file names the free parameters with their bounds (keys of the scene, factors on means or standard deviations of random \
variables) and the targets with their tolerances. The report lists the fit of each target, the uncertainty of each \
parameter, the correlations, and targets that contradict each other.

Examples:
  coordinator calibrate my.toml --targets measured.toml
  coordinator calibrate four-bar --targets measured.toml --accuracy draft --rounds 1 --json")]
    Calibrate(Box<calibrate::CalibrateArguments>),
    /// A command that is an example of the sources now
    #[command(name = "extremes", aliases = ["replay", "verify"], hide = true, disable_help_flag = true)]
    Moved {
        /// What was given to it
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Print the sensitivities of the failure probabilities of a finished study
    #[command(after_help = "Example:\n  coordinator sensitivity hingewise-flapping-wing --json")]
    Sensitivity {
        /// Folder of the study
        dir: PathBuf,
    },
    /// Write the result files and the report of a finished study again
    #[command(after_help = "\
Examples:
  coordinator report hingewise-flapping-wing
  coordinator report archive/study --out study-report
  coordinator report study --pdf")]
    Report(results::ReportArguments),
    /// Compare the reliability curves of several finished studies on one page
    #[command(after_help = "\
With --out it writes a page with curves and bands per limit state and in total, the lives at R = 0.99, 0.9 and 0.5, and the cost of each \
study, and the curves as CSV under the same name. The studies need limit states of the same names and the same \
checkpoints.

Examples:
  coordinator compare hingewise-four-bar hingewise-four-bar-2 --out compare.html
  coordinator compare steel bronze polymer --out bushings.html")]
    Compare(compare::CompareArguments),
    /// Reliability of a finished study for changed tolerances, distributions and thresholds, without new simulations
    #[command(after_help = what_if::EXAMPLES)]
    WhatIf(Box<what_if::WhatIfArguments>),
    /// Update reliability and remaining life of single units by what was measured of them
    #[command(after_help = update::EXAMPLES)]
    Update(update::UpdateArguments),
    /// Learn a population's parameters from its units: reliability with a confidence
    #[command(after_help = learn::EXAMPLES)]
    Learn(learn::LearnArguments),
    /// Find the age, or the measured level, of replacement with the least cost
    #[command(after_help = replace::EXAMPLES)]
    Replace(replace::ReplaceArguments),
    /// Units and cycles of a test that demonstrates a reliability, with a study as prior knowledge
    #[command(after_help = test_plan::EXAMPLES)]
    TestPlan(test_plan::TestPlanArguments),
    /// Weibull distribution of lives with suspensions and intervals, beside the reliability of a study
    #[command(after_help = weibull::EXAMPLES)]
    Weibull(weibull::WeibullArguments),
    /// Reliability and lives of every design, from a study with design variables
    #[command(after_help = designs::EXAMPLES)]
    Designs(Box<designs::DesignsArguments>),
    /// Cheapest means and tolerances that reach a reliability, from a finished study
    #[command(after_help = optimise::EXAMPLES)]
    Optimise(Box<optimise::OptimiseArguments>),
    /// Write a commented scene to start from
    #[command(after_help = "\
Examples:
  coordinator init press
  coordinator init press --out scenes/press.toml
  coordinator init walker --from klann.linkage2")]
    Init(init::InitArguments),
    /// Show the progress of a running study: workers, queue, rates, R so far
    #[command(after_help = status::EXAMPLES)]
    Status(status::StatusArguments),
    /// Test from this machine what a worker needs to reach a coordinator
    #[command(after_help = doctor::EXAMPLES)]
    Doctor(doctor::DoctorArguments),
    /// List the built-in scenes
    #[command(after_help = "Examples:\n  coordinator scenes\n  coordinator scenes --json")]
    Scenes {
        /// Print the TOML text of this built-in scene, as a start for a new one
        #[arg(long, value_name = "NAME", value_parser = scene_name(), hide_possible_values = true)]
        show: Option<String>,
    },
    /// Draw the mechanism of a scene: SVG, or a sketch in the terminal
    #[command(after_help = draw::EXAMPLES)]
    Draw(draw::DrawArguments),
    /// Print the JSON Schema of scenes, for completion in editors, or of summary.json
    #[command(after_help = "\
An editor with a TOML language server (taplo, Even Better TOML) completes and checks a scene that begins with the line
#:schema ./scene.schema.json

Examples:
  coordinator schema > scene.schema.json
  coordinator schema --results > summary.schema.json")]
    Schema {
        /// Schema of the results in summary.json instead of that of scenes
        #[arg(long)]
        results: bool,
    },
    /// Print the completions of the command line for a shell
    #[command(after_help = "\
Examples:
  coordinator completions bash > ~/.local/share/bash-completion/completions/coordinator
  coordinator completions zsh > _coordinator
  coordinator completions fish > ~/.config/fish/completions/coordinator.fish")]
    Completions {
        /// Shell that reads them
        shell: clap_complete::Shell,
    },
    /// Print the manual page of the program, or write it and those of all commands
    #[command(after_help = "\
Examples:
  coordinator man > coordinator.1
  coordinator man --out ~/.local/share/man/man1")]
    Man {
        /// Write the pages of the program and all commands to this folder
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Validate a scene: all faults with their lines, the linkage through its cycle, the nominal mechanism against its limits
    #[command(after_help = check::EXAMPLES)]
    Check(check::CheckArguments),
    /// Describe the model of a scene, the reasons for it, and its expected cost
    #[command(after_help = "\
Examples:
  coordinator explain flapping-wing
  coordinator explain my.toml --quick
  coordinator explain my.toml --max-error 1%")]
    Explain {
        #[command(flatten)]
        scene: SceneArguments,
        #[command(flatten)]
        accuracy: AccuracyArguments,
        /// Describe the model only: simulate no life
        #[arg(long)]
        quick: bool,
    },
}
