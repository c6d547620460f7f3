"""The log of a batch, one row a run, and the tables made from it."""
