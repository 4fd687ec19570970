//! A network cut between a coordinator and two hosts, each in a separate network namespace.

use super::{LONGEST, Report, report_end, wait_for_records};
use crate::process::Process;
use crate::{program, skipped};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Network namespaces, deleted when dropped.
struct Network {
    names: [String; 3],
}

fn ip(arguments: &str) -> bool {
    let status = Command::new("ip").args(arguments.split(' ')).stderr(Stdio::null()).status();
    status.is_ok_and(|status| status.success())
}

impl Network {
    /// Namespaces of the coordinator and of two hosts linked to it; `None` without the permission.
    fn build() -> Option<Self> {
        let process = std::process::id();
        let network = Network { names: ["c", "a", "b"].map(|name| format!("hw{process}{name}")) };
        let [centre, hosts @ ..] = &network.names;
        if !ip(&format!("netns add {centre}")) {
            return None;
        }
        let mut built = ip(&format!("-n {centre} link set lo up"));
        for (k, host) in hosts.iter().enumerate() {
            let subnet = format!("10.77.{k}");
            for step in [
                format!("netns add {host}"),
                format!("-n {host} link set lo up"),
                format!("-n {centre} link add to{k} type veth peer name line netns {host}"),
                format!("-n {centre} addr add {subnet}.1/24 dev to{k}"),
                format!("-n {host} addr add {subnet}.2/24 dev line"),
                format!("-n {centre} link set to{k} up"),
                format!("-n {host} link set line up"),
            ] {
                built &= ip(&step);
            }
        }
        built.then_some(network)
    }

    /// Command that runs a process of the study in namespace number `place`.
    fn command(&self, place: usize, arguments: &[&str]) -> Command {
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &self.names[place]]).arg(program("practice_study")).args(arguments);
        command
    }

    /// Sets the link to host `k` up or down.
    fn set_link(&self, k: usize, state: &str) {
        assert!(ip(&format!("-n {} link set to{k} {state}", self.names[0])), "the link could not be set");
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        for name in &self.names {
            ip(&format!("netns del {name}"));
        }
    }
}

/// Cuts the link to one of the hosts for each of these times in turn. `None` if no namespaces can be made.
pub fn cut_network(cuts: &[Duration], samples: usize, takes: Duration) -> Option<Report> {
    let Some(network) = Network::build() else {
        skipped("a cut network", "network namespaces can be made by root only, with the program ip");
        return None;
    };
    let folder = tempfile::tempdir().expect("there is room for a folder");
    let dir = folder.path().to_str().expect("it is text").to_owned();
    let (all, milliseconds) = (samples.to_string(), takes.as_millis().to_string());
    let mut centre =
        Process::start(&mut network.command(0, &["coordinator", &dir, "tcp/0.0.0.0:7447", &all]));
    let hosts = ["near", "far"].map(|name| {
        let k = usize::from(name == "far");
        let endpoint = format!("tcp/10.77.{k}.1:7447");
        Process::start(&mut network.command(1 + k, &["worker", &endpoint, name, &milliseconds]))
    });
    centre.line("there", 2, LONGEST).expect("both connect");
    for (n, cut) in cuts.iter().enumerate() {
        wait_for_records(folder.path(), (n + 1) * samples / (2 * (cuts.len() + 1)));
        network.set_link(1, "down");
        std::thread::sleep(*cut);
        let before = hosts[1].lines("started").len();
        network.set_link(1, "up");
        hosts[1].line("started", before + 1, LONGEST).expect("it works again");
    }
    let report = report_end(&mut centre, folder.path(), samples);
    let begun: usize = hosts.iter().map(|host| host.lines("started").len()).sum();
    let seconds: Vec<String> = cuts.iter().map(|cut| format!("{:.0} s", cut.as_secs_f64())).collect();
    let repeated = begun.saturating_sub(samples + 1);
    let (seconds, all) = (seconds.join(" and "), samples + 1);
    let text = format!("cut for {seconds}: {repeated} of {all} evaluations done twice");
    Some(Report { text, repeated, ..report })
}
