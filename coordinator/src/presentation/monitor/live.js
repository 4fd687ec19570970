// Keeps the page up to date: waits for a newer one and replaces the old one by it; scroll position and opened
// details stay as they are.
"use strict";
(async () => {
  const line = document.getElementById("live");
  let shown = Number(document.documentElement.dataset.revision);
  const say = (text) => { line.textContent = text; };
  // Times of the day in the time zone of the reader.
  const localise = () => document.querySelectorAll("time[data-seconds]").forEach((time) => {
    const moment = new Date(1000 * Number(time.dataset.seconds));
    time.textContent = moment.toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  });
  const link = () => {
    const report = document.createElement("a");
    report.href = "/report.html";
    report.textContent = "open it";
    line.append(" (", report, ")");
  };
  const show = async () => {
    const answer = await fetch("/", { cache: "no-store" });
    const page = new DOMParser().parseFromString(await answer.text(), "text/html");
    const open = [...document.querySelectorAll("details")].map((part) => part.open);
    document.querySelector("main").replaceWith(page.querySelector("main"));
    document.querySelectorAll("details").forEach((part, k) => { part.open = Boolean(open[k]); });
    document.title = page.title;
    shown = Number(page.documentElement.dataset.revision);
    document.documentElement.dataset.revision = shown;
    localise();
  };
  localise();
  for (;;) {
    try {
      const news = await (await fetch("/news/" + shown, { cache: "no-store" })).json();
      // Without a newer revision the workers may have changed.
      await show();
      say(news.line);
      if (news.ended) { link(); return; }
    } catch {
      say("The coordinator does not answer: the study has ended or was stopped. Its results are in its folder.");
      return;
    }
  }
})();
