"""Faults from a file: unknown or impossible entries are refused with one sentence."""

import pytest

from simulators.faults import GarbledBytes, Unplugged, load_faults
from smarig.core.errors import ConfigError


def written(tmp_path, text: str):
    path = tmp_path / "faults.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_read(tmp_path):
    text = """
        [[fault]]
        kind = "garbled"
        device = "amplifier"
        share = 0.01
        seed = 1
        from_s = 10
        to_s = 60

        [[fault]]
        kind = "unplugged"
        device = "encoder_daq"
        from_exchange = 5
        to_exchange = 7
    """
    garbled, unplugged = load_faults(written(tmp_path, text))
    assert garbled == GarbledBytes(kind="garbled", device="amplifier", share=0.01, seed=1, from_s=10, to_s=60)
    assert isinstance(unplugged, Unplugged)
    assert [unplugged.active(0, k) for k in (4, 5, 6, 7)] == [False, True, True, False]
    assert [garbled.active(t, 0) for t in (9.99, 10, 59.9, 60)] == [False, True, True, False]
    assert load_faults(written(tmp_path, "")) == ()


@pytest.mark.parametrize(
    ("text", "blamed"),
    [
        ('kind = "garbled"\ndevice = "amplifier"\nshar = 0.1', "shar"),
        ('kind = "garbled"', "device"),
        ('kind = "garbld"\ndevice = "amplifier"', "garbld"),
        ('kind = "delayed"\ndevice = "amplifier"', "delay_s"),
        ('kind = "open_wire"\ndevice = "encoder_daq"', "encoder_daq"),
        ('kind = "dropped"\ndevice = "amplifier"\nshare = 2', "share"),
    ],
)
def test_refused(tmp_path, text, blamed):
    with pytest.raises(ConfigError, match=blamed) as refused:
        load_faults(written(tmp_path, f"[[fault]]\n{text}\n"))
    assert len(str(refused.value).splitlines()) == 1
