//! Endpoint and Zenoh configuration of the coordinator: loopback by default; other addresses require authenticated
//! clients or `--insecure`. A client may send the messages of the protocol, each in its direction, and nothing else: it cannot publish
//! notices, answer claims or follow the workers in the coordinator's place, whatever its certificate.

use super::super::DispatchError;
use common::wire::{MAX_MESSAGE, MAX_SESSIONS, keys, reason};
use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use serde_json::{Value, json};
use std::net::IpAddr;
use std::path::PathBuf;
use zenoh::Config;

/// Loopback address with any free port.
const DEFAULT_ENDPOINT: &str = "tcp/127.0.0.1:0";

/// Zenoh settings the coordinator requires: it is the only listener, and workers do not connect to each other (64 meshed
/// peers took 369 MB and 15 s to close).
const ZENOH_SETTINGS: [(&str, &str); 5] = [
    ("mode", "\"peer\""),
    ("scouting/multicast/enabled", "false"),
    ("scouting/gossip/enabled", "false"),
    ("scouting/delay", "0"),
    ("transport/link/rx/max_message_size", MAX_MESSAGE),
];

/// Key of the number of sessions that are accepted.
const SESSIONS: &str = "transport/unicast/max_sessions";
/// Key of the number of sessions that may be in the process of opening; Zenoh closes further connections without a reason.
const OPENING: &str = "transport/unicast/accept_pending";

/// Key of the time limit for accepting a session [ms]. Zenoh 1.10.2 drops a session at that limit wherever it is: one that has been confirmed
/// to the worker and is not yet read stays half open, with signs of life and without messages. Zenoh's default of 10 s is exceeded when
/// thousands of workers connect at once.
const ACCEPTING: &str = "transport/unicast/accept_timeout";
/// Time limit for accepting a session [ms].
const ACCEPT_LIMIT: u32 = 300_000;

/// Where and how the coordinator listens.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Listen {
    /// Endpoint, e.g. `tcp/192.168.1.20:7447`; `None`: the endpoints of the configuration file, otherwise loopback with a
    /// free port.
    pub endpoint: Option<String>,
    /// File with further Zenoh settings (JSON5), e.g. certificates; the settings required here override it.
    pub config: Option<PathBuf>,
    /// Whether unauthenticated clients may connect from other machines.
    pub insecure: bool,
}

/// Builds the configuration of the session; returns it with the endpoints of the coordinator.
///
/// # Errors
/// [`DispatchError::Configuration`], [`DispatchError::Endpoint`], [`DispatchError::Insecure`].
pub(super) fn transport_settings(listen: &Listen) -> Result<(Config, Vec<String>), DispatchError> {
    let mut config = sessions::configuration(listen.config.as_deref()).map_err(|error| {
        DispatchError::Configuration(listen.config.clone().unwrap_or_default(), reason(error))
    })?;
    let endpoints = match &listen.endpoint {
        Some(endpoint) => vec![endpoint.clone()],
        None => endpoints_of(&config).unwrap_or_else(|| vec![DEFAULT_ENDPOINT.into()]),
    };
    for endpoint in &endpoints {
        if !listen.insecure && !is_loopback(endpoint)? && !authenticates_clients(&config, endpoint) {
            return Err(DispatchError::Insecure(endpoint.clone()));
        }
    }
    if config.get_json("access_control/enabled").is_ok_and(|enabled| enabled == "false") {
        config.insert_json5("access_control", &permissions().to_string()).map_err(messaging)?;
    }
    let json = serde_json::Value::from(endpoints.clone()).to_string();
    config
        .insert_json5("listen/endpoints", &json)
        .map_err(|error| DispatchError::Endpoint(endpoints.join(", "), reason(error)))?;
    for (key, value) in ZENOH_SETTINGS {
        config.insert_json5(key, value).map_err(messaging)?;
    }
    // Zenoh's defaults are replaced; other numbers come from the configuration file.
    for (key, number) in [(SESSIONS, MAX_SESSIONS), (OPENING, MAX_SESSIONS), (ACCEPTING, ACCEPT_LIMIT)] {
        if config.get_json(key).ok() == Config::default().get_json(key).ok() {
            config.insert_json5(key, &number.to_string()).map_err(messaging)?;
        }
    }
    let wanted =
        config.get_json(SESSIONS).ok().and_then(|number| number.parse().ok()).unwrap_or(MAX_SESSIONS);
    let sessions = bounded_by_open_files(wanted);
    config.insert_json5(SESSIONS, &sessions.to_string()).map_err(messaging)?;
    Ok((config, endpoints))
}

/// The error of a failed call of Zenoh.
pub(super) fn messaging(error: zenoh::Error) -> DispatchError {
    DispatchError::Messaging(reason(error))
}

/// Endpoints that a configuration file lists for all modes; Zenoh's default lists them by mode.
fn endpoints_of(config: &Config) -> Option<Vec<String>> {
    let json = config.get_json("listen/endpoints").ok()?;
    serde_json::from_str::<Vec<String>>(&json).ok().filter(|endpoints| !endpoints.is_empty())
}

