"""The extended models of thesis §3.5: one file each, with an identifying function of the file's name."""
