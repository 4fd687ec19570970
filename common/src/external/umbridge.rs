//! Evaluations by a model server with the UM-Bridge protocol, one concurrent request per slot.
//!
//! The random variables fill the input vectors of the model in order. The output vectors, concatenated, are cut into
//! the outputs of the scene in order: each output has one value per checkpoint, or a single value.
//!
//! A model that gives cycles has the input vectors: random variables, then radii of bushing and journal of every joint; and the output
//! vectors: outputs of the scene that it gives, if any, instants, then of every joint the first three, four or all six of
//! [`super::joint_cycle::CycleSurfaces::fields`].
//!
//! # Source
//! See [`crate::umbridge`].

use super::cycle_reply::ExpectedCycle;
use super::cycle_request::CycleLine;
use super::reply::{Expected, NoResult, outcome, parse, shown};
use super::slot::{SampleResult, SimulatorError, Slot, SlotError, SlotRequest, StopSignal};
use crate::failure::SimulationFailure;
use crate::scene::{Scene, UmBridgeModel};
use crate::umbridge as protocol;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;
use ureq::Agent;

/// Timeout of requests for name, sizes and support of a model.
const INFO_TIMEOUT: Duration = Duration::from_secs(30);
/// Attempts at a request that gets no reply, or a server error (HTTP 5xx) that is no UM-Bridge reply.
const ATTEMPTS: u32 = 3;
/// Pause between two attempts.
const PAUSE: Duration = Duration::from_secs(1);
/// Longest reply [bytes].
const LONGEST_REPLY: u64 = 256 << 20;
/// Kinds of error that blame the request, not the sample.
const REFUSALS: [&str; 4] = [
    protocol::INVALID_INPUT,
    protocol::INVALID_OUTPUT,
    protocol::MODEL_NOT_FOUND,
    protocol::UNSUPPORTED_FEATURE,
];

/// The error of a model that does not fit the scene.
fn unfit(fault: String) -> SimulatorError {
    SimulatorError::of_key("model", fault)
}

/// Client of a server whose model fits the scene.
#[derive(Debug)]
pub struct UmBridgeClient {
    agent: Agent,
    model: UmBridgeModel,
    config: Value,
    /// Number of levels, whose number the configuration gets; 0 without any.
    levels: usize,
    /// Time limit of one evaluation as stated in the scene [s].
    seconds: f64,
    timeout: Duration,
    expected: Expected,
    input_sizes: Vec<usize>,
    output_sizes: Vec<usize>,
}

/// The error of an address that cannot be reached, or whose reply is no UM-Bridge reply, for this reason.
fn unanswered(url: &str, reason: String) -> SimulatorError {
    SimulatorError::of_key("umbridge", format!("{url}: {reason}"))
}

/// Status and body of an HTTP reply.
type HttpReply = (u16, String);

impl UmBridgeClient {
    /// Connects to a server; checks protocol version, model name, support of evaluation, and sizes against the scene.
    ///
    /// # Errors
    /// [`SimulatorError`]: the server cannot be reached, or its model does not fit the scene.
    pub fn open(model: &UmBridgeModel, timeout: f64, scene: &Scene) -> Result<Self, SimulatorError> {
        let agent = Agent::new_with_config(
            Agent::config_builder().http_status_as_error(false).user_agent("hingewise").build(),
        );
        let config = serde_json::to_value(&model.config).unwrap_or_else(|_| json!({}));
        let levels = scene.simulator.as_ref().map_or(0, |simulator| simulator.levels.len());
        let mut client = Self {
            agent,
            config,
            levels,
            seconds: timeout,
            timeout: Duration::try_from_secs_f64(timeout).unwrap_or(Duration::MAX),
            expected: Expected::from_scene(scene),
            model: model.clone(),
            input_sizes: vec![],
            output_sizes: vec![],
        };
        let (url, name) = (&model.url, &model.model);
        let info: protocol::Info = client.query("Info", None)?;
        let (found, expected) = (info.protocol_version, protocol::PROTOCOL_VERSION);
        if found != expected {
            let fault = format!("{url} uses version {found} of the protocol, expected {expected}");
            return Err(SimulatorError::of_key("umbridge", fault));
        }
        if !info.models.contains(name) {
            let known = info.models.join(", ");
            return Err(unfit(format!("{url} has no model \"{name}\"; it has: {known}")));
        }
        let about: protocol::ModelInfo = client.query("ModelInfo", Some(json!({ "name": name })))?;
        if !about.support.evaluate {
            return Err(unfit(format!("model \"{name}\" of {url} does not offer evaluations")));
        }
        let sizes = json!({ "name": name, "config": client.config_of(0) });
        let inputs: protocol::InputSizes = client.query("InputSizes", Some(sizes.clone()))?;
        let outputs: protocol::OutputSizes = client.query("OutputSizes", Some(sizes))?;
        let variables = client.expected.inputs.len();
        let shapes = [inputs.input_sizes, outputs.output_sizes];
        let [taken, given] = shapes.each_ref().map(|sizes| sizes.iter().sum::<usize>());
        let lengths = client.expected.lengths();
        let values = lengths.iter().sum::<usize>();
        let gives_life = scene.simulator.as_ref().is_none_or(|simulator| simulator.cycles.is_none());
        if !gives_life {
            if let Some((sizes, expected)) = ExpectedCycle::from_scene(scene).misfit(variables, &shapes) {
                return Err(client.other_vectors(&sizes, &expected));
            }
        } else if taken != variables {
            return Err(unfit(format!(
                "model \"{name}\" takes {taken} input values {:?}, the scene has {variables} variables",
                shapes[0]
            )));
        } else if given != values {
            return Err(unfit(format!(
                "model \"{name}\" returns {given} output values {:?}, the outputs of the scene have {values} {lengths:?}",
                shapes[1]
            )));
        }
        [client.input_sizes, client.output_sizes] = shapes;
        Ok(client)
    }

