"""The reference FMUs of the Modelica Association through `hingewise.fmu`, in FMI 2.0 and 3.0: the same cycle from both.

    python3 reference_fmus.py FOLDER_OF_2 FOLDER_OF_3

The folders are made by the build of github.com/modelica/Reference-FMUs (`cmake -DFMI_VERSION=2 -DWITH_FMUSIM=OFF`).
"""

import json
import subprocess
import sys
from pathlib import Path

# Period [s], an input with its value, and the variable that is asked for.
MODELS = {
    "VanDerPol": (10.0, {"mu": 1.0}, "x0"),
    "Dahlquist": (5.0, {"k": 1.0}, "x"),
    "BouncingBall": (1.5, {"e": 0.7}, "h"),
}

for model, (period, sample, variable) in MODELS.items():
    request = {"id": 1, "cycle": 0, "sample": sample, "accuracy": "balanced", "period": period, "outputs": ["peak"]}
    request["joints"] = {"pin": {"bushing": [1.0, 1.0]}}
    mapping = [f"pin.{field}={variable}" for field in ("force_x", "force_y", "angle")]
    replies = []
    for folder in sys.argv[1:3]:
        fmu = Path(folder) / f"{model}.fmu"
        command = [sys.executable, "-m", "hingewise.fmu", str(fmu), *mapping, f"peak=largest({variable})"]
        done = subprocess.run(command, input=json.dumps(request) + "\n", capture_output=True, text=True, check=True)
        replies.append(json.loads(done.stdout))
    reply = replies[0]
    if "failure" in reply or any(other != reply for other in replies):
        raise SystemExit(f"{model}: {reply.get('failure', 'FMI 2.0 and 3.0 differ')}")
    times, peak = reply["time"], reply["outputs"]["peak"]
    print(f"{model}: {len(replies)} versions of FMI, {len(times)} instants to {times[-1]} s, largest {variable} {peak:.9g}")