fn is_loopback(endpoint: &str) -> Result<bool, DispatchError> {
    let wrong = |reason: &str| DispatchError::Endpoint(endpoint.into(), reason.into());
    let (_, address) = endpoint.split_once('/').ok_or_else(|| wrong("not an endpoint"))?;
    let address = address.split(['?', '#']).next().unwrap_or(address);
    let (host, _) = address.rsplit_once(':').ok_or_else(|| wrong("no port"))?;
    let host = host.trim_start_matches('[').trim_end_matches(']');
    Ok(host == "localhost" || host.parse::<IpAddr>().is_ok_and(|address| address.is_loopback()))
}

/// True if a listener authenticates its clients on an encrypted connection: TLS with client certificates or with a
/// dictionary of users.
fn authenticates_clients(config: &Config, endpoint: &str) -> bool {
    let set = |key: &str| config.get_json(key).is_ok_and(|value| value != "null");
    let users = set("transport/auth/usrpwd/dictionary_file");
    let certificates = config.get_json("transport/link/tls/enable_mtls").is_ok_and(|value| value == "true");
    endpoint.starts_with("tls/") && (users || certificates)
}

/// Files that are not sessions: campaign file, log and pages, and what Zenoh and the system need.
const OTHER_FILES: u64 = 200;

/// The number of sessions for which files can be opened, at most `sessions`: raises the soft limit of this process up to
/// the hard one if it is too low, and logs a warning if that is not enough.
pub(super) fn bounded_by_open_files(sessions: u32) -> u32 {
    let wanted = u64::from(sessions) + OTHER_FILES;
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    // `None`: no limit.
    if current.is_none_or(|current| current >= wanted) {
        return sessions;
    }
    let raised = maximum.map_or(wanted, |maximum| maximum.min(wanted));
    let limit = match setrlimit(Resource::Nofile, Rlimit { current: Some(raised), maximum }) {
        Ok(()) => raised,
        Err(_) => current.unwrap_or(wanted),
    };
    let possible = sessions_within(limit).min(sessions);
    if possible < sessions {
        tracing::warn!(
            "at most {possible} workers can connect instead of {sessions}: this process may open {limit} files (ulimit -n)"
        );
    }
    possible
}

/// Sessions within a limit of open files; at least one.
fn sessions_within(limit: u64) -> u32 {
    u32::try_from(limit.saturating_sub(OTHER_FILES)).unwrap_or(u32::MAX).max(1)
}

