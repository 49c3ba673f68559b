"""What a live view says of itself, in words (Markdown). Knows a subject; computes nothing."""

from collections.abc import Sequence

from smarig.live.display_info import DisplayInfo


def description_markdown(display_info: DisplayInfo, models: Sequence[str], mapped: bool) -> str:
    """Whose data these are, what is predicted by what, and what colours mean."""
    source = {
        "twin": "## TWIN\n**Nothing here was measured on hardware:** a software twin stands in for the rig.\n",
        "simulation": "## SIMULATION\n**Nothing here was measured:** this is what a model says.\n",
    }.get(display_info.source, "")
    lines = [source, f"**{_plain(display_info.title)}**", ""]
    lines.append(
        f"Predicted by: {', '.join(_plain(m) for m in models)}."
        if models
        else "No model predicts: give one with `--model`."
    )
    if display_info.actuator is not None:
        lines.append("Temperatures are those of the heating model along the measured current, above ambient.")
    lines.append("Amber: now. White dots: settled means.")
    if mapped:
        lines.append("μ: red positive, blue negative, black zero; below the white boundary relays are up.")
    return "\n".join(lines)


def _plain(text: str) -> str:
    """Names are the user's: nothing in them is Markdown or a link."""
    return "".join(c if c.isalnum() or c in " -_.,:" else "·" for c in text)
