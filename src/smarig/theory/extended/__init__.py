"""Extensions of the classical operator (thesis §3.5), one file each; at zero strength each is the classical one."""
