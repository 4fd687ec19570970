//! Evaluations by a model behind the UM-Bridge protocol, as many requests at once as there are slots.
//!
//! The random variables fill the model's input vectors one after another, and the outputs of the scene are cut from its
//! output vectors likewise: an output has a value per checkpoint, or one.

use super::external::SimulatorError;
use super::reply::{Expected, parse, shown};
use super::slots::{NoMessage, Slot, Stop};
use super::{EvaluateError, Outcome, Request};
use common::failure::SimulationFailure;
use common::scene::{Scene, UmBridgeModel};
use common::umbridge as protocol;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;
use ureq::Agent;

/// How long a server may take to say what it is.
const GREETING: Duration = Duration::from_secs(30);
/// How often a request is sent that gets no answer, or only that the server is in trouble.
const ATTEMPTS: u32 = 3;
/// Time between two of them.
const PAUSE: Duration = Duration::from_secs(1);
/// Longest answer [bytes].
const LONGEST_ANSWER: u64 = 256 << 20;
/// Errors by which a server says that the request is wrong, not the sample.
const REFUSALS: [&str; 4] = [
    protocol::INVALID_INPUT,
    protocol::INVALID_OUTPUT,
    protocol::MODEL_NOT_FOUND,
    protocol::UNSUPPORTED_FEATURE,
];

/// A server whose model fits the scene.
#[derive(Debug)]
pub struct Server {
    agent: Agent,
    model: UmBridgeModel,
    config: Value,
    /// Seconds that an evaluation may take, as the scene has them, and as the clock does.
    seconds: f64,
    timeout: Duration,
    expected: Expected,
    input_sizes: Vec<usize>,
    output_sizes: Vec<usize>,
}

/// An HTTP answer.
struct Answer {
    status: u16,
    text: String,
}

/// Why there is no answer.
enum NoAnswer {
    TooLate,
    Broken(String),
}

impl Server {
    /// Asks a server for its models, what the one named offers, and which sizes it has.
    ///
    /// # Errors
    /// [`SimulatorError`]: it does not answer, or not what the scene needs.
    pub fn open(model: &UmBridgeModel, timeout: f64, scene: &Scene) -> Result<Self, SimulatorError> {
        let agent = Agent::new_with_config(
            Agent::config_builder().http_status_as_error(false).user_agent("hingewise").build(),
        );
        let config = serde_json::to_value(&model.config).unwrap_or_else(|_| json!({}));
        let mut server = Self {
            agent,
            config,
            seconds: timeout,
            timeout: Duration::try_from_secs_f64(timeout).unwrap_or(Duration::MAX),
            expected: Expected::of(scene),
            model: model.clone(),
            input_sizes: vec![],
            output_sizes: vec![],
        };
        let url = || model.url.clone();
        let info: protocol::Info = server.told("Info", None)?;
        if info.protocol_version != protocol::PROTOCOL_VERSION {
            let (found, expected) = (info.protocol_version, protocol::PROTOCOL_VERSION);
            return Err(SimulatorError::Version { url: url(), found, expected });
        }
        let name = &model.model;
        if !info.models.contains(name) {
            return Err(SimulatorError::NoModel { url: url(), model: name.clone(), known: info.models });
        }
        let about: protocol::ModelInfo = server.told("ModelInfo", Some(json!({ "name": name })))?;
        if !about.support.evaluate {
            return Err(SimulatorError::NoEvaluation { url: url(), model: name.clone() });
        }
        let sizes = json!({ "name": name, "config": server.config });
        let inputs: protocol::InputSizes = server.told("InputSizes", Some(sizes.clone()))?;
        let outputs: protocol::OutputSizes = server.told("OutputSizes", Some(sizes))?;
        let variables = server.expected.inputs.len();
        if inputs.input_sizes.iter().sum::<usize>() != variables {
            let (model, sizes) = (name.clone(), inputs.input_sizes);
            return Err(SimulatorError::Inputs { model, sizes, variables });
        }
        let lengths = server.expected.lengths();
        if outputs.output_sizes.iter().sum::<usize>() != lengths.iter().sum::<usize>() {
            let (model, sizes) = (name.clone(), outputs.output_sizes);
            return Err(SimulatorError::Outputs { model, sizes, lengths });
        }
        (server.input_sizes, server.output_sizes) = (inputs.input_sizes, outputs.output_sizes);
        Ok(server)
    }

    /// What the server tells of itself at a path.
    fn told<T: DeserializeOwned>(&self, path: &str, body: Option<Value>) -> Result<T, SimulatorError> {
        let wrong = |reason| SimulatorError::Server { url: format!("{}/{path}", self.model.url), reason };
        let answer = self.ask(path, body.as_ref(), GREETING).map_err(|none| match none {
            NoAnswer::TooLate => wrong(format!("no answer within {} s", GREETING.as_secs())),
            NoAnswer::Broken(reason) => wrong(reason),
        })?;
        match serde_json::from_str(&answer.text) {
            Ok(told) if answer.status == 200 => Ok(told),
            _ => Err(wrong(match serde_json::from_str(&answer.text) {
                Ok(protocol::ErrorReply { error }) => format!("{}: {}", error.kind, error.message),
                Err(_) => format!("HTTP status {}: \"{}\"", answer.status, shown(&answer.text)),
            })),
        }
    }

