"""The report of a run on one page. It only shows results; no phase uses anything from this package."""
