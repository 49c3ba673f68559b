"""The console of a laboratory: what a person sees and does in a browser. A run is always a process of its own."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.console.library.entry import Entry as Entry
    from smarig.console.library.entry import Figure as Figure
    from smarig.console.library.entry import Note as Note
    from smarig.console.library.library import Library as Library
    from smarig.console.library.scan import ScanResult as ScanResult
    from smarig.console.library.search import FACETS as FACETS
    from smarig.console.library.search import ORDERS as ORDERS
    from smarig.console.library.search import SearchPage as SearchPage
    from smarig.console.library.trends import Trend as Trend
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
