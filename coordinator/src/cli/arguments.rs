//! The command line as typed.

use super::accuracy::AccuracyArguments;
use super::benchmark::BenchmarkArguments;
use super::calibrate::CalibrateArguments;
use super::compare::CompareArguments;
use super::doctor::DoctorArguments;
use super::extremes::ExtremesArguments;
use super::init::InitArguments;
use super::monitor::MonitorArguments;
use super::names::{KernelName, LearningName, MethodName, StatedErrorsName, TrendName};
use super::replay::ReplayArguments;
use super::status::StatusArguments;
use super::tradeoff::TradeoffArguments;
use super::verify::VerifyArguments;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// The scene studied unless another one is named.
pub const DEFAULT_SCENE: &str = "flapping-wing";

const EXAMPLES: &str = "\
Examples:
  coordinator --workers auto                       the whole study of the flapping-wing drive, here and now
  coordinator run --scene my.toml --out study      a study of your own mechanism
  coordinator run --workers 0 --listen tcp/127.0.0.1:7447
                                                   wait for `worker --connect tcp/127.0.0.1:7447`
  coordinator resume study                         go on after Ctrl-C, a crash or a power cut
  coordinator run --live 8080                      the report while the study runs, at http://127.0.0.1:8080
  coordinator status tcp/127.0.0.1:7447 --watch    how it is getting on
  coordinator simulate --scene flapping-wing --set rod_length=40.05mm
  coordinator init my                              a commented scene to start from: my.toml
  coordinator check my.toml                        every fault of a scene at once

Exit codes: 0 done, 2 bad input, 1 failure, 130 interrupted (everything done so far is saved).";

