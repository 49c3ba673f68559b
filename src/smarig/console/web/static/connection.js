// The notice that the console does not answer.
export function offline(is) {
  document.getElementById("offline").hidden = !is;
}
