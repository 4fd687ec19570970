"""Time that the wear loop takes between the cycles of a program, by a program that gives a cycle in 20 ms.

    python3 loop_overhead.py COORDINATOR

prints a row of Markdown for each contact law and number of instants: requests of five lives of the four-bar, up to its limit of the wear, accuracy
`draft`, and from a reply to the next request the median time, and the median of the processor's time (Linux), which other programs of the machine
hardly change. In it are reading the reply, the wear of the block, and writing the request; finer copies of the surfaces, from which the error of
the wear is stated, are worn while the program simulates.
"""

import json
import os
import subprocess
import sys
import tempfile
from math import cos, sin, tau
from pathlib import Path
from statistics import median
from time import perf_counter, sleep

CYCLE = 0.02
PERIOD = 1 / 15
SCENE = Path(__file__).resolve().parents[1] / "examples" / "four-bar" / "mujoco.toml"
PROGRAM = 'program = ["python3", "mujoco_cycle.py"]'


def processor_time():
    """Time of the processor that the threads of the process around this one have used [s]."""
    tasks = Path(f"/proc/{os.getppid()}/task").glob("*/schedstat")
    return {task.parent.name: 1e-9 * int(task.read_text().split()[0]) for task in tasks}


def serve(instants, log):
    """Cycles of forces that turn once, on the surfaces as they are; the waiting times go to the file `log`."""
    time = [PERIOD * k / instants for k in range(instants)]
    turn = [tau * k / instants for k in range(instants)]
    waits, asked, used = [], None, {}
    for line in iter(sys.stdin.readline, ""):
        if asked is not None:
            waited = perf_counter() - asked
            waits.append((waited, sum(now - used.get(task, 0.0) for task, now in processor_time().items())))
        Path(log).write_text(json.dumps(waits))
        begun = perf_counter()
        request = json.loads(line)
        joints = {}
        for name, radii in request["joints"].items():
            size = 20 * max(radii["bushing"]) / min(radii["journal"])
            joints[name] = {
                "force_x": [size * (2 + cos(angle)) for angle in turn],
                "force_y": [size * sin(angle) for angle in turn],
                "angle": turn,
            }
        outputs = {"coupler_joint_speed": 44.5}
        reply = json.dumps({"id": request["id"], "time": time, "joints": joints, "outputs": outputs})
        sleep(max(0.0, CYCLE - (perf_counter() - begun)))
        used = processor_time()
        asked = perf_counter()
        print(reply, flush=True)


def measured(coordinator, law, instants):
    """Waiting times of a life [s]."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "waits.json"
        command = [sys.executable, str(Path(__file__).resolve()), "serve", str(instants), str(log)]
        text = SCENE.read_text().replace(PROGRAM, f"program = {json.dumps(command)}")
        text = text.replace('"reaction"', '"contact"').replace('"local-hertz"', f'"{law}"')
        scene = Path(folder) / "overhead.toml"
        scene.write_text(text)
        subprocess.run([coordinator, "simulate", str(scene)], check=True, capture_output=True)
        return json.loads(log.read_text())


if __name__ == "__main__":
    if sys.argv[1] == "serve":
        serve(int(sys.argv[2]), sys.argv[3])
    else:
        print("| contact law | instants | requests | time [ms] | processor [ms] | of a cycle of 20 ms |\n|---|---|---|---|---|---|")
        for law in ("local-hertz", "foundation"):
            for instants in (100, 300, 1000):
                waits = [wait for _ in range(5) for wait in measured(sys.argv[1], law, instants)]
                time, used = (1e3 * median(column) for column in zip(*waits))
                print(f"| {law} | {instants} | {len(waits) + 5} | {time:.2f} | {used:.2f} | {0.1 * time / CYCLE:.1f} % |")
