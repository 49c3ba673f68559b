"""A million random and mutated requests under the address and undefined-behaviour sanitizers."""

import re
import subprocess

from firmware.firmware_build import make


def test_a_million_requests(build_folder):
    program = make(build_folder, "fuzz", ("gcc",))
    done = subprocess.run([program, "1000000"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    unanswered, accepted, refused = re.match(
        r"1000000 requests: (\d+) not answered, (\d+) accepted, refused (.*)", done.stdout
    ).groups()
    counts = dict(re.findall(r"(\d): (\d+)", refused))
    # a campaign that never gets anywhere proves nothing
    assert min(int(unanswered), int(accepted), *(int(counts[code]) for code in "123489")) > 1000
    assert all(int(ticks) > 100 for ticks in re.findall(r"\d+", done.stdout.splitlines()[1]))
