"""Deflection of a tapered cantilever that corrodes, by finite elements: a mesh of 4, 8 or 16 elements, 128 without a level.

Euler-Bernoulli elements with two degrees of freedom a node; the bending stiffness of an element is that of its middle, so that the
error falls with the square of the length of the elements.
"""

import json
import sys

LENGTH, YOUNG, CORROSION = 1.0, 206e9, 20e-6  # [m], [Pa], [m/year] on each side


def tip_deflection(load, width, height, elements):
    """Deflection of the tip [m]; the height falls to half of that at the wall."""
    size, band = 2 * elements, 4
    rows = [[0.0] * band for _ in range(size)]  # rows[i][j]: stiffness of the degrees of freedom i and i + j
    length = LENGTH / elements
    for k in range(elements):
        middle = height * (1.0 - 0.5 * (k + 0.5) / elements)
        stiffness = YOUNG * width * middle**3 / 12.0 / length**3
        a, b = 6.0 * length, 2.0 * length**2
        of_element = [[12, a, -12, a], [a, 2 * b, -a, b], [-12, -a, 12, -a], [a, b, -a, 2 * b]]
        for i in range(4):
            for j in range(i, 4):
                place = 2 * k - 2 + i
                if place >= 0:  # the first node is clamped
                    rows[place][j - i] += stiffness * of_element[i][j]
    force = [0.0] * size
    force[size - 2] = load
    for i in range(size):
        for j in range(1, min(band, size - i)):
            factor = rows[i][j] / rows[i][0]
            for m in range(j, min(band, size - i)):
                rows[i + j][m - j] -= factor * rows[i][m]
            force[i + j] -= factor * force[i]
    for i in reversed(range(size)):
        known = sum(rows[i][j] * force[i + j] for j in range(1, min(band, size - i)))
        force[i] = (force[i] - known) / rows[i][0]
    return force[size - 2]


for line in sys.stdin:
    request = json.loads(line)
    elements = int(request.get("level", "128 elements").split()[0])
    load, width, height = (request["sample"][name] for name in ("load", "width", "height"))
    lost = [2.0 * CORROSION * year for year in request["cycles"]]
    deflection = [1e3 * tip_deflection(load, width - d, height - d, elements) for d in lost]  # [mm]
    print(json.dumps({"id": request["id"], "outputs": {"deflection": deflection}}), flush=True)