/// Zenoh's `access_control` for all clients, unless the configuration file has its own.
pub(super) fn permissions() -> Value {
    let rule = |id: &str, flow: &str, messages: &[&str], keys: &[&str]| json!({ "id": id, "permission": "allow", "flows": [flow], "messages": messages, "key_exprs": keys });
    let queries = [keys::CLAIM, keys::STATUS];
    let rules = [
        rule("claims", "ingress", &["query"], &queries),
        rule("life", "ingress", &["liveliness_token"], &[keys::ALIVE_ALL]),
        rule("hearing", "ingress", &["declare_subscriber"], &[keys::NOTICE]),
        rule("answers", "egress", &["reply", "declare_queryable"], &queries),
        rule("notices", "egress", &["put"], &[keys::NOTICE]),
        // Routers pass on the tokens of the workers behind them.
        rule("routers", "egress", &["liveliness_query", "declare_liveliness_subscriber"], &[keys::ALIVE_ALL]),
        // Tools that look for coordinators.
        rule(
            "looking",
            "ingress",
            &["liveliness_query", "declare_liveliness_subscriber"],
            &[keys::COORDINATOR],
        ),
        rule("being", "egress", &["liveliness_token"], &[keys::COORDINATOR]),
    ];
    let ids: Vec<&Value> = rules.iter().map(|rule| &rule["id"]).collect();
    json!({
        "enabled": true,
        "default_permission": "deny",
        "rules": rules,
        "subjects": [{ "id": "all" }],
        "policies": [{ "subjects": ["all"], "rules": ids }],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn with_config(text: &str, endpoint: Option<&str>) -> Result<(Config, Vec<String>), DispatchError> {
        let mut file = tempfile::Builder::new().suffix(".json5").tempfile().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        let config = Some(file.path().to_owned());
        transport_settings(&Listen { endpoint: endpoint.map(Into::into), config, insecure: false })
    }

    fn listen(endpoint: &str, insecure: bool) -> Result<(Config, Vec<String>), DispatchError> {
        transport_settings(&Listen { endpoint: Some(endpoint.into()), config: None, insecure })
    }

    #[test]
    fn the_default_is_loopback_with_a_free_port() {
        let settings = transport_settings(&Listen::default()).unwrap();
        assert_eq!(settings.1, ["tcp/127.0.0.1:0"]);
        assert_eq!(settings.0.get_json("listen/endpoints").unwrap(), r#"["tcp/127.0.0.1:0"]"#);
        assert_eq!(settings.0.get_json("mode").unwrap(), r#""peer""#);
    }

    #[test]
    fn bounds_of_sessions_are_ours_unless_the_file_sets_them() {
        let number = |key: &str, text: &str| {
            let settings = with_config(text, None).unwrap();
            settings.0.get_json(key).unwrap().parse::<u32>().unwrap()
        };
        assert_eq!(number(SESSIONS, "{}"), bounded_by_open_files(MAX_SESSIONS));
        assert_eq!(number(SESSIONS, "{ transport: { unicast: { max_sessions: 12 } } }"), 12);
        assert_eq!(number(ACCEPTING, "{}"), ACCEPT_LIMIT);
        assert_eq!(number(ACCEPTING, "{ transport: { unicast: { accept_timeout: 500 } } }"), 500);
    }

    #[test]
    fn clients_have_the_permissions_of_the_protocol_unless_the_file_has_others() {
        let rules = |text: &str| {
            let settings = with_config(text, None).unwrap();
            assert_eq!(settings.0.get_json("access_control/enabled").unwrap(), "true");
            serde_json::from_str::<serde_json::Value>(&settings.0.get_json("access_control/rules").unwrap())
                .unwrap()
        };
        assert_eq!(rules("{}").as_array().unwrap().len(), permissions()["rules"].as_array().unwrap().len());
        let own = r#"{ access_control: { enabled: true, default_permission: "deny", policies: [], subjects: [], rules: [] } }"#;
        assert_eq!(rules(own), serde_json::json!([]));
    }

    #[test]
    fn loopback_needs_no_authentication_and_everything_else_does() {
        for endpoint in ["tcp/127.0.0.1:0", "tcp/127.8.8.8:1", "tcp/[::1]:7447", "tcp/localhost:7447"] {
            assert!(listen(endpoint, false).is_ok(), "{endpoint}");
        }
        for endpoint in ["tcp/0.0.0.0:7447", "tcp/[::]:0", "tcp/192.168.1.20:7447#iface=lo", "tcp/host:1"] {
            let error = listen(endpoint, false).unwrap_err();
            assert!(matches!(&error, DispatchError::Insecure(named) if named == endpoint));
            assert!(error.to_string().contains("--insecure"));
            assert!(listen(endpoint, true).is_ok(), "{endpoint}");
        }
    }

    #[test]
    fn authentication_opens_other_addresses() {
        let users = r#"{ transport: { auth: { usrpwd: { dictionary_file: "users.txt" } } } }"#;
        assert!(with_config(users, Some("tls/0.0.0.0:7447")).is_ok());
        // Without encryption, an eavesdropper could take over the session of an authenticated user.
        assert!(matches!(with_config(users, Some("tcp/0.0.0.0:7447")), Err(DispatchError::Insecure(..))));
        let mtls = r#"{ transport: { link: { tls: { enable_mtls: true } } } }"#;
        assert!(with_config(mtls, Some("tls/0.0.0.0:7447")).is_ok());
        assert!(matches!(with_config(mtls, Some("tcp/0.0.0.0:7447")), Err(DispatchError::Insecure(..))));
    }

    #[test]
    fn endpoints_of_the_file_count_unless_one_is_given() {
        let file = r#"{ mode: "router", listen: { endpoints: ["tcp/127.0.0.1:4000"] } }"#;
        let settings = with_config(file, None).unwrap();
        assert_eq!(settings.1, ["tcp/127.0.0.1:4000"]);
        assert_eq!(settings.0.get_json("mode").unwrap(), r#""peer""#);
        assert_eq!(with_config(file, Some("tcp/127.0.0.1:0")).unwrap().1, ["tcp/127.0.0.1:0"]);
        let open = r#"{ listen: { endpoints: ["tcp/0.0.0.0:4000"] } }"#;
        assert!(matches!(with_config(open, None), Err(DispatchError::Insecure(..))));
    }

    #[test]
    fn invalid_endpoints_and_configurations_are_refused() {
        for endpoint in ["127.0.0.1:0", "tcp/nowhere"] {
            assert!(matches!(listen(endpoint, false), Err(DispatchError::Endpoint(..))), "{endpoint}");
        }
        assert!(matches!(with_config("{ nonsense", None), Err(DispatchError::Configuration(..))));
    }

    #[test]
    fn the_soft_limit_is_raised_as_far_as_needed() {
        let before = getrlimit(Resource::Nofile);
        let possible = bounded_by_open_files(700);
        let after = getrlimit(Resource::Nofile);
        assert_eq!(after.maximum, before.maximum);
        assert!(after.current.is_none_or(|current| current >= u64::from(possible) + OTHER_FILES));
        assert_eq!(bounded_by_open_files(1), 1);
    }

    #[test]
    fn a_low_limit_leaves_files_for_the_rest() {
        assert_eq!(sessions_within(1024), 824);
        assert_eq!(sessions_within(10), 1);
        assert_eq!(sessions_within(u64::MAX), u32::MAX);
    }
}