    /// The error of a model whose vectors are not those of the scene.
    fn other_vectors(&self, sizes: &[usize], expected: &str) -> SimulatorError {
        unfit(format!("model \"{}\" has vectors of {sizes:?} values, expected {expected}", self.model.model))
    }

    /// Queries name, sizes or support of the model.
    fn query<T: DeserializeOwned>(&self, path: &str, body: Option<Value>) -> Result<T, SimulatorError> {
        let wrong = |reason| unanswered(&format!("{}/{path}", self.model.url), reason);
        let (status, text) = self.send(path, body.as_ref(), INFO_TIMEOUT).map_err(|none| match none {
            ureq::Error::Timeout(_) => wrong(format!("no reply within {} s", INFO_TIMEOUT.as_secs())),
            other => wrong(other.to_string()),
        })?;
        match serde_json::from_str(&text) {
            Ok(body) if status == 200 => Ok(body),
            _ => Err(wrong(match serde_json::from_str(&text) {
                Ok(protocol::ErrorReply { error }) => format!("{}: {}", error.kind, error.message),
                Err(_) => format!("HTTP status {status}: \"{}\"", shown(&text)),
            })),
        }
    }

    /// Sends one request: `POST` with a body, `GET` without.
    fn send(&self, path: &str, body: Option<&Value>, timeout: Duration) -> Result<HttpReply, ureq::Error> {
        let url = format!("{}/{path}", self.model.url);
        let sent = match body {
            None => self.agent.get(url).config().timeout_global(Some(timeout)).build().call(),
            Some(body) => {
                let request = self.agent.post(url).header("content-type", "application/json");
                request.config().timeout_global(Some(timeout)).build().send(body.to_string())
            }
        };
        let mut response = sent?;
        let body = response.body_mut().with_config().limit(LONGEST_REPLY).lossy_utf8(true);
        let text = body.read_to_string()?;
        Ok((response.status().as_u16(), text))
    }

    /// Configuration of the model at a level.
    fn config_of(&self, level: u8) -> Value {
        let mut config = self.config.clone();
        if self.levels > 0 {
            // Beyond the last is a variant of the scene.
            config["level"] = if usize::from(level) < self.levels { level } else { 0 }.into();
        }
        config
    }

    /// Body of an evaluation request with this configuration: the `values` cut into the model's input vectors.
    fn body(&self, config: &Value, values: &[f64]) -> Value {
        let mut rest = values;
        let mut cut = |size: &usize| {
            let (vector, after) = rest.split_at(*size);
            rest = after;
            vector
        };
        let input: Vec<&[f64]> = self.input_sizes.iter().map(&mut cut).collect();
        json!({ "name": self.model.model, "input": input, "config": config })
    }

    /// Output vectors of a reply.
    fn vectors(&self, (status, text): &HttpReply) -> Result<Vec<Vec<Value>>, NoResult> {
        let said = || shown(text);
        let reply = parse(text).map_err(|_| format!("HTTP status {status}: \"{}\"", said()))?;
        if let Ok(protocol::ErrorReply { error }) = serde_json::from_value(reply.clone()) {
            let message = format!("{}: {}", error.kind, error.message);
            let refused = REFUSALS.contains(&error.kind.as_str());
            return Err(if refused { message.into() } else { NoResult::reported(message) });
        }
        let protocol::Evaluated::<Value> { output } =
            serde_json::from_value(reply).map_err(|_| format!("\"{}\"", said()))?;
        let sizes: Vec<usize> = output.iter().map(Vec::len).collect();
        if sizes != self.output_sizes {
            let expected = &self.output_sizes;
            return Err(format!("it has vectors of {sizes:?} values, the model's are {expected:?}").into());
        }
        Ok(output)
    }
}

/// A slot that sends one evaluation request at a time.
#[derive(Debug)]
pub struct ModelSlot {
    client: Arc<UmBridgeClient>,
    number: usize,
}

impl ModelSlot {
    /// Slot `number` of the client.
    pub fn new(client: Arc<UmBridgeClient>, number: usize) -> Self {
        Self { client, number }
    }

