"""Rig files that extend another rig file."""

import pytest

from smarig.config import load_rig
from smarig.core.errors import ConfigError, UsageError


def written(folder, name, text):
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_missing_keys_are_taken_from_the_base(tmp_path):
    base = load_rig("one_wire_twin")
    mine = load_rig(
        written(tmp_path, "mine", 'name = "mine"\nbase = "one_wire_twin"\nlimits.current_max_A = 0.5\n')
    )
    assert mine.limits.current_max_A == 0.5
    assert mine.limits.temperature_max_K == base.limits.temperature_max_K
    assert mine.encoder == base.encoder
    assert mine.name == "mine"


def test_a_base_may_have_a_base(tmp_path):
    under = written(
        tmp_path, "under", 'name = "under"\nbase = "one_wire_twin"\nwire = "one"\nlease_s = 0.7\n'
    )
    over = load_rig(written(tmp_path, "over", f'name = "over"\nbase = "{under}"\nwire = "other"\n'))
    assert (over.wire, over.lease_s) == ("other", 0.7)


def test_what_is_wrong_in_a_base_is_reported(tmp_path):
    me = str(tmp_path / "me.toml")
    with pytest.raises(ConfigError, match="is its own base"):
        load_rig(written(tmp_path, "me", f'name = "me"\nbase = "{me}"\n'))
    with pytest.raises(ConfigError, match="'base' must name another rig file"):
        load_rig(written(tmp_path, "number", 'name = "number"\nbase = 3\n'))


def test_a_base_that_is_no_rig_file_is_not_quoted(tmp_path):
    """A rig file from somebody else may name any file."""
    secret = written(tmp_path, "secret", 'password = "hunter2"\n')
    with pytest.raises(ConfigError) as refusal:
        load_rig(written(tmp_path, "mine", f'name = "mine"\nbase = "{secret}"\n'))
    assert "which is not a rig file" in str(refusal.value)
    assert "password" not in str(refusal.value)
    assert "hunter2" not in str(refusal.value)


def test_a_rig_without_a_name_is_refused_in_a_sentence():
    with pytest.raises(UsageError, match="No rig ''. There are: bench_one_wire"):
        load_rig("")
