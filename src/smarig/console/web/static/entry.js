// The command of an evaluation follows the chosen model; a page of an evaluation that is being computed shows its result.
const place = document.getElementById("evaluations");

for (const form of place?.querySelectorAll("form.evaluation") ?? []) {
  const [choice, code] = [form.querySelector("select"), form.querySelector("pre code")];
  choice?.addEventListener("change", () => { code.textContent = choice.selectedOptions[0].dataset.command; });
}

async function look() {
  try {
    const { version } = await (await fetch(place.dataset.place)).json();
    if (version !== place.dataset.version) location.reload();
  } catch { /* the console does not answer; asked again */ }
}

if (place && "computing" in place.dataset) setInterval(look, 1000);