/// Hingewise: how reliable is a mechanism whose hinges wear?
///
/// Without a command it runs a study, like `coordinator run`.
#[derive(Debug, Parser)]
#[command(name = "coordinator", version, after_help = EXAMPLES)]
pub struct Arguments {
    /// How much is said.
    #[command(flatten)]
    pub talk: Talk,
    /// Options of a study, when no command is given.
    #[command(flatten)]
    pub run: RunArguments,
    /// What to do.
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// How much is said, and in which form.
#[derive(Debug, Clone, Copy, Args)]
pub struct Talk {
    /// Print results as JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// Log for people, or as lines of JSON for programs that collect logs
    #[arg(long, global = true, value_name = "text|json", default_value = "text")]
    pub log_format: worker::log::Format,
    /// Say nothing but results and errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say more (-v: what happens, -vv: every detail), on standard error
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a reliability study
    #[command(after_help = "\
Examples:
  coordinator run --workers auto
  coordinator run --scene flapping-wing-tolerances --workers 2 --out tolerances --seed 7
  coordinator run --scene my.toml --method monte-carlo --samples 500
  coordinator run --scene four-bar --max-error 1%
  coordinator run --workers 0 --listen tcp/0.0.0.0:7447 --config tls.json5")]
    Run(Box<RunArguments>),
    /// Go on with an interrupted study; no finished evaluation is run again
    #[command(after_help = "Example:\n  coordinator resume hingewise-flapping-wing --workers auto")]
    Resume(ResumeArguments),
    /// Run one evaluation here and now, and print it as JSON
    #[command(after_help = "\
Examples:
  coordinator simulate --scene flapping-wing --out nominal.json
  coordinator simulate --scene flapping-wing --set rod_length=40.05mm --set friction=0.03
  coordinator simulate --scene my.toml --set parameters.crank_speed='500 r/min' --accuracy draft")]
    Simulate(SimulateArguments),
    /// Put a scene's quantities at their extremes, and hold every case against a run at half the time step
    #[command(after_help = "\
Each case either agrees with half the step within the error it states of itself, or is refused with a reason;
anything else is a disagreement, and the exit code is 1.

Examples:
  coordinator extremes --scene four-bar
  coordinator extremes --scene flapping-wing --accuracy draft --out extremes.txt
  coordinator extremes --scene my.toml --json")]
    Extremes(ExtremesArguments),
    /// Measure time against error of the accuracy settings of a scene
    #[command(after_help = "\
Runs the presets and settings around them at the nominal point and at random points of the variables, against `reference`:
time, error of each output, whether the errors that evaluations state hold, and what they mean for the reliability.
Writes tradeoff.md, tradeoff.csv (a line a setting), values.csv (a line a value) and a figure an output to the folder,
and prints tradeoff.md. Interrupted, it writes the points that are complete.

Examples:
  coordinator tradeoff --scene four-bar --out four-bar-tradeoff
  coordinator tradeoff --scene my.toml --settings quick --points 10 --out my-tradeoff
  coordinator tradeoff --setting balanced --setting draft --points 201 --out stated-errors
  coordinator tradeoff --workers 0 --listen tcp/127.0.0.1:7447 --out tradeoff")]
    Tradeoff(TradeoffArguments),
    /// Learn published problems of known failure probability, over several seeds
    #[command(after_help = "\
Prints a table: evaluations needed, failure probability against the published one, in standard errors as stated, and
whether learning ever stopped falsely.

Examples:
  coordinator benchmark
  coordinator benchmark --problem four-branch-7 --seeds 20 --samples 1000000
  coordinator benchmark --problem oscillator --learning u --json")]
    Benchmark(BenchmarkArguments),
    /// Fit free parameters of a scene to measured or published targets
    #[command(after_help = "\
The file names free parameters (keys of the scene, factors on means or on spreads of random variables) with their bounds,
and targets with their tolerances. The report says how well each target is met, how well each parameter is known, how their
uncertainties are correlated, and which targets cannot be met together.

Examples:
  coordinator calibrate --scene my.toml --targets measured.toml
  coordinator calibrate --scene four-bar --targets measured.toml --accuracy draft --rounds 1 --json")]
    Calibrate(Box<CalibrateArguments>),
    /// Hold the surrogates of a study against simulations they have not seen, e.g. those of a direct Monte Carlo
    #[command(after_help = "\
Fits surrogates to the simulations of the first study and lets them classify the very points that the second one simulated, so
that the luck of the draw cancels. Neither study needs to be finished; nothing is simulated.

Examples:
  coordinator run --scene four-bar --out study
  coordinator run --scene four-bar --method monte-carlo --samples 1000 --out direct
  coordinator verify study --against direct
  coordinator verify study --against direct --evaluations 50")]
    Verify(VerifyArguments),
    /// Learn again from the simulations of a direct Monte Carlo run, with its samples as population: every error is known
    #[command(after_help = "\
Shows for every round of learning the error that the surrogates state and the true one, without a new simulation.

Examples:
  coordinator run --scene four-bar --method monte-carlo --samples 1000 --out direct
  coordinator replay direct
  coordinator replay direct --initial 40 --max-evaluations 100 --kernel matern52")]
    Replay(ReplayArguments),
    /// Show what the failure probabilities depend on, from a finished study
    #[command(after_help = "Example:\n  coordinator sensitivity hingewise-flapping-wing --json")]
    Sensitivity(StudyFolder),
    /// Write the result files and the report of a finished study again
    #[command(after_help = "Example:\n  coordinator report hingewise-flapping-wing")]
    Report(StudyFolder),
    /// Lay the reliability curves of several finished studies over each other: variants, contact laws, accuracies
    #[command(after_help = "\
Writes a page with curves and bands per limit state and in total, the lives at R = 0.99, 0.9 and 0.5, and what each study
cost; beside it the curves as CSV, under the same name. The studies need limit states of the same names and the same
checkpoints.

Examples:
  coordinator compare hingewise-four-bar hingewise-four-bar-2 --out compare.html
  coordinator compare steel bronze polymer --out bushings.html")]
    Compare(CompareArguments),
    /// Write a commented scene to start from
    #[command(after_help = "\
Examples:
  coordinator init press
  coordinator init press --out scenes/press.toml")]
    Init(InitArguments),
    /// Show how a running study is getting on: workers, queue, rates, R so far
    #[command(after_help = super::status::EXAMPLES)]
    Status(StatusArguments),
    /// Try from here all that a worker needs of a coordinator, and say what to do where it fails
    #[command(after_help = super::doctor::EXAMPLES)]
    Doctor(DoctorArguments),
    /// List the built-in scenes
    #[command(after_help = "Examples:\n  coordinator scenes\n  coordinator scenes --json")]
    Scenes {
        /// Print the TOML text of this built-in scene instead, as a start for your own
        #[arg(long, value_name = "NAME")]
        show: Option<String>,
    },
    /// Check a scene: every fault at once, and whether the linkage can be assembled through its cycle
    #[command(after_help = "Example:\n  coordinator check my.toml")]
    Check {
        /// Scene file, or name of a built-in scene
        file: String,
    },
    /// Say what will be modelled, and why
    #[command(after_help = "\
Examples:
  coordinator explain --scene flapping-wing
  coordinator explain --scene my.toml --max-error 1%")]
    Explain {
        /// Scene file, or name of a built-in scene
        #[arg(long, default_value = DEFAULT_SCENE, value_name = "NAME-or-FILE")]
        scene: String,
        /// Numerical effort for which the cost is expected
        #[command(flatten)]
        accuracy: AccuracyArguments,
    },
}

/// Options of a study.
#[derive(Debug, Clone, Default, Args, PartialEq)]
pub struct RunArguments {
    /// Scene file, or name of a built-in scene [default: flapping-wing]
    #[arg(long, value_name = "NAME-or-FILE")]
    pub scene: Option<String>,
    /// Where and how to work
    #[command(flatten)]
    pub farm: FarmArguments,
    /// Who may look
    #[command(flatten)]
    pub monitor: MonitorArguments,
    /// Numerical effort
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// How the reliability is found: ak learns a surrogate; monte-carlo and latin-hypercube simulate every sample
    /// [default: ak]
    #[arg(long, value_enum)]
    pub method: Option<MethodName>,
    /// Samples: of the Monte Carlo population that is classified (ak), or simulated (the other methods)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub samples: Option<usize>,
    /// Evaluations of the initial design (ak)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub initial: Option<usize>,
    /// Budget of evaluations (ak)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub max_evaluations: Option<usize>,
    /// Evaluations under way at once after the initial design, proposed by halves; part of the result, so it does not
    /// follow the workers (ak)
    #[arg(long, value_name = "N", value_parser = positive)]
    pub batch: Option<usize>,
    /// Which points are simulated next: those that settle most (gain), or the best by the learning function U, EFF
    /// or H (ak) [default: gain]
    #[arg(long, value_enum)]
    pub learning: Option<LearningName>,
    /// Share of failed simulations above which the study ends, e.g. 20% [default: 20%]
    #[arg(long, value_name = "SHARE", value_parser = super::accuracy::share)]
    pub max_failed: Option<f64>,
    /// Surrogate error of any R at which learning may stop (ak) [default: 0.006, and 2 % of P_f; both follow]
    #[arg(long, value_name = "SHARE", value_parser = super::accuracy::share)]
    pub target_error: Option<f64>,
    /// Seed of every random draw; the same seed gives the same result, whatever the workers
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Kernel of the surrogates' correlation (ak) [default: auto, by cross-validation]
    #[arg(long, value_enum)]
    pub kernel: Option<KernelName>,
    /// Trend of the surrogates (ak) [default: auto, by cross-validation]
    #[arg(long, value_enum)]
    pub trend: Option<TrendName>,
    /// What surrogates make of the errors that simulations state: their shape with a fitted level, nothing, or
    /// standard deviations as they stand (ak) [default: fitted]
    #[arg(long, value_enum)]
    pub stated_errors: Option<StatedErrorsName>,
    /// Folder for the results, made if missing [default: hingewise-SCENE, or the next free number after it]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Options of an interrupted study that may change between its parts; none of them changes its result.
#[derive(Debug, Clone, Args, PartialEq)]
pub struct ResumeArguments {
    /// Folder of the study
    pub dir: PathBuf,
    /// Where and how to work
    #[command(flatten)]
    pub farm: FarmArguments,
    /// Who may look
    #[command(flatten)]
    pub monitor: MonitorArguments,
}

/// Who works, and where they meet.
#[derive(Debug, Clone, Default, Args, PartialEq)]
pub struct FarmArguments {
    /// Local worker slots: a number, `auto` for one per core, 0 to wait for remote workers [default: auto]
    #[arg(long, value_name = "auto|N", value_parser = slots)]
    pub workers: Option<Slots>,
    /// Address on which remote workers may join [default: tcp/127.0.0.1:0, any free port of this machine alone]
    #[arg(long, value_name = "ENDPOINT")]
    pub listen: Option<String>,
    /// Zenoh configuration (JSON5), e.g. for TLS and passwords
    #[arg(long, value_name = "ZENOH.json5")]
    pub config: Option<PathBuf>,
    /// Allow --listen on an address other machines can reach without authentication
    #[arg(long)]
    pub insecure: bool,
}

/// Local worker slots.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slots {
    /// One per core.
    Auto,
    /// So many.
    Count(usize),
}

/// One evaluation.
#[derive(Debug, Clone, Args)]
pub struct SimulateArguments {
    /// Scene file, or name of a built-in scene
    #[arg(long, default_value = DEFAULT_SCENE, value_name = "NAME-or-FILE")]
    pub scene: String,
    /// Set a random variable, or any quantity by its key, e.g. rod_length=40.05mm
    #[arg(long, value_name = "variable=value")]
    pub set: Vec<String>,
    /// Numerical effort
    #[command(flatten)]
    pub accuracy: AccuracyArguments,
    /// Write the JSON to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// A finished study.
#[derive(Debug, Clone, Args)]
pub struct StudyFolder {
    /// Folder of the study
    pub dir: PathBuf,
}

/// A whole number that is not zero.
pub fn positive(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) => Err("allowed: a whole number >= 1".to_owned()),
        Ok(n) => Ok(n),
    }
}

