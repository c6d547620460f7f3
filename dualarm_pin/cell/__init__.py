"""Two arms in one Pinocchio model, from any URDFs: `Cell.load(file)`, `Cell.from_urdf(...)`."""

from dualarm_pin.cell.cell import Cell
from dualarm_pin.cell.parts import Arm, Clearance, Joint, SourceFile

__all__ = ["Arm", "Cell", "Clearance", "Joint", "SourceFile"]
