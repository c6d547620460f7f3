"""The answer: the joint motion, what our own check says of it, and the folder it is kept in."""
