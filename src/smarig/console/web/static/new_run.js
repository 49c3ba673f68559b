// A chosen rig or experiment shows its settings at once; without scripts the button does it.
for (const select of document.querySelectorAll("#choose select")) {
  select.addEventListener("change", () => document.getElementById("choose").submit());
}
document.querySelector("#choose button").hidden = true;
// A preview may take a while: say so.
document.getElementById("request").addEventListener("submit", (event) => {
  document.getElementById("preview").textContent = "Computing the preview on the twin …";
  for (const button of event.target.querySelectorAll("button")) setTimeout(() => (button.disabled = true));
});
