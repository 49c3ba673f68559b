"""The pages of the console, one file each: what is shown, and the requests that its buttons make."""
