//! A small simulator of a user: a cantilever that corrodes, over lines of JSON.
//!
//! `beam SECONDS LOG`: each evaluation sleeps for SECONDS; LOG gets a line `begin TIME` and a line `end TIME` for each, in
//! seconds since 1970.

use serde_json::{Value, json};
use std::io::Write;
use std::time::{Duration, SystemTime};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [seconds, log] = &arguments[..] else { panic!("beam SECONDS LOG") };
    let seconds: f64 = seconds.parse().expect("a number of seconds");
    let mut log = std::fs::File::options().create(true).append(true).open(log).expect("the log is writable");
    let mut note = move |what: &str| {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).expect("the clock is right");
        // One write, so that lines of several processes stay whole.
        log.write_all(format!("{what} {}\n", now.as_secs_f64()).as_bytes()).expect("the log is writable");
    };
    for line in std::io::stdin().lines() {
        let request: Value = serde_json::from_str(&line.expect("text")).expect("JSON");
        note("begin");
        std::thread::sleep(Duration::from_secs_f64(seconds));
        let x = |name: &str| request["sample"][name].as_f64().expect("an input");
        let deflection = |years: &Value| {
            let lost = 2.0 * x("corrosion") * years.as_f64().expect("a number of years");
            let (b, h) = (x("width") - lost, x("height") - lost);
            4e3 * x("load") / (x("modulus") * b * h.powi(3))
        };
        let cycles = request["cycles"].as_array().expect("checkpoints");
        let deflection: Vec<f64> = cycles.iter().map(deflection).collect();
        note("end");
        let reply = json!({ "id": request["id"], "outputs": { "deflection": deflection } });
        println!("{reply}");
        std::io::stdout().flush().expect("the reader is there");
    }
}
