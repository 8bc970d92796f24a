"""One page that tells what was run and what came out, from the tables of all phases.

It reads tables and writes HTML; nothing here computes a result that another
phase could use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
