"""Where bases, workpiece and tool stand, as variables that all points of a path share."""
