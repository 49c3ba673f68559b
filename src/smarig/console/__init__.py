"""The console of a laboratory: what a person sees and does in a browser. A run is always a process of its own."""

from typing import TYPE_CHECKING

from smarig.core.lazy_exports import lazy_exports

if TYPE_CHECKING:
    from smarig.console.library.library import Library as Library
    from smarig.console.library.library_entry import Entry as Entry
    from smarig.console.library.library_entry import LibraryFigure as LibraryFigure
    from smarig.console.library.library_entry import Note as Note
    from smarig.console.library.library_search import FACETS as FACETS
    from smarig.console.library.library_search import ORDERS as ORDERS
    from smarig.console.library.library_search import SearchPage as SearchPage
    from smarig.console.library.scan import ScanResult as ScanResult
    from smarig.console.library.trends import Trend as Trend
    from smarig.console.queue.ensure_worker import ensure_worker as ensure_worker
    from smarig.console.queue.entry_command import entry_command as entry_command
    from smarig.console.queue.entry_command import shown_command as shown_command
    from smarig.console.queue.entry_request import EntryRequest as EntryRequest
    from smarig.console.queue.queue import Queue as Queue
    from smarig.console.queue.queue import QueueState as QueueState
    from smarig.console.queue.queue_entry import QueueEntry as QueueEntry
    from smarig.console.web.console_server import serve_console as serve_console
else:
    __getattr__, __dir__, __all__ = lazy_exports(__name__)
