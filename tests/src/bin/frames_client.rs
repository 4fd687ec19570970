//! Clients of a coordinator whose frames are changed on their way: `frames_client SETTINGS NUMBER ENDPOINT...`, a session for each endpoint, the
//! first with this number. See `mutated_frames.rs`.

use std::path::PathBuf;
use tests::mutated_frames::messages_of_a_worker;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let settings = PathBuf::from(arguments.next().expect("a file of settings"));
    let first: u64 = arguments.next().and_then(|text| text.parse().ok()).expect("a number");
    for (number, endpoint) in (first..).zip(arguments) {
        messages_of_a_worker(number, &settings, &endpoint);
    }
}
