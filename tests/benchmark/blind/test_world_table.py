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
