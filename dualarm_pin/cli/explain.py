"""`dualarm-pin explain`."""

from __future__ import annotations

from pathlib import Path

from dualarm_pin.cli import DONE


def explain(what: str | None = None, /, *, schema: Path | None = None) -> int:
    """Say what the keys of a cell, task or suite file mean.

    Args:
        what: `cell`, `task` or `suite`, or a key such as `path.corner` or `fillet`.
        schema: Write JSON schemas for editors into this folder.
    """
    from dualarm_pin.explain import explain as explained
    from dualarm_pin.explain import write_schemas

    if schema is not None:
        files = write_schemas(schema)
        print(f"written: {', '.join(map(str, files))}")
        print(f"first line of a file: # yaml-language-server: $schema={files[0]}")
        if what is None:
            return DONE
    print(explained(what))
    return DONE
