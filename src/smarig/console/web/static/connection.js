// The notice that the console does not answer; meanwhile its buttons would only replace the page.
export function offline(is) {
  document.getElementById("offline").hidden = !is;
  for (const button of document.querySelectorAll("form button")) {
    if (is && !button.disabled) { button.disabled = true; button.dataset.offline = ""; }
    if (!is && "offline" in button.dataset) { button.disabled = false; delete button.dataset.offline; }
  }
}
