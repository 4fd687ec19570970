//! Changed frames of Zenoh on their way to a coordinator: `cargo run --release -p tests --example mutated_frames [MINUTES] [SEED] [FRAMES]`,
//! over TCP and, where `openssl` is installed, through mutual TLS: a tenth of the time those of real clients, then recorded sessions, until
//! FRAMES (500000) were changed. Prints how many were changed and what ended the coordinator. Build the programs first:
//! `cargo build --release`.

use std::collections::BTreeMap;
use std::error::Error;
use std::time::{Duration, Instant};
use tests::deployed::{HOST, certificates, configuration, has_openssl};
use tests::mutated_frames::{Attack, random_changes};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let minutes: f64 = arguments.next().map_or(Ok(5.0), |text| text.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    let frames: u64 = arguments.next().map_or(Ok(500_000), |text| text.parse())?;
    for with_tls in [false, true] {
        if with_tls && !has_openssl("frames through TLS") {
            continue;
        }
        let folder = tempfile::tempdir()?;
        let tls = with_tls.then(|| {
            let own = certificates(folder.path(), HOST);
            (configuration("zenoh-tls.json5", &own), own)
        });
        let mut attack = Attack::start(folder.path(), tls);
        let begun = Instant::now();
        let time = |share: f64| begun + Duration::from_secs_f64(share * 30.0 * minutes);
        let figures = attack.run(u64::MAX / 2, time(0.1), random_changes(seed));
        let (of_clients, in_time) = (figures.changed, begun.elapsed().as_secs_f64());
        println!("TLS {with_tls}: {of_clients} changed frames of real clients in {in_time:.0} s");
        let figures = attack.replay(frames, time(1.0), &random_changes(seed + 1));
        let (sessions, changed, ends) = (figures.sessions, figures.changed, figures.ends.len());
        println!(
            "TLS {with_tls}: {sessions} sessions, {changed} changed frames in {:.0} s, {ends} ends of the coordinator, each resumed",
            begun.elapsed().as_secs_f64()
        );
        let mut causes = BTreeMap::new();
        for end in &figures.ends {
            // Without thread and folder: `zenoh-1.10.2/src/net/routing/dispatcher/resource.rs:833:22`.
            let place = end.split_once("panicked at ").map(|(_, path)| path.trim_end_matches(':'));
            let place = place.map(|path| path.find("/zenoh").map_or(path, |at| &path[at + 1..]));
            let cause = place.map_or_else(|| end.clone(), |place| format!("panic at {place}"));
            *causes.entry(cause).or_insert(0) += 1;
        }
        for (cause, count) in causes {
            println!("  {count} times: {cause}");
        }
    }
    Ok(())
}
