"""The extended models of thesis §3.5, one file each: a function of the file's name identifies it."""
