"""`dualarm-pin sensitivity`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from dualarm_pin.cli import DONE, NOT_FOUND


def sensitivity(
    result: Path,
    *,
    solve_again: Annotated[bool, Parameter(negative=())] = False,
    allow_code: Annotated[bool, Parameter(negative=())] = False,
) -> int:
    """Say what errors of the cell, joint limits and points of the path cost.

    Writes `sensitivity.json` into the folder, which a report then shows.

    Args:
        result: A folder that `solve` or `place` wrote.
        solve_again: Also plan again from this motion wherever a figure is a prediction.
        allow_code: Import and run the functions that its task names with `call`.
    """
    from dualarm_pin.answer.folder import load_result
    from dualarm_pin.evidence.sensitivity import cell_costs
    from dualarm_pin.show.sensitivity import save_costs, text_of

    task, trajectory = load_result(result, allow_code=allow_code)
    if not trajectory.found:
        print(f"{result} holds no motion that was found: nothing can be predicted from it")
        return NOT_FOUND
    costs = cell_costs(task, trajectory.q, solve_again=solve_again)
    save_costs(result, costs)
    print(text_of(costs))
    return DONE
