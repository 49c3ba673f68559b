"""A model as C source: the operator, its inverse, and the hysteresis as closed form or table."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.exchange.c_code.c_source import c_source as c_source
    from smarig.exchange.c_code.fmu_archive import write_fmu as write_fmu
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
