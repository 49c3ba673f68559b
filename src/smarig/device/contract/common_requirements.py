"""Requirements on every instrument: it has an identity, closes without errors, and is missed with one clear error."""

from smarig.core import RigFault, UsageError
from smarig.device.contract.contract_case import Broken, ContractCase, require


def identity(case: ContractCase) -> str:
    """One line that names the device."""
    with case.opened() as instrument:
        text = instrument.identity
    require(isinstance(text, str) and bool(text.strip()), "identity is empty")
    require("\n" not in text, "identity has more than one line")
    return text


def closing(case: ContractCase) -> str:
    """``close`` may be called repeatedly, and the instrument can be opened again."""
    instrument = case.open()
    if hasattr(instrument, "off"):
        instrument.off()
    for _ in range(2):
        _never_raises(instrument.close, "close")
    case.open().close()
    return "closed twice and opened again"


def absence(case: ContractCase) -> str:
    """Where there is no device, the driver raises one clear error (a RigFault)."""
    try:
        instrument = case.open_absent()
    except (RigFault, UsageError) as error:
        require(bool(str(error)) and "\n" not in str(error), f"the error has no clear sentence: {error!r}")
        return str(error)
    except Exception as error:
        raise Broken(f"it raised {type(error).__name__}, not a RigFault: {error}") from None
    instrument.close()
    raise Broken("it opened a device that is not there")


def _never_raises(call, name: str):
    try:
        return call()
    except Exception as error:
        raise Broken(f"{name} raised {type(error).__name__}: {error}") from None
