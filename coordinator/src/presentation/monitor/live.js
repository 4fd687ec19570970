// Keeps the page up to date: waits until there is something new, and then puts the new report in the place of the old
// one, leaving the scroll position and opened details as they are.
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
      say("The coordinator no longer answers: the study has ended, or it was stopped. Results are in its folder.");
      return;
    }
  }
})();
