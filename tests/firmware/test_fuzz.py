"""Random and mutated requests under the address and undefined-behaviour sanitizers; a million with SMARIG_LONG."""

import os
import re
import subprocess

from firmware.firmware_build import make

REQUESTS = 1_000_000 if os.environ.get("SMARIG_LONG") else 250_000


def test_random_requests(build_folder):
    program = make(build_folder, "fuzz", ("gcc",))
    done = subprocess.run([program, str(REQUESTS)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    unanswered, accepted, refused = re.match(
        rf"{REQUESTS} requests: (\d+) not answered, (\d+) accepted, refused (.*)", done.stdout
    ).groups()
    counts = dict(re.findall(r"(\d): (\d+)", refused))
    # a campaign that never gets anywhere proves nothing
    assert min(int(unanswered), int(accepted), *(int(counts[code]) for code in "123489")) > 1000
    assert all(int(ticks) > 100 for ticks in re.findall(r"\d+", done.stdout.splitlines()[1]))
