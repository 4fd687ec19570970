// Redraws R(n) and the lives for other means, spreads and thresholds: predicts the failures of a population by the surrogates of the study,
// and shows what the study would state for such a share of survivors, so that most of the sampling error of the population cancels.
(() => {
  const data = JSON.parse(document.getElementById("surrogates").textContent);
  const section = document.getElementById("sliders"), svg = section.querySelector("svg");
  const { variables, states, curves, levels, end } = data;
  const STEPS = 100, NODES = [-1, -0.5, 0, 0.5, 1], CELLS = 40, FROM = -5, PER_NORMAL = 4;

  // Points: as many as are predicted in about 30 ms.
  const work = states.reduce((sum, { surrogate: { mean } }) => sum + mean.points.length * (2 * mean.factors.length + 40), 0);
  const count = Math.round(Math.min(20000, Math.max(1000, 1.8e7 / work)));

  // Wichura (1988), Algorithm AS 241, to seven digits.
  const ratio = (x, above, below) => above.reduceRight((sum, a) => sum * x + a, 0) / below.reduceRight((sum, b) => sum * x + b, 0);
  const normalAt = (p) => {
    const q = p - 0.5;
    if (Math.abs(q) <= 0.425) return q * ratio(0.180625 - q * q,
      [3.3871327179, 50.434271938, 159.29113202, 59.109374720], [1, 17.895169469, 78.757757664, 67.187563600]);
    const r = Math.sqrt(-Math.log(Math.min(p, 1 - p)));
    const u = r <= 5
      ? ratio(r - 1.6, [1.4234372777, 2.7568153900, 1.3067284816, 0.17023821103], [1, 0.73700164250, 0.12021132975])
      : ratio(r - 5, [6.6579051150, 3.0812263860, 0.42868294337, 0.017337203997], [1, 0.24197894225, 0.012258202635]);
    return Math.sign(q) * u;
  };
  let seed = 1;
  const random = () => {
    // Mulberry32, public domain.
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
  // Standard normals of one coordinate: a Latin hypercube sample.
  const normals = () => {
    const drawn = Float64Array.from({ length: count }, (_, j) => normalAt((j + 0.5) / count));
    for (let j = count - 1; j > 0; j -= 1) {
      const k = Math.floor(random() * (j + 1));
      [drawn[j], drawn[k]] = [drawn[k], drawn[j]];
    }
    return drawn;
  };

  // The population, as places in the tables of the variables; and one deviation of every point from each prediction.
  const prepare = () => {
    const independent = variables.map(normals);
    const correlated = !data.columns ? independent : variables.map((_, i) => Float64Array.from({ length: count },
      (_, j) => independent.reduce((sum, u, k) => sum + data.columns[k][i] * u[j], 0)));
    const places = correlated.map((u) => u.map((u) => Math.min(CELLS - 1e-9, Math.max(0, (u - FROM) * PER_NORMAL))));
    for (const { surrogate } of states) {
      const { mean } = surrogate;
      surrogate.deviations = normals();
      surrogate.points = Float64Array.from(mean.points.flat());
      surrogate.weights = mean.weights.map((weights) => Float64Array.from(weights));
    }
    return places;
  };

  // A polynomial through the nodes: the weights of their values.
  const lagrange = (nodes, x) => nodes.map((a, i) =>
    nodes.reduce((product, b, k) => k === i ? product : product * (x - b) / (a - b), 1));
  const table = (variable, { mean = 0, std = 0 }) => {
    if (variable.tables.length === 1) return variable.tables[0];
    const byMean = lagrange(NODES, mean / STEPS), byStd = lagrange(NODES.map((b) => 2 ** b), 2 ** (std / STEPS));
    return variable.tables[0].map((_, i) => variable.tables.reduce((sum, values, k) =>
      sum + byMean[Math.floor(k / NODES.length)] * byStd[k % NODES.length] * values[i], 0));
  };

  // Overwrites squared distances by correlations, as the module `kernel` does.
  const correlations = {
    gaussian(r) { for (let i = 0; i < r.length; i += 1) r[i] = Math.exp(-r[i]); },
    matern52(r) { for (let i = 0; i < r.length; i += 1) { const s = Math.sqrt(10 * r[i]); r[i] = (1 + s + s * s / 3) * Math.exp(-s); } },
    matern32(r) { for (let i = 0; i < r.length; i += 1) { const s = Math.sqrt(6 * r[i]); r[i] = (1 + s) * Math.exp(-s); } },
  };

  // Keys of one threshold, or of two, as in a scene.
  const thresholdKeys = ({ thresholds }) => thresholds.length === 1 ? ["threshold"] : ["lower", "upper"];

  // Life of every point by one limit state.
  const lives = ({ surrogate, thresholds, sign, reach }, moved, z) => {
    const { times, mean: { factors, kernel, trend }, std, variance, deviations, points, weights, logarithms, start } = surrogate;
    const d = factors.length, n = points.length / d, m = times.length, correlate = correlations[kernel];
    // Threshold of each side: the distance of a threshold from where it was moves it.
    const step = thresholdKeys({ thresholds }).map((key) => (moved[key] ?? 0) / STEPS * reach);
    const limits = step.length === 1 ? [surrogate.threshold + sign * step[0]]
      : [surrogate.threshold + step[1], surrogate.threshold - step[0]];
    const found = new Float64Array(count), r = new Float64Array(n), x = new Float64Array(d);
    const value = (o, side, j, deviation) => {
      const own = weights[side * m + o], slopes = trend[side * m + o];
      let sum = slopes[0] + std[o] * deviation;
      for (let k = 1; k < slopes.length; k += 1) sum += slopes[k] * z[k - 1][j];
      for (let i = 0; i < n; i += 1) sum += own[i] * r[i];
      return logarithms ? Math.exp(sum) : sum;
    };
    for (let j = 0; j < count; j += 1) {
      let norm = 0, life = Infinity;
      for (let k = 0; k < d; k += 1) { x[k] = factors[k] * z[k][j]; norm += x[k] * x[k]; }
      for (let i = 0, at = 0; i < n; i += 1) {
        let r2 = 0;
        for (let k = 0; k < d; k += 1, at += 1) { const apart = x[k] - points[at]; r2 += apart * apart; }
        r[i] = r2;
      }
      correlate(r);
      const deviation = deviations[j] * Math.sqrt(Math.min(1, variance * norm));
      for (let side = 0; side < limits.length; side += 1) {
        // Running maxima do not fall: the first that reaches the limit is found by bisection.
        const limit = limits[side];
        let low = -1, high = m - 1, below = 0, above = value(high, side, j, deviation);
        if (above < limit) continue;
        while (high - low > 1) {
          const o = (low + high) >> 1, y = value(o, side, j, deviation);
          if (y >= limit) { high = o; above = y; } else { low = o; below = y; }
        }
        const first = start === null || times[0] === 0 ? times[0] : Math.max(0, (limit - start) / (above - start)) * times[0];
        const crossed = low < 0 ? first : times[low] + (limit - below) / (above - below) * (times[high] - times[low]);
        life = Math.min(life, crossed);
      }
      found[j] = life;
    }
    return found;
  };

  // Lives by every limit state and of the whole, ascending; and the share of the points outside the simulated values.
  const assess = (setting) => {
    const tables = variables.map((variable) => table(variable, setting[variable.name] ?? {}));
    const z = tables.map((values, k) => places[k].map((place) => {
      const cell = Math.floor(place);
      return values[cell] + (place - cell) * (values[cell + 1] - values[cell]);
    }));
    const outside = variables.map(({ simulated: [from, to] }, k) =>
      z[k].reduce((sum, z) => sum + (z < from || z > to ? 1 : 0), 0) / count);
    const own = states.map((state) => lives(state, setting[state.name] ?? {}, z));
    const whole = own[0].map((_, j) => Math.min(...own.map((lives) => lives[j])));
    const unsorted = [...own, whole];
    return { unsorted, lives: unsorted.map((lives) => lives.slice().sort()), outside };
  };
  // Share of ascending lives beyond a time.
  const surviving = (lives, time) => {
    let low = 0, high = lives.length;
    while (low < high) { const half = (low + high) >> 1; if (lives[half] <= time) low = half + 1; else high = half; }
    return 1 - low / lives.length;
  };
  const between = (xs, ys, x) => {
    const next = Math.min(xs.length - 1, Math.max(1, xs.findIndex((other) => other >= x)));
    return ys[next - 1] + (x - xs[next - 1]) / (xs[next] - xs[next - 1]) * (ys[next] - ys[next - 1]);
  };
  for (const curve of curves) {
    const all = [...curve.cycles, ...Array.from({ length: 201 }, (_, k) => k / 200 * end)].filter((time) => time <= end);
    curve.times = [...new Set(all)].sort((a, b) => a - b);
    curve.studied = curve.times.map((time) => between(curve.cycles, curve.reliability, time));
  }
  const reached = (times, values, level) => {
    const next = values.findIndex((r) => r <= level);
    if (next <= 0) return next < 0 ? undefined : times[0];
    const share = (values[next - 1] - level) / (values[next - 1] - values[next]);
    return times[next - 1] + share * (times[next] - times[next - 1]);
  };

  // Numbers and words.
  const digits = (value, n = 5) => String(Number(value.toPrecision(n))).replace("-", "\u2212");
  const cycles = (life) => life === undefined ? `> ${digits(end, 6)}` : String(Math.round(life)).replace(/\B(?=(\d{3})+$)/g, "\u00a0");
  const element = (name, text = "", more = {}) => Object.assign(document.createElement(name), { textContent: text }, more);
  const knobs = [];
  const knob = (owner, key, title, value, { unit, written, scale }) => {
    const slider = element("input", "", { type: "range", min: -STEPS, max: STEPS, value: 0, name: `${owner}.${key}` });
    slider.setAttribute("aria-label", title);
    const output = element("output"), label = element("label", `${title} `);
    label.append(output, slider);
    knobs.push({
      slider, owner, key,
      show: () => {
        const text = `${digits(value(slider.value) / scale)} ${unit === "1" ? "" : unit}`.trim();
        output.textContent = text;
        slider.setAttribute("aria-valuetext", text);
      },
      written: () => `--set '${owner}.${key}=${Number((value(slider.value) / scale).toPrecision(9))} ${written}`.trim() + "'",
    });
    return label;
  };
  const fields = section.querySelector(".controls");
  for (const state of states.filter(({ surrogate, reach }) => !surrogate.is_coarse && reach > 0)) {
    for (const [k, value] of state.thresholds.entries()) {
      const key = thresholdKeys(state)[k], name = key === "threshold" ? key : `${key} threshold`;
      const label = knob(state.name, key, `${state.title}: ${name}`, (k) => value + k / STEPS * state.reach, state);
      label.style.gridColumn = "1 / -1";
      fields.append(label);
    }
  }
  for (const variable of variables.filter(({ reach }) => reach > 0)) {
    const { name, mean, std, reach } = variable, title = name.replaceAll("_", " ");
    fields.append(knob(name, "mean", `${title}: mean`, (k) => mean + k / STEPS * reach * std, variable),
      knob(name, "std", `${title}: std`, (k) => std * 2 ** (k / STEPS), variable));
  }
  const fixed = variables.filter(({ reach, std }) => reach === 0 && std > 0).map(({ name }) => name);
  const [reset, link] = [element("button", "Reset", { type: "button" }), element("a", "Link to this setting")];
  const [lifeTable, notes, command] = [element("div", "", { className: "wide" }), element("p"), element("code")];
  fields.append(reset, link);
  svg.parentElement.append(lifeTable, notes, command);
  lifeTable.setAttribute("aria-live", "polite");
  const axes = JSON.parse(svg.dataset.axes);
  const drawn = curves.map(({ ink }) => {
    const path = document.createElementNS(svg.namespaceURI, "path");
    path.setAttribute("fill", "none");
    path.setAttribute("stroke", ink);
    path.setAttribute("stroke-width", svg.viewBox.baseVal.width / 200);
    svg.append(path);
    return path;
  });
  const place = ({ from, to, first, last }, value) => from + (value - first) / (last - first) * (to - from);

  // The function that makes the predicted R of the studied setting the R of the study, through 0 and 1.
  const calibration = ({ times, studied: own }, c) => {
    const xs = [0], ys = [0];
    for (let i = times.length - 1; i >= 0; i -= 1) {
      const r = surviving(studied.lives[c], times[i]);
      if (r > xs[xs.length - 1] && r < 1) { xs.push(r); ys.push(own[i]); }
    }
    return [[...xs, 1], [...ys, 1]];
  };
  let places, studied, calibrations;
  const redraw = () => {
    if (!places) {
      places = prepare();
      studied = assess({});
      calibrations = curves.map(calibration);
    }
    const begun = performance.now(), setting = {};
    const changed = knobs.filter(({ slider }) => Number(slider.value) !== 0);
    for (const { slider, owner, key } of changed) (setting[owner] ??= {})[key] = Number(slider.value);
    const found = changed.length ? assess(setting) : studied;
    const shown = curves.map(({ times, studied: before }, c) => !changed.length ? before
      : times.map((time) => between(...calibrations[c], surviving(found.lives[c], time))));
    // Points that reach a time in one setting only, at some of the times.
    const differ = (c, time) => found.unsorted[c].reduce((sum, life, j) => sum + ((life > time) !== (studied.unsorted[c][j] > time)), 0);
    const differing = curves.flatMap(({ times }, c) => times.filter((_, i) => i % 10 === 0).map((time) => differ(c, time)));
    drawn.forEach((path, c) => {
      const points = shown[c].map((r, i) => [curves[c].times[i] / data.divisor, r]).filter(([life]) => life >= axes.x.first);
      path.setAttribute("d", points.map(([life, r], i) => `${i ? "L" : "M"}${place(axes.x, life).toFixed(0)} ${place(axes.y, r).toFixed(0)}`).join(""));
    });
    const rows = levels.map((level) => [`R = ${level}`, ...curves.map(({ times, studied: before }, c) =>
      `${cycles(reached(times, shown[c], level))} (study ${cycles(reached(times, before, level))})`)]);
    const head = ["life [cycles] at", ...curves.map(({ name }) => name)];
    const row = (cells, kind) => { const row = element("tr"); row.append(...cells.map((cell) => element(kind, cell))); return row; };
    const whole = element("table");
    whole.append(row(head, "th"), ...rows.map((cells) => row(cells, "td")));
    lifeTable.replaceChildren(whole);
    const left = variables.filter((_, k) => found.outside[k] > 2 * studied.outside[k] + 0.05).map(({ name }) => name);
    notes.textContent = [
      changed.length ? `Sampling error of the change of R: at most ${digits(1.96 * Math.sqrt(Math.max(...differing)) / count, 2)} (95 %).` : "",
      left.length ? `This setting leaves the simulated values of ${left.join(", ")}: there the surrogates only continue what they know.` : "",
      fixed.length ? `No sliders for ${fixed.join(", ")}: their distributions are not given by mean and standard deviation.` : "",
    ].join(" ");
    notes.className = left.length ? "note" : "none";
    // A changed moment fixes the other one too: a share of the mean would follow it.
    const both = new Set(changed.map(({ owner }) => owner));
    const named = knobs.filter(({ owner, key, slider }) => Number(slider.value) !== 0 || (both.has(owner) && (key === "mean" || key === "std")));
    command.textContent = changed.length ? `coordinator what-if . ${named.map((knob) => knob.written()).join(" ")}` : "";
    knobs.forEach((knob) => knob.show());
    link.href = `#what-if=${changed.map(({ slider }) => `${slider.name}:${slider.value}`).join(";")}`;
    const answer = curves.map(({ name, times }, c) =>
      ({ name, times, reliability: shown[c], lives: levels.map((level) => reached(times, shown[c], level)) }));
    Object.assign(section, { answer, milliseconds: performance.now() - begun });
  };
  const restore = () => {
    const text = decodeURIComponent(location.hash);
    if (!text.startsWith("#what-if=")) return;
    const set = Object.fromEntries(text.slice(9).split(";").map((one) => one.split(":")));
    for (const { slider } of knobs) slider.value = set[slider.name] ?? 0;
    redraw();
    section.scrollIntoView();
  };
  section.addEventListener("input", redraw);
  section.addEventListener("change", () => { try { history.replaceState(null, "", link.href); } catch { /* A page without an address. */ } });
  reset.addEventListener("click", () => { for (const { slider } of knobs) slider.value = 0; redraw(); });
  addEventListener("hashchange", restore);
  section.hidden = false;
  fields.hidden = false;
  // The first prediction waits until the page is read.
  new IntersectionObserver((seen, observer) => {
    if (!seen.some(({ isIntersecting }) => isIntersecting)) return;
    observer.disconnect();
    if (!places) redraw();
  }).observe(section);
  knobs.forEach((knob) => knob.show());
  restore();
})();
