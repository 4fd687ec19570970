"""An FMU (FMI 2.0 or 3.0, co-simulation or model exchange) as a program that gives cycles or lives, by FMPy. The keys `fmu` and `map` of a
scene call it:

    python3 -m hingewise.fmu mechanism.fmu NAME=VARIABLE ...

A NAME is that of an input of the scene, of a field `JOINT.FIELD` of a joint, with `*` for the joint also in the VARIABLE, or of an output,
whose VARIABLE may be in `largest(...)`, `smallest(...)`, `mean(...)` or `last(...)` over the cycle, by default the last value. Without a
mapping a variable has the name itself. Surfaces go to the variables `JOINT.bushing` and `JOINT.journal`, of a guide `JOINT.guide` and
`JOINT.slider`, arrays of FMI 3.0 or `[1]`, `[2]`, ... of FMI 2.0, if the FMU has them. Of a life, whose time in the FMU is that of the request's cycles in seconds, an output has its
values at the checkpoints, over the life so far.
"""

from __future__ import annotations

import difflib
import re
import sys
from bisect import bisect
from collections.abc import Callable, Collection, Iterable
from typing import Any
from zipfile import ZipFile

from .cycle import serve

#: A request of the wear loop, or of a whole life.
Request = dict[str, Any]

#: Of a joint with clearance, and of a guide.
FIELDS = "force_x", "force_y", "angle", "sliding", "eccentricity_x", "eccentricity_y", "force", "moment", "position", "normal"
SURFACES = "bushing", "journal", "guide", "slider"
OVER_CYCLE: dict[str, Callable[[list[float]], float]] = {
    "largest": max,
    "smallest": min,
    "mean": lambda values: sum(values) / len(values),
    "last": lambda values: values[-1],
}


class Refused(SystemExit):
    """What the user can mend: it ends the program, and with it the study."""

    def __init__(self, key: str, message: str) -> None:
        super().__init__(f"simulator.{key}: {message}")


def nearest(name: str, known: Collection[str]) -> str:
    """A hint at the nearest of the known names."""
    found = difflib.get_close_matches(name, known, 1)
    return f"; did you mean {found[0]}?" if found else f"; known: {', '.join(sorted(known)[:20])}"


def mapping_of(arguments: Iterable[str]) -> dict[str, str]:
    """The mapping of `NAME=VARIABLE` arguments."""
    pairs = [argument.split("=", 1) for argument in arguments]
    wrong = next((pair[0] for pair in pairs if len(pair) < 2), None)
    if wrong is not None:
        raise Refused("map", f"{wrong}: expected NAME=VARIABLE")
    return dict(pairs)


