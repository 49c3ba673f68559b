"""The score of boxes outside the catalogue: every name is an error, except one that says the same."""

from benchmarks.blind.world_table import world_table


def answer(category, hidden, verdict, depends_on=None, names=(), delta=3.0):
    return {
        "category": category,
        "hidden": {name: {} for name in hidden},
        "verdict": verdict,
        "depends_on": depends_on,
        "set": list(names),
        "delta": {category: delta},
    }


def test_names_and_variables_are_scored_by_world():
    found = world_table(
        [
            answer("kinetic", (), "unknown", "history"),
            answer("kinetic", (), "unknown", "time"),
            answer("kinetic", (), "named", names=["settling"]),
            answer("unlisted", ("thermostat",), "named", names=["ambient_drift"]),
            answer("unlisted", ("thermostat",), "unknown", "level"),
            answer("unlisted", ("dust",), "named", names=["walking"]),
            answer("unlisted", ("dust",), "unknown", "time"),
            answer("unlisted", ("dust",), "silent", delta=0.2),
            answer("empty", (), "silent", delta=0.0),
        ]
    )
    assert found["kinetic"]["named"]["hits"] == 1
    assert (found["kinetic"]["not_preisach_or_history"]["hits"], found["kinetic"]["unknown"]["hits"]) == (
        1,
        2,
    )
    assert found["unlisted"]["named"]["hits"] == 1
    assert found["unlisted"]["alarms delta>=1"]["of"] == 4
    assert found["unlisted"]["right variable delta>=1"]["hits"] == 2
    assert found["by_mechanism"]["dust"] == ["walking", "time", "silent"]


def test_offered_extensions_are_scored_by_what_they_remove_and_never_forgiven_when_worse():
    def learned(base, extended, share, offered=True):
        held_out = {"base": base, "extended": extended, "removable_share": share}
        return answer("unlisted", ("dust",), "unknown", "time") | {
            "learned": {"variables": ["time"]} if offered else None,
            "held_out": held_out,
        }

    small = answer("unlisted", ("dust",), "unknown", "time", delta=0.5) | {"learned": {}, "held_out": None}
    found = world_table(
        [
            learned(2.0, 1.0, 0.8),
            learned(2.0, 2.5, -0.6),
            learned(2.0, 1.5, 0.5),
            learned(2.0, 2.0, 0.0, offered=False),
            small,
        ]
    )["learned delta>=1"]
    assert (found["offered"]["hits"], found["offered"]["of"]) == (3, 4)
    assert (found["worse"]["hits"], found["worse"]["of"]) == (1, 4)
    assert found["median_R"] == 0.25
    assert found["median_R_offered"] == 0.5