fn slots(text: &str) -> Result<Slots, String> {
    const MOST: usize = 1024;
    match (text, text.parse()) {
        ("auto", _) => Ok(Slots::Auto),
        (_, Ok(n)) if n <= MOST => Ok(Slots::Count(n)),
        _ => Err(format!("allowed: auto, or a whole number from 0 to {MOST}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parse(line: &str) -> Result<Arguments, clap::Error> {
        Arguments::try_parse_from(line.split_whitespace())
    }

    #[test]
    fn the_grammar_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn the_main_job_needs_no_command() {
        let arguments = parse("coordinator --workers auto").unwrap();
        assert!(arguments.command.is_none());
        assert_eq!(arguments.run.farm.workers, Some(Slots::Auto));
        let arguments = parse("coordinator -v run --workers 0 --seed 7 --method monte-carlo").unwrap();
        assert_eq!(arguments.talk.verbose, 1);
        let Some(Command::Run(run)) = arguments.command else { panic!() };
        assert_eq!((run.farm.workers, run.seed), (Some(Slots::Count(0)), Some(7)));
        assert_eq!(run.method, Some(MethodName::MonteCarlo));
    }

    #[test]
    fn slips_are_refused() {
        for line in [
            "coordinator --workers many",
            "coordinator --workers 5000",
            "coordinator run --accuracy exact",
            "coordinator run --accuracy draft --max-error 1%",
            "coordinator run --max-error 0",
            "coordinator simulate --max-error half",
            "coordinator tradeoff --out x --setting draft+jump-x",
            "coordinator tradeoff --out x --setting draft --settings quick",
            "coordinator run --samples 0",
            "coordinator run --seed -1",
            "coordinator resume",
            "coordinator simulate --quiet -v",
            "coordinator tradeof",
        ] {
            assert_eq!(parse(line).unwrap_err().exit_code(), 2, "{line}");
        }
    }
}