class Fmu:
    """A model with the mapping of a scene."""

    def __init__(self, path: str, mapping: dict[str, str], steps: int = 1000, settling: int = 1) -> None:
        try:
            from fmpy import extract, read_model_description
        except ImportError as error:
            raise Refused("fmu", f"{error}; pip install fmpy, or name another Python by simulator.python") from error
        try:
            with ZipFile(path) as archive:
                text = archive.read("modelDescription.xml").decode(errors="replace")
            version = re.search(r'fmiVersion\s*=\s*["\']([^"\']*)', text)
            if version and not re.match(r"2\.0|3\.\d", version[1]):
                raise Refused("fmu", f"{path} is of FMI {version[1]}, expected 2.0 or 3.0")
            self.description = read_model_description(path, validate=False)
            self.folder = extract(path)
        except Exception as error:
            raise Refused("fmu", f"{path} cannot be read: {error}") from error
        self.path, self.checked = path, False
        self.known = {variable.name for variable in self.description.modelVariables}
        self.mapping, self.steps, self.settling = mapping, steps, settling

    def variable(self, name: str, joint: str | None = None) -> str | None:
        """The variable of a name, `None` without one."""
        field = name if joint is None else f"{joint}.{name}"
        pattern = self.mapping.get(f"*.{name}") if joint else None
        found = self.mapping.get(field) or (pattern and pattern.replace("*", joint or "")) or field
        if found in self.known:
            return found
        if field in self.mapping or pattern:
            raise Refused("map", f"{field}: {self.path} has no variable {found}{nearest(found, self.known)}")
        return None

    def output(self, name: str) -> Any:
        """The variable of an output, and what is made of its values."""
        written = self.mapping.get(name, name)
        parts = re.fullmatch(r"(\w+)\((.*)\)", written)
        over, variable = parts.groups() if parts and written not in self.known else ("last", written)
        if over not in OVER_CYCLE:
            raise Refused("map", f"{name}: {over}(...) is not known; known: {', '.join(OVER_CYCLE)}")
        if variable not in self.known:
            raise Refused("map", f"{name}: {self.path} has no variable {variable}{nearest(variable, self.known)}")
        return OVER_CYCLE[over], variable

    def check(self, request: Request, outputs: Any) -> None:
        """Refuses names of the mapping that the request does not have, and inputs that the FMU does not have."""
        sample, joints = request["sample"], request.get("joints", {})
        names = [*sample, *outputs]
        names += [f"{joint}.{field}" for joint in ["*", *joints] for field in FIELDS + SURFACES]
        for name in self.mapping:
            if name not in names:
                raise Refused("map", f"{name} is no input, output or field of a joint{nearest(name, names)}")
        missing = [name for name in sample if not self.variable(name)]
        # With joints, a variable may change those alone.
        if missing and (not joints or len(missing) == len(sample)):
            raise Refused("map", f"{self.path} has no variable {missing[0]}{nearest(missing[0], self.known)}")
        self.checked = True

    def start_values(self, request: Request) -> dict[str, float]:
        """Inputs and surfaces of a request."""
        values = {}
        for name, value in request["sample"].items():
            if found := self.variable(name):
                values[found] = value
        for joint, surfaces in request.get("joints", {}).items():
            for side, radii in surfaces.items():
                if found := self.variable(side, joint):
                    values[found] = radii
                elements = {f"{joint}.{side}[{k}]": radius for k, radius in enumerate(radii, 1)}
                values.update((name, radius) for name, radius in elements.items() if name in self.known)
        return values

    def simulate(self, request: Request, names: list[str], stop: float, interval: float) -> Any:
        """Columns of variables by name, with `time`, up to the time `stop`."""
        from fmpy import simulate_fmu

        found = simulate_fmu(
            self.folder,
            model_description=self.description,
            stop_time=stop,
            output_interval=interval,
            start_values=self.start_values(request),
            output=list(dict.fromkeys(names)),
        )
        return {name: [float(value) for value in found[name]] for name in found.dtype.names}

    def reply(self, request: Request) -> dict[str, Any]:
        """The reply to a request for a life, or for a cycle."""
        is_cycle = "joints" in request
        # A request for a life does not name the outputs.
        of_fmu = [known.name for known in self.description.modelVariables if known.causality == "output"]
        mapped = [name for name in self.mapping if name not in request["sample"]]
        names = request["outputs"] if is_cycle else [*of_fmu, *mapped]
        if not self.checked:
            self.check(request, names)
        outputs = {name: self.output(name) for name in names}
        return self.cycle(request, outputs) if is_cycle else self.life(request, outputs)

    def life(self, request: Request, outputs: Any) -> dict[str, Any]:
        """Values at the checkpoints of a simulation of the whole life."""
        cycles = request["cycles"]
        interval = 10 * cycles[0] / self.steps
        found = self.simulate(request, [variable for _, variable in outputs.values()], cycles[-1], interval)
        ends = [max(1, bisect(found["time"], cycle + 0.5 * interval)) for cycle in cycles]
        of = {name: [over(found[variable][:end]) for end in ends] for name, (over, variable) in outputs.items()}
        return {"outputs": of}

    def cycle(self, request: Request, outputs: Any) -> dict[str, Any]:
        """The last cycle of a simulation that settles before."""
        period = request["period"]
        fields = {(joint, field): self.variable(field, joint) for joint in request["joints"] for field in FIELDS}
        fields = {key: variable for key, variable in fields.items() if variable}
        interval, start = period / self.steps, self.settling * period
        names = [*fields.values(), *(variable for _, variable in outputs.values())]
        found = self.simulate(request, names, start + period, interval)
        first = next(k for k, time in enumerate(found["time"]) if time > start - 0.5 * interval)
        column = {name: values[first:] for name, values in found.items()}
        joints: dict[str, dict[str, list[float]]] = {joint: {} for joint in request["joints"]}
        for (joint, field), variable in fields.items():
            joints[joint][field] = column[variable]
        return {
            "time": [time - start for time in column["time"]],
            "joints": joints,
            "outputs": {name: over(column[variable]) for name, (over, variable) in outputs.items()},
        }


def main() -> None:
    if len(sys.argv) < 2:
        raise SystemExit("usage: python3 -m hingewise.fmu FILE.fmu [NAME=VARIABLE ...]")
    serve(Fmu(sys.argv[1], mapping_of(sys.argv[2:])).reply)


if __name__ == "__main__":
    main()
