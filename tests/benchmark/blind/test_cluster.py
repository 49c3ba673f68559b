"""The blind benchmark on a local Dask cluster gives the same answers as without one."""

import pytest

from benchmarks import diagnosis
from extras import skip_without
from smarig.core.errors import UsageError

skip_without("distributed", extra="scale")

BOXES = 2


@pytest.fixture
def scheduler():
    """Address of a scheduler with two workers, processes of their own."""
    import distributed

    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None
    ) as cluster:
        yield cluster.scheduler_address


@pytest.mark.long("takes a minute")
@pytest.mark.filterwarnings("default::DeprecationWarning", "default::ResourceWarning")
def test_a_cluster_gives_the_answers_of_one_process(scheduler, tmp_path):
    spread = diagnosis.run(boxes=BOXES, dask=scheduler, out=tmp_path / "answers.jsonl")
    alone = diagnosis.run(boxes=BOXES)
    assert spread.pop("seconds")
    assert alone.pop("seconds")
    assert spread == alone
    assert spread["boxes"] == BOXES
    assert not spread["failed"]


@pytest.mark.long("takes three seconds")
@pytest.mark.filterwarnings("default::ResourceWarning")
@pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "nowhere", "foo://x:1"])
def test_an_address_without_a_scheduler_is_one_sentence(address, monkeypatch):
    monkeypatch.setattr(diagnosis, "CONNECT_TIMEOUT_S", 2)
    with pytest.raises(UsageError, match=rf"No Dask scheduler responds at '{address}'"):
        diagnosis.run(boxes=1, dask=address)
