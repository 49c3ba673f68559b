"""Experiments as generators of commands, one file each. The file name is the name on the command line."""

import inspect
from typing import TYPE_CHECKING, Any, get_type_hints

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.protocols._building_blocks import checked_count as checked_count
    from smarig.protocols._building_blocks import evenly_spaced as evenly_spaced
    from smarig.protocols._building_blocks import saturate as saturate
    from smarig.protocols._settings import PROTOCOLS as PROTOCOLS
    from smarig.protocols._settings import InputFile as InputFile
    from smarig.protocols._settings import build_protocol as build_protocol
    from smarig.protocols._settings import file_settings as file_settings
    from smarig.protocols._settings import parse_pairs as parse_pairs
    from smarig.protocols._settings import refuse_closed_loops as refuse_closed_loops
    from smarig.protocols._settings import setting_texts as setting_texts
    from smarig.protocols._settings import with_loaded_protocols as with_loaded_protocols
    from smarig.protocols._setup import Setup as Setup
    from smarig.protocols.adaptive_fod import Chooser as Chooser
    from smarig.protocols.adaptive_fod import HoldResult as HoldResult
    from smarig.protocols.adaptive_fod import NextInputs as NextInputs
    from smarig.protocols.adaptive_fod import halving as halving
    from smarig.protocols.first_order_descending import first_order_descending as first_order_descending
    from smarig.protocols.initialise import initialise as initialise
    from smarig.protocols.validation import validation as validation
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)


def misfit(name: str, found: Any) -> str:
    """The reason why an object is not a protocol ``NAME(setup, *, setting: type = default, …)``; "" if it is one.

    >>> misfit("hold", lambda: None)
    'hold must be a function hold(setup, *, setting: type = default, …); it has no argument setup'
    """
    reason = _misfit_reason(found)
    shape = f"{name} must be a function {name}(setup, *, setting: type = default, …)"
    return f"{shape}; {reason}" if reason else ""


def _misfit_reason(found: Any) -> str:
    if not inspect.isfunction(found):
        return f"it is of type {type(found).__name__}"
    parameters = [p for p in inspect.signature(found).parameters.values() if p.name != "chooser"]
    if not parameters or parameters[0].kind not in (
        inspect.Parameter.POSITIONAL_ONLY,
        inspect.Parameter.POSITIONAL_OR_KEYWORD,
    ):
        return "it has no argument setup"
    try:
        hints = get_type_hints(found)
    except Exception as error:
        return f"its types cannot be resolved ({error})"
    for p in parameters[1:]:
        if p.kind is not p.KEYWORD_ONLY:
            return f"'{p.name}' must come after the *"
        if p.default is p.empty:
            return f"its setting '{p.name}' has no default"
        if p.name not in hints:
            return f"its setting '{p.name}' has no type"
    return ""