    /// Sends an evaluation request from a separate thread, which is abandoned if the stop signal is set.
    fn send(&self, body: &Value, stop: &StopSignal) -> Result<Result<HttpReply, ureq::Error>, SlotError> {
        let (sender, replies) = channel();
        let (client, body) = (Arc::clone(&self.client), body.clone());
        let send = move || {
            // After a stop the receiver is gone.
            let _ = sender.send(client.send("Evaluate", Some(&body), client.timeout));
        };
        let thread = std::thread::Builder::new().name("umbridge".into()).spawn(send);
        thread.map_err(SlotError::Thread)?;
        let reply = stop.wait(&replies, Duration::MAX).ok_or(SlotError::Stopped)?;
        reply.map_err(|_| SlotError::ThreadEnded("the thread of a request"))
    }

    /// What `read` makes of the output vectors for these `values` of the input vectors, one after another, in evaluation `id`.
    ///
    /// A server that cannot be reached is an error. A server error (HTTP 5xx) that is no UM-Bridge reply counts as a
    /// failed simulation of the sample.
    fn ask<T>(
        &self,
        id: u64,
        (config, values): (&Value, &[f64]),
        stop: &StopSignal,
        read: impl Fn(Vec<Vec<Value>>) -> Result<T, NoResult>,
    ) -> Result<Result<T, SimulationFailure>, SlotError> {
        let body = self.client.body(config, values);
        let url = format!("{}/Evaluate", self.client.model.url);
        for attempt in 1.. {
            let last = attempt == ATTEMPTS;
            match self.send(&body, stop)? {
                Err(ureq::Error::Timeout(_)) => {
                    return Ok(Err(SimulationFailure::TimedOut { seconds: self.client.seconds }));
                }
                Err(reason) if last => return Err(unanswered(&url, reason.to_string()).into()),
                Ok((status, text)) if status >= 500 && parse(&text).is_err() => {
                    if last {
                        let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
                        let message = format!("HTTP status {status}: {}", shown(&text));
                        return Ok(Err(SimulationFailure::Reported { message }));
                    }
                }
                Ok(reply) => {
                    let read = self.client.vectors(&reply).and_then(&read);
                    return outcome(read, |fault| self.broken(id, fault));
                }
                Err(reason) => tracing::debug!("{url}: {reason}"),
            }
            let (_sender, nothing) = channel::<()>();
            if stop.wait(&nothing, PAUSE).is_none() {
                return Err(SlotError::Stopped);
            }
        }
        unreachable!("the last attempt has returned")
    }

    /// The error of a reply that breaks the protocol.
    pub(super) fn broken(&self, id: u64, fault: String) -> SimulatorError {
        let UmBridgeModel { model, url, .. } = &self.client.model;
        SimulatorError::of_reply(&format!("model \"{model}\" of {url}"), id, &fault)
    }

    /// The cycle that `read` makes of a reply, and the reply as an object of JSON, for the values of the inputs and the surfaces of
    /// a request. Its keys other than `sample` and `joints` are added to the configuration.
    ///
    /// # Errors
    /// As [`Slot::evaluate`]; [`SimulatorError`] for surfaces of other numbers of control points than the model takes.
    pub(super) fn ask_cycle<T>(
        &self,
        (id, request): (u64, &CycleLine),
        expected: &ExpectedCycle,
        stop: &StopSignal,
        read: impl Fn(&Map<String, Value>) -> Result<T, NoResult>,
    ) -> Result<Result<(T, String), SimulationFailure>, SlotError> {
        let surfaces = expected.joints.iter().flat_map(|joint| request.joints[&joint.name].both());
        let vectors: Vec<&[f64]> = std::iter::once(request.sample.values).chain(surfaces).collect();
        let sizes: Vec<usize> = vectors.iter().map(|vector| vector.len()).collect();
        if sizes != self.client.input_sizes {
            let expected = format!("{sizes:?} by the control points");
            return Err(self.client.other_vectors(&self.client.input_sizes, &expected).into());
        }
        let mut config = self.client.config.clone();
        config["cycle"] = json!(request.cycle);
        config["condition"] = json!(request.condition);
        config["accuracy"] = json!(request.accuracy);
        config["period"] = json!(request.period);
        self.ask(id, (&config, &vectors.concat()), stop, |vectors| {
            let reply = expected.object_of(vectors);
            Ok((read(&reply)?, Value::Object(reply).to_string()))
        })
    }
}

impl Slot for ModelSlot {
    fn evaluate(&mut self, request: SlotRequest<'_>, stop: &StopSignal) -> Result<SampleResult, SlotError> {
        let SlotRequest { id, level, sample, .. } = request;
        let expected = &self.client.expected;
        self.ask(id, (&self.client.config_of(level), sample), stop, |vectors| {
            expected.evaluation(&expected.by_name(vectors.into_iter().flatten()), None, None)
        })
    }

    fn name(&self) -> String {
        format!("umbridge/{}", self.number)
    }
}
