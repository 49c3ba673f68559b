// Keeps the overview as it is on the server: a number that changes with it is asked for, and then the parts.
import { offline } from "./connection.js";
import { announce, heading, notifyButton, restoreTitleWhenSeen } from "./notify.js";

const parts = document.getElementById("overview");
let known = JSON.parse(parts.dataset.state); // the runs in progress and the fault of the queue at the last look

async function look() {
  try {
    const now = await (await fetch("/overview/version")).json();
    offline(false);
    await compare(now);
    if (now.version === parts.dataset.version || busy()) return;
    const html = await (await fetch("/overview/parts")).text();
    parts.innerHTML = html;
    parts.dataset.version = now.version;
  } catch {
    offline(true);
  }
}

// What has ended since the last look, and a queue that has paused because of it.
async function compare(now) {
  const [before, keys] = [known, now.runs.map((run) => run.key)];
  known = now;
  for (const run of before.runs.filter((each) => !keys.includes(each.key))) {
    const end = await (await fetch(`/runs/${run.key}/state?file=${encodeURIComponent(run.file)}`)).json();
    announce(heading(end.level, run.title), end.state);
  }
  if (now.fault && now.fault !== before.fault) announce("Queue paused", now.fault);
}

// A person who is about to press a button of the queue must not lose it.
const busy = () => parts.contains(document.activeElement) && document.activeElement.matches("button, a.button");

notifyButton();
restoreTitleWhenSeen();
setInterval(look, 1000);
