"""The work of a batch: workers, the child processes that do the runs, one run."""