    /// Sends one request: `POST` with a body, `GET` without.
    fn ask(&self, path: &str, body: Option<&Value>, patience: Duration) -> Result<Answer, NoAnswer> {
        let url = format!("{}/{path}", self.model.url);
        let sent = match body {
            None => self.agent.get(url).config().timeout_global(Some(patience)).build().call(),
            Some(body) => {
                let request = self.agent.post(url).header("content-type", "application/json");
                request.config().timeout_global(Some(patience)).build().send(body.to_string())
            }
        };
        let read = sent.and_then(|mut response| {
            let text =
                response.body_mut().with_config().limit(LONGEST_ANSWER).lossy_utf8(true).read_to_string()?;
            Ok(Answer { status: response.status().as_u16(), text })
        });
        read.map_err(|error| match error {
            ureq::Error::Timeout(_) => NoAnswer::TooLate,
            other => NoAnswer::Broken(other.to_string()),
        })
    }

    /// The body of an evaluation: the sample cut into the model's input vectors.
    fn body(&self, sample: &[f64]) -> Value {
        let mut rest = sample;
        let input: Vec<&[f64]> = self
            .input_sizes
            .iter()
            .map(|size| {
                let (vector, after) = rest.split_at(*size);
                rest = after;
                vector
            })
            .collect();
        json!({ "name": self.model.model, "input": input, "config": self.config })
    }

    /// What an answer says: an outcome, or what is wrong with it.
    fn outcome(&self, answer: &Answer) -> Result<Outcome, String> {
        let reply = parse(&answer.text)
            .map_err(|_| format!("HTTP status {}: \"{}\"", answer.status, shown(&answer.text)))?;
        if let Ok(protocol::ErrorReply { error }) = serde_json::from_value(reply.clone()) {
            let told = format!("{}: {}", error.kind, error.message);
            let refused = REFUSALS.contains(&error.kind.as_str());
            return if refused { Err(told) } else { Ok(Err(SimulationFailure::Reported { message: told })) };
        }
        let protocol::Evaluated::<Value> { output } =
            serde_json::from_value(reply).map_err(|_| format!("\"{}\"", shown(&answer.text)))?;
        let sizes: Vec<usize> = output.iter().map(Vec::len).collect();
        if sizes != self.output_sizes {
            return Err(format!(
                "it has vectors of {sizes:?} values, the model's are {:?}",
                self.output_sizes
            ));
        }
        let mut values = output.into_iter().flatten();
        let cut = |((name, _), length): (&(String, bool), usize)| {
            (name.clone(), Value::Array(values.by_ref().take(length).collect()))
        };
        let by_name: Map<String, Value> =
            self.expected.outputs.iter().zip(self.expected.lengths()).map(cut).collect();
        self.expected.evaluation(&by_name, None)
    }
}

/// One request at a time.
#[derive(Debug)]
pub struct ModelSlot {
    server: Arc<Server>,
    number: usize,
}

impl ModelSlot {
    /// Slot `number`.
    pub fn new(server: Arc<Server>, number: usize) -> Self {
        Self { server, number }
    }

    /// Sends an evaluation from a thread of its own, which is left to itself if the user stops.
    fn ask(&self, body: &Value, stop: &Stop) -> Result<Result<Answer, NoAnswer>, EvaluateError> {
        let (sender, answers) = channel();
        let (server, body) = (Arc::clone(&self.server), body.clone());
        let ask = move || {
            // Nobody listens any more after a stop.
            let _ = sender.send(server.ask("Evaluate", Some(&body), server.timeout));
        };
        let thread = std::thread::Builder::new().name("umbridge".into()).spawn(ask);
        thread.map_err(|error| EvaluateError::Transport(format!("cannot start a thread: {error}")))?;
        stop.wait(&answers, Duration::MAX).map_err(|none| match none {
            NoMessage::Stopped => EvaluateError::Interrupted,
            NoMessage::Ended | NoMessage::TooLate => {
                EvaluateError::Transport("a request has vanished".into())
            }
        })
    }

    fn pause(stop: &Stop) -> Result<(), EvaluateError> {
        let (_sender, nothing) = channel::<()>();
        match stop.wait(&nothing, PAUSE) {
            Err(NoMessage::Stopped) => Err(EvaluateError::Interrupted),
            _ => Ok(()),
        }
    }
}

impl Slot for ModelSlot {
    /// A server that cannot be reached ends the batch; one whose model breaks at the sample, without a reason that the
    /// protocol knows, has failed to simulate it.
    fn evaluate(&mut self, request: &Request, stop: &Stop) -> Result<Outcome, EvaluateError> {
        let body = self.server.body(&request.sample);
        let url = format!("{}/Evaluate", self.server.model.url);
        for attempt in 1.. {
            let last = attempt == ATTEMPTS;
            match self.ask(&body, stop)? {
                Err(NoAnswer::TooLate) => {
                    return Ok(Err(SimulationFailure::TimedOut { seconds: self.server.seconds }));
                }
                Err(NoAnswer::Broken(reason)) if last => {
                    return Err(SimulatorError::Server { url, reason }.into());
                }
                Ok(answer) if answer.status >= 500 && parse(&answer.text).is_err() => {
                    if last {
                        let text = answer.text.split_whitespace().collect::<Vec<_>>().join(" ");
                        let message = format!("HTTP status {}: {}", answer.status, shown(&text));
                        return Ok(Err(SimulationFailure::Reported { message }));
                    }
                }
                Ok(answer) => {
                    return self.server.outcome(&answer).map_err(|fault| {
                        let who =
                            format!("model \"{}\" of {}", self.server.model.model, self.server.model.url);
                        SimulatorError::Protocol { who, id: request.id, fault }.into()
                    });
                }
                Err(NoAnswer::Broken(reason)) => tracing::debug!("{url}: {reason}"),
            }
            Self::pause(stop)?;
        }
        unreachable!("the last attempt has returned")
    }

    fn name(&self) -> String {
        format!("umbridge/{}", self.number)
    }
}
