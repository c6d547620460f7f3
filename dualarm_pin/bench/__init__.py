"""Batches: tasks x variants x methods x seeds on one machine or many, never losing a row.

`Suite.load` reads a suite file, `run_suite` runs it into a folder. Runs are spread by
dask.distributed; each is one line of `rows.jsonl`, on disk as it ends, and the tables and the
report are made from those lines.
"""
