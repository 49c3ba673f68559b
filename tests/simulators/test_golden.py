"""The Python devices reproduce firmware_protocol/golden, and the files equal the output of the script."""

import json

import pytest
from golden import FOLDER, asked, made
from write_golden import SCRIPTS


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.json")), ids=lambda path: path.stem)
def test_replies_byte_for_byte(path):
    script = json.loads(path.read_text("utf-8"))
    device = made(script)
    for step in script["script"]:
        if "tick" in step:
            device.tick(*step["tick"])
        elif "now" in step:
            device.now(step["now"])
        else:
            assert asked(device, script["framing"], step["request"]) == step["reply"], step["why"]


def test_files_are_what_the_script_writes():
    written = {f"{script.name}.json": script.text() for script in (make() for make in SCRIPTS)}
    assert written == {path.name: path.read_text("utf-8") for path in FOLDER.glob("*.json")}
