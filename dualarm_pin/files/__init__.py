"""Files from users: YAML to checked specifications with line numbers, and safe writing."""
