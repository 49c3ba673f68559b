"""Drives a protocol of Drive commands on a twin without runner and record; returns the result of the
generator."""

from collections.abc import Generator
from typing import Any

from smarig.core.command import Command, Drive
from smarig.rig.twin import Twin


def drive(protocol: Generator[Any, Any, Any], twin: Twin, yielded: list[Command] | None = None) -> Any:
    """Answer every Drive with its sample and everything else with None; ``yielded`` collects the commands."""
    answer = None
    while True:
        try:
            command = protocol.send(answer)
        except StopIteration as end:
            return end.value
        if yielded is not None:
            yielded.append(command)
        answer = twin.step(command.current_A)[0] if isinstance(command, Drive) else None
