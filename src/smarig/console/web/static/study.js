// A file may be dropped anywhere on the page: the browser would open it instead.
const field = document.getElementById("file");

for (const kind of ["dragover", "drop"]) document.addEventListener(kind, (event) => event.preventDefault());
document.addEventListener("drop", (event) => {
  if (field && event.dataTransfer.files.length) field.files = event.dataTransfer.files;
});
