// Keeps the overview as it is on the server: a number that changes with it is asked for, and then the parts.
import { offline } from "./connection.js";

const parts = document.getElementById("overview");

async function look() {
  try {
    const answer = await fetch("/overview/version");
    const { version } = await answer.json();
    offline(false);
    if (version === parts.dataset.version || busy()) return;
    const html = await (await fetch("/overview/parts")).text();
    parts.innerHTML = html;
    parts.dataset.version = version;
  } catch {
    offline(true);
  }
}

// A person who is about to press a button of the queue must not lose it.
const busy = () => parts.contains(document.activeElement) && document.activeElement.matches("button, a.button");

setInterval(look, 1000);
