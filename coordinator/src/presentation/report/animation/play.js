// Moves the picture of the mechanism: one cycle in six seconds, as long as it is seen.
(() => {
  const figure = document.getElementById("mechanism");
  const { cycles, lives } = JSON.parse(document.getElementById("motion").textContent);
  const all = (name) => [...figure.querySelectorAll(`[data-${name}]`)];
  const bodies = all("body"), joints = all("joint"), bores = all("bore");
  const journals = all("journal"), worn = all("worn");
  const button = figure.querySelector("button"), place = figure.querySelector("input.instant");
  const choice = figure.querySelector("select");
  const frames = cycles[0].bodies[0].length / 3;
  let cycle = cycles[0], at = 0, playing = false, seen = true, before;
  // Outline of a bore, straight between a few points from one control point to the next.
  const outline = (depths) => {
    const steps = 4 * depths.length;
    const point = (step) => {
      const k = Math.floor(step / 4), share = (step % 4) / 4;
      const radius = lives.bore + depths[k] * (1 - share) + depths[(k + 1) % depths.length] * share;
      const turn = 2 * Math.PI * step / steps;
      return `${(radius * Math.cos(turn)).toFixed(2)} ${(-radius * Math.sin(turn)).toFixed(2)}`;
    };
    return depths.length ? `M${Array.from({ length: steps }, (_, step) => point(step)).join("L")}Z` : "";
  };
  const pick = (numbers, k, width) => numbers.slice(width * k, width * k + width);
  const draw = () => {
    const k = Math.floor(at) % frames;
    bodies.forEach((body, b) => {
      const [x, y, turn] = pick(cycle.bodies[b], k, 3);
      body.setAttribute("transform", `translate(${x} ${y}) rotate(${turn})`);
    });
    joints.forEach((joint, j) => {
      const [x, y] = pick(cycle.joints[j], k, 2);
      joint.setAttribute("transform", `translate(${x} ${y})`);
    });
    bores.forEach((bore, j) => {
      const [x, y, journal, bushing] = pick(cycle.bores[j], k, 4);
      bore.setAttribute("transform", `rotate(${bushing})`);
      journals[j].setAttribute("transform", `translate(${x} ${y}) rotate(${journal})`);
      worn[j].setAttribute("visibility", cycle.worn || lives ? "visible" : "hidden");
    });
    place.value = k;
  };
  const step = (now) => {
    if (!playing || !seen) return;
    if (before !== undefined) at = (at + (now - before) * frames / 6000) % frames;
    before = now;
    draw();
    requestAnimationFrame(step);
  };
  const start = () => { before = undefined; requestAnimationFrame(step); };
  const play = (on) => {
    playing = on;
    button.textContent = on ? "Pause" : "Play";
    if (on) start();
  };
  cycles.forEach((one, k) => choice.add(new Option(one.name, k)));
  place.max = frames - 1;
  button.addEventListener("click", () => play(!playing));
  place.addEventListener("input", () => { play(false); at = Number(place.value); draw(); });
  const life = figure.querySelector("input.life"), said = figure.querySelector("output");
  // The bores of a life; its motion is known in the first and in the last cycle only.
  const age = (k) => {
    life.value = k;
    worn.forEach((path, j) => path.setAttribute("d", outline(lives.bores[k][j])));
    said.textContent = `${lives.cycles[k].toLocaleString("en").replaceAll(",", "\u00a0")} cycles, motion of the ${cycle.name}`;
  };
  if (lives && cycles.length > 1) {
    life.max = lives.cycles.length - 1;
    life.addEventListener("input", () => {
      const k = Number(life.value), last = k === lives.cycles.length - 1;
      cycle = cycles.find((one) => one.worn === last);
      choice.value = cycles.indexOf(cycle);
      age(k);
      draw();
    });
    figure.querySelector(".through").hidden = false;
    age(lives.cycles.length - 1);
  }
  choice.addEventListener("change", () => {
    cycle = cycles[choice.value];
    if (lives && cycles.length > 1) age(cycle.worn ? lives.cycles.length - 1 : 0);
    draw();
  });
  new IntersectionObserver(([entry]) => {
    const again = entry.isIntersecting && !seen;
    seen = entry.isIntersecting;
    if (again && playing) start();
  }).observe(figure);
  figure.querySelector(".controls").hidden = false;
  draw();
  play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
})();
