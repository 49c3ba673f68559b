"""How serious a verdict is, on its page and in lists of pages: a named cause is a good diagnosis of a bad wire."""

SEVERITY_LEVELS = {
    "silent": "good",
    "named": "bad",
    "ambiguous": "bad",
    "unknown": "bad",
    "not_identifiable": "warning",
}
