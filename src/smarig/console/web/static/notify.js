// Notifications of this browser and the title of the tab, for the end of a run and for a queue that pauses. Permission is
// asked for only when somebody presses the button; the title needs none.
const KEY = "smarig-notify"; // kept for this tab, so that it outlives the pages of the console

const isOn = () => sessionStorage.getItem(KEY) === "on";
const isPossible = () => "Notification" in window && Notification.permission === "granted";

// The button and the sentence behind it.
export function notifyButton() {
  const [button, note] = ["notify", "notify-note"].map((id) => document.getElementById(id));
  if (!button) return;
  const show = () => {
    button.setAttribute("aria-pressed", String(isOn()));
    note.textContent = !isOn() ? "" : isPossible()
      ? "This browser will notify you; the title of the tab changes too."
      : "This browser shows no notifications for the console; the title of the tab will change.";
  };
  button.addEventListener("click", async () => {
    sessionStorage.setItem(KEY, isOn() ? "off" : "on");
    if (isOn() && "Notification" in window && Notification.permission === "default") await Notification.requestPermission();
    show();
  });
  show();
}

const title = document.title;

// Returns at once; a notification that the browser refuses is left out.
export function announce(words, text) {
  document.title = words;
  if (!isOn() || !isPossible()) return;
  try {
    new Notification(words, { body: text, tag: words });
  } catch { /* some phones allow them to workers only */ }
}

// The usual title again, as soon as somebody is at the page.
export function restoreTitleWhenSeen() {
  const restore = () => { if (document.visibilityState === "visible") document.title = title; };
  for (const event of ["visibilitychange", "pointerdown", "keydown"]) document.addEventListener(event, restore);
}

export const heading = (level, name) => `${level === "bad" ? "Fault" : "Ended"}: ${name}`;
