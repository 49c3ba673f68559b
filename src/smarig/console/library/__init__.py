"""Every run, model, diagnosis, study and page of a folder and its subfolders, with tags and notes of people.

``library.sqlite`` is made from the files and can be made again at any time. Only ``library.notes.jsonl`` holds what
no other file has.
"""
