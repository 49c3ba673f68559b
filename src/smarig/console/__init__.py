"""The console of a laboratory: what a person sees and does in a browser. A run is always a process of its own."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.console.library.library import Library as Library
    from smarig.console.library.library_entry import Entry as Entry
    from smarig.console.library.library_search import FACETS as FACETS
    from smarig.console.library.library_search import ORDERS as ORDERS
    from smarig.console.web.console_server import serve_console as serve_console
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
