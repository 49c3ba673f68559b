"""What is proved of a model before a loop is closed around it: passivity and stability (thesis ch. 8, §9.2)."""
