const luminance = (rgb) => {
  const [r, g, b] = rgb.match(/[\d.]+/g).map(Number).map((c) => c / 255)
    .map((c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05;
};
const contrast = (a, b) => { const [x, y] = [luminance(a), luminance(b)]; return Math.max(x / y, y / x); };
const measure = (frame, width, dark) => {
  const view = frame.contentWindow, page = frame.contentDocument;
  page.querySelectorAll("details").forEach((one) => { one.open = true; });
  const paper = view.getComputedStyle(page.body).backgroundColor;
  const found = { width, dark, overlaps: [], small: [], faint: [], texts: 0, sideways: page.documentElement.scrollWidth - width };
  const size = (text, px) => { if (px < 10.99) found.small.push(`${text}: ${px.toFixed(2)}`); };
  const seen = (what, colour) => {
    if (colour === "none" || colour.startsWith("rgba")) return;
    const c = contrast(colour, paper);
    if (c < 4.5) found.faint.push(`${what} ${colour}: ${c.toFixed(2)}`);
  };
  for (const figure of page.querySelectorAll("figure")) {
    const boxes = [];
    for (const text of figure.querySelectorAll("svg text")) {
      if (!text.textContent.trim()) continue;
      found.texts += 1;
      const style = view.getComputedStyle(text), box = text.getBoundingClientRect();
      size(`${figure.id} "${text.textContent}"`, parseFloat(style.fontSize) * Math.hypot(text.getScreenCTM().a, text.getScreenCTM().b));
      seen(`${figure.id} "${text.textContent}"`, style.fill);
      // A box has room above and below the letters.
      boxes.push({ text: text.textContent.trim(), left: box.left + 1, right: box.right - 1,
        top: box.top + 0.15 * box.height, bottom: box.bottom - 0.15 * box.height });
    }
    boxes.forEach((a, k) => boxes.slice(0, k).forEach((b) => {
      if (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom) {
        found.overlaps.push(`${figure.id}: "${b.text}" and "${a.text}"`);
      }
    }));
    for (const shape of figure.querySelectorAll("svg polyline, svg circle")) {
      const style = view.getComputedStyle(shape);
      const stroke = (shape.getAttribute("stroke") ?? "none").toUpperCase();
      // Grid lines are read with the curves, not alone.
      if (stroke !== "NONE" && stroke !== "#E1E5EA") seen(`${figure.id} line`, style.stroke);
    }
  }
  const walker = page.createTreeWalker(page.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const parent = walker.currentNode.parentElement;
    if (!walker.currentNode.textContent.trim() || parent.closest("svg, script, style, [hidden]")) continue;
    const style = view.getComputedStyle(parent);
    size(`text "${walker.currentNode.textContent.trim().slice(0, 40)}"`, parseFloat(style.fontSize));
    seen(`text "${walker.currentNode.textContent.trim().slice(0, 40)}"`, style.color);
  }
  found.faint = [...new Set(found.faint)];
  return found;
};
const load = (width, dark) => new Promise((done) => {
  const frame = document.createElement("iframe");
  frame.width = width;
  frame.height = 1200;
  frame.style.border = "0";
  frame.addEventListener("load", () => { done(measure(frame, width, dark)); frame.remove(); });
  frame.srcdoc = dark ? page.replaceAll("@media (prefers-color-scheme:dark)", "@media all") : page;
  document.body.append(frame);
});
(async () => {
  const all = [];
  for (const width of WIDTHS) for (const dark of [false, true]) all.push(await load(width, dark));
  const result = document.createElement("pre");
  result.id = "result";
  result.textContent = JSON.stringify(all);
  document.body.append(result);
})();
