// Shows the values at the point of a chart that is nearest to the pointer.
(() => {
  const tip = document.createElement("div");
  tip.className = "tip";
  tip.hidden = true;
  document.body.append(tip);
  // Abramowitz, Stegun (1964), Handbook of Mathematical Functions, 26.2.17.
  const upper = (u) => {
    const t = 1 / (1 + 0.2316419 * u);
    const sum = t * (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
    return sum * Math.exp(-u * u / 2) / Math.sqrt(2 * Math.PI);
  };
  const value = {
    "linear": (v) => v,
    "log": (v) => 10 ** v,
    "weibull": (v) => 100 * (1 - Math.exp(-Math.exp(v))),
    "normal": (v) => 100 * (v < 0 ? upper(-v) : 1 - upper(v)),
  };
  const text = (v) => {
    const size = Math.abs(v);
    const plain = size === 0 || (size >= 1e-3 && size < 1e6);
    return (plain ? String(Number(v.toPrecision(5))) : v.toExponential(3)).replaceAll("-", "\u2212");
  };
  const at = (axis, place) => {
    const share = (place - axis.from) / (axis.to - axis.from);
    return `${axis.label}: ${text(value[axis.scale](axis.first + share * (axis.last - axis.first)))}`;
  };
  for (const svg of document.querySelectorAll("svg[data-axes]")) {
    const { x, y, names } = JSON.parse(svg.dataset.axes);
    const mark = document.createElementNS(svg.namespaceURI, "circle");
    mark.setAttribute("fill", "none");
    mark.setAttribute("class", "pointed");
    mark.setAttribute("visibility", "hidden");
    let points;
    const within = ([px, py]) =>
      px >= x.from - 1 && px <= x.to + 1 && py >= y.to - 1 && py <= y.from + 1;
    const collect = () => {
      points = [];
      for (const line of svg.querySelectorAll("polyline, polygon")) {
        const ink = line.getAttribute("stroke") ?? line.getAttribute("fill");
        if (!(ink in names)) continue;
        for (const point of line.points) points.push([point.x, point.y, ink]);
      }
      for (const dot of svg.querySelectorAll("circle")) {
        const ink = dot.getAttribute("fill");
        if (ink in names) points.push([dot.cx.baseVal.value, dot.cy.baseVal.value, ink]);
      }
      points = points.filter(within);
      svg.append(mark);
    };
    const hide = () => {
      tip.hidden = true;
      mark.setAttribute("visibility", "hidden");
    };
    svg.addEventListener("pointermove", (event) => {
      if (!points) collect();
      const box = svg.getBoundingClientRect(), units = svg.viewBox.baseVal.width / box.width;
      const px = (event.clientX - box.left) * units, py = (event.clientY - box.top) * units;
      let nearest, least = 24 * units;
      for (const point of points) {
        const distance = Math.hypot(point[0] - px, point[1] - py);
        if (distance < least) [nearest, least] = [point, distance];
      }
      if (!nearest) return hide();
      tip.replaceChildren(...[names[nearest[2]], at(x, nearest[0]), at(y, nearest[1])].map((line) => {
        const row = document.createElement("div");
        row.textContent = line;
        return row;
      }));
      tip.hidden = false;
      const left = Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 8);
      tip.style.left = `${Math.max(left, 4)}px`;
      tip.style.top = `${Math.max(event.clientY - tip.offsetHeight - 12, 4)}px`;
      mark.setAttribute("cx", nearest[0]);
      mark.setAttribute("cy", nearest[1]);
      mark.setAttribute("r", 5 * units);
      mark.setAttribute("stroke-width", 2 * units);
      mark.setAttribute("stroke", nearest[2]);
      mark.setAttribute("visibility", "visible");
    });
    svg.addEventListener("pointerleave", hide);
  }
})();
