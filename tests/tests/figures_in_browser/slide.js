const section = document.getElementById("sliders"), sliders = [...section.querySelectorAll("input")];
const restored = sliders.filter((slider) => slider.value !== "0").map((slider) => `${slider.name}:${slider.value}`);
const answers = SETTINGS.map((setting) => {
  for (const slider of sliders) slider.value = setting[slider.name] ?? 0;
  section.dispatchEvent(new Event("input"));
  const command = section.querySelector("code").textContent, link = section.querySelector("a").getAttribute("href");
  return { answer: section.answer, milliseconds: section.milliseconds, command, link };
});
const result = document.createElement("pre");
result.id = "result";
result.textContent = JSON.stringify({ restored, answers });
document.body.append(result);
