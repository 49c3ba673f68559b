// While a rig is being checked, its page is loaded again until the result is there.
if (document.querySelector("[data-checking]")) setTimeout(() => location.reload(), 1000);
