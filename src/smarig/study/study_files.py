"""The files of a study in its folder, and how serious its verdict is."""

STUDY_JSON, STUDY_PAGE, STUDY_MODEL = "study.json", "index.html", "model.json"
VERDICT_LEVELS = {"good": "good", "fair": "warning", "poor": "bad"}  # of boxes and marks
