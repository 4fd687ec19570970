//! `evaluate ACCURACY`: one evaluation of the nominal `flapping-wing`. Prints counts of work, then every output at every
//! checkpoint, one line each. Written so that the first version's library compiles it too.

use common::accuracy::Accuracy;
use common::scene::SceneSource;
use worker::simulate::simulate;

fn main() {
    let name = std::env::args().nth(1).expect("the name of an accuracy");
    let accuracy = Accuracy::by_name(&name).expect("the accuracy is known");
    let source = SceneSource::builtin("flapping-wing").expect("built in");
    let found = simulate(source.nominal(), &accuracy, false).expect("the drive can be simulated");
    let d = &found.diagnostics;
    println!("{} {} {}", d.steps, d.rejected_steps, d.simulated_cycles);
    for (output, history) in source.nominal().outputs.iter().zip(&found.histories) {
        let values: Vec<String> = history.iter().map(f64::to_string).collect();
        println!("{} {}", output.name, values.join(" "));
    }
}
