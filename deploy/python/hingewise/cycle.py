"""Programs that give cycles to the wear loop of Hingewise: requests of standard input, replies on standard output.

A request has the sample by name, the worn surfaces of every joint (radii at control points, of guides depths [m]), the cycles worn so far, the name of the
accuracy and the period [s]; a reply the contacts of every joint over one cycle and the outputs of its motion:
coordinator/doc/cycles.md.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable
from math import cos, sin
from typing import Any


def serve(cycle: Callable[[dict[str, Any]], dict[str, Any]]) -> None:
    """Answer every request by `cycle(request)`, which returns a dictionary with `joints` and `outputs`.

    An error of `cycle` is the failure of its sample. What it prints goes to standard error, since it is no reply.
    """
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    for line in sys.stdin:
        request = json.loads(line)
        try:
            reply = cycle(request)
        except Exception as error:  # whatever a multibody program raises
            reply = {"failure": f"{type(error).__name__}: {error}"}
        print(json.dumps({"id": request["id"], **reply}), file=replies, flush=True)


def in_frame(forces: Iterable[tuple[float, float]], angles: Iterable[float]) -> dict[str, list[float]]:
    """Global forces `(n, 2)` [N] in a frame turned by `angles` `(n,)` [rad]: the columns of a joint."""
    turned = [(x * cos(a) + y * sin(a), y * cos(a) - x * sin(a)) for (x, y), a in zip(forces, angles)]
    return {"force_x": [x for x, _ in turned], "force_y": [y for _, y in turned]}
