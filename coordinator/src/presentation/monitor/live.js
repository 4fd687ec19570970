// Keeps the page up to date: waits for a newer report and replaces the old one by it; scroll position and opened
// details stay as they are.
"use strict";
(async () => {
  const line = document.getElementById("live");
  let shown = Number(document.documentElement.dataset.revision);
  const say = (text) => { line.textContent = text; };
  const show = async () => {
    const answer = await fetch("/", { cache: "no-store" });
    const page = new DOMParser().parseFromString(await answer.text(), "text/html");
    const open = [...document.querySelectorAll("details")].map((part) => part.open);
    document.querySelector("main").replaceWith(page.querySelector("main"));
    document.querySelectorAll("details").forEach((part, k) => { part.open = Boolean(open[k]); });
    document.title = page.title;
    shown = Number(page.documentElement.dataset.revision);
    document.documentElement.dataset.revision = shown;
  };
  for (;;) {
    try {
      const news = await (await fetch("/news/" + shown, { cache: "no-store" })).json();
      if (news.revision > shown) { await show(); }
      say(news.line);
      if (news.ended) { return; }
    } catch {
      say("The coordinator does not answer: the study has ended or was stopped. Its results are in its folder.");
      return;
    }
  }
})();
