"""An FMU (FMI 2.0 or 3.0, co-simulation or model exchange) as a program that gives cycles, by FMPy.

    python3 -m hingewise.fmu mechanism.fmu NAME=VARIABLE ...

A NAME is that of an input of the scene, of a field `JOINT.FIELD` of a joint, with `*` for the joint also in the VARIABLE, or of an output,
whose VARIABLE may be in `largest(...)`, `smallest(...)`, `mean(...)` or `last(...)` over the cycle, by default the last value. Without a
mapping a variable has the name itself. Surfaces go to the variables `JOINT.bushing` and `JOINT.journal`, arrays of FMI 3.0 or `[1]`,
`[2]`, ... of FMI 2.0, if the FMU has them.
"""

import re
import sys

from .cycle import serve

FIELDS = "force_x", "force_y", "angle", "sliding", "eccentricity_x", "eccentricity_y"
OVER_CYCLE = {
    "largest": max,
    "smallest": min,
    "mean": lambda values: sum(values) / len(values),
    "last": lambda values: values[-1],
}


def mapping_of(arguments):
    """The mapping of `NAME=VARIABLE` arguments."""
    pairs = [argument.split("=", 1) for argument in arguments]
    wrong = next((pair[0] for pair in pairs if len(pair) < 2), None)
    if wrong is not None:
        raise SystemExit(f"hingewise.fmu: {wrong}: expected NAME=VARIABLE")
    return dict(pairs)


class Fmu:
    """A model with the mapping of a scene."""

    def __init__(self, path, mapping, steps=1000, settling=1):
        from fmpy import extract, read_model_description

        self.description = read_model_description(path)
        self.folder = extract(path)
        self.known = {variable.name for variable in self.description.modelVariables}
        self.mapping, self.steps, self.settling = mapping, steps, settling

    def variable(self, name, joint=None):
        """The variable of a name, `None` without one."""
        field = name if joint is None else f"{joint}.{name}"
        pattern = None if joint is None else self.mapping.get(f"*.{name}")
        found = self.mapping.get(field) or (pattern and pattern.replace("*", joint)) or field
        if found in self.known:
            return found
        if field in self.mapping or pattern:
            raise ValueError(f"{field}: the FMU has no variable {found}")
        return None

    def start_values(self, request):
        """Inputs and surfaces of a request."""
        values = {}
        for name, value in request["sample"].items():
            if self.variable(name):
                values[self.variable(name)] = value
        for joint, surfaces in request["joints"].items():
            for side, radii in surfaces.items():
                if self.variable(side, joint):
                    values[self.variable(side, joint)] = radii
                elements = {f"{joint}.{side}[{k}]": radius for k, radius in enumerate(radii, 1)}
                values.update((name, radius) for name, radius in elements.items() if name in self.known)
        return values

    def cycle(self, request):
        """The last cycle of a simulation that settles before."""
        from fmpy import simulate_fmu

        period = request["period"]
        fields = {
            (joint, field): self.variable(field, joint) for joint in request["joints"] for field in FIELDS
        }
        fields = {key: variable for key, variable in fields.items() if variable}
        outputs = {}
        for name in request.get("outputs", []):
            written = re.fullmatch(r"(\w+)\((.*)\)", self.mapping.get(name, name))
            over, variable = written.groups() if written else ("last", self.mapping.get(name, name))
            if over not in OVER_CYCLE or variable not in self.known:
                raise ValueError(f"output {name}: {self.mapping.get(name, name)} is no variable of the FMU")
            outputs[name] = OVER_CYCLE[over], variable
        wanted = [*fields.values(), *(variable for _, variable in outputs.values())]
        found = simulate_fmu(
            self.folder,
            model_description=self.description,
            stop_time=(self.settling + 1) * period,
            output_interval=period / self.steps,
            start_values=self.start_values(request),
            output=list(dict.fromkeys(wanted)),
        )
        start = self.settling * period
        rows = found[found["time"] > start - 0.5 * period / self.steps]
        column = {name: [float(value) for value in rows[name]] for name in rows.dtype.names}
        joints = {joint: {} for joint in request["joints"]}
        for (joint, field), variable in fields.items():
            joints[joint][field] = column[variable]
        return {
            "time": [time - start for time in column["time"]],
            "joints": joints,
            "outputs": {name: over(column[variable]) for name, (over, variable) in outputs.items()},
        }


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit("usage: python3 -m hingewise.fmu FILE.fmu [NAME=VARIABLE ...]")
    serve(Fmu(sys.argv[1], mapping_of(sys.argv[2:])).cycle)
