//! What a client may send to the coordinator: the messages of the protocol, each in its direction, and nothing else. A client cannot
//! publish notices, answer claims or follow the workers in the coordinator's place, whatever its certificate.

use common::wire::keys;
use serde_json::{Value, json};

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
