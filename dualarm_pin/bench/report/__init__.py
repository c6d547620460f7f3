"""The report of a batch: statistics, charts and tables on one page."""
