"""Read the robots of a cell: URDF, xacro and SRDF, with their fingerprints."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from dualarm_pin.cell.chains import Chains, find_tip, single_chain, twin_chains
from dualarm_pin.cell.joint_settings import Blame
from dualarm_pin.cell.parts import ARMS
from dualarm_pin.errors import InputError
from dualarm_pin.files.cell_spec import ArmSpec, CellSpec
from dualarm_pin.files.source import Key, Source, Spec, check
from dualarm_pin.robot.packages import find_file, is_folder
from dualarm_pin.robot.read_urdf import parse_urdf
from dualarm_pin.robot.robot import Robot
from dualarm_pin.robot.srdf import Srdf, read_srdf
from dualarm_pin.robot.xml import read_bytes


@dataclass
class Loader:
    """What is read on the way: files with fingerprints, warnings, and who is to blame.

    Attributes:
        spec: What a cell file holds.
        name: Name of the cell if the specification has none.
        folder: Where relative paths start.
        blame: Makes an error from a message and the keys at fault.
        sources: Files that were read, with their SHA-256.
        warnings: What a user should know.
    """

    spec: CellSpec
    name: str
    folder: Path
    blame: Blame
    sources: dict[Path, str] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)

    @staticmethod
    def of_file(source: Source, keys: Sequence[Key] = ()) -> Loader:
        """Return the loader of the cell that stands at `keys` of a file.

        Raises:
            InputError: The file does not hold a cell there.
        """
        spec = check(source, CellSpec, keys)

        def blame(message: str, where: Sequence[Key]) -> InputError:
            return source.error(message, [*keys, *where])

        file = source.path.resolve()
        loader = Loader(spec, source.path.stem, file.parent, blame)
        loader.note(file, source.path.read_bytes())
        return loader

    @staticmethod
    def of_python(spec: CellSpec, name: str) -> Loader:
        """Return the loader of a specification that no file holds."""

        def blame(message: str, keys: Sequence[str]) -> InputError:
            return InputError(message, field=".".join(map(str, keys)) or None)

        return Loader(spec, name, Path.cwd(), blame)

    @property
    def package_dirs(self) -> tuple[Path, ...]:
        """Further folders to search, as the cell file gives them."""
        return tuple(self.folder / entry for entry in self.spec.package_dirs)

    def refuse(self, level: Spec, names: Iterable[str], keys: Sequence[str], message: str) -> None:
        """Refuse names that the file gives on a level, which stands at `keys`."""
        for name in names:
            if name in level.model_fields_set and getattr(level, name) not in (None, {}):
                raise self.blame(message.format(name), (*keys, name))

    def find(self, name: str, keys: Sequence[str]) -> Path:
        """Return the file that a name at `keys` stands for.

        Raises:
            MissingFileError: It is nowhere.
        """
        try:
            return find_file(name, self.folder, self.package_dirs)
        except InputError as error:
            raise _placed(error, self.blame, keys) from error

    def note(self, path: Path, raw: bytes) -> None:
        """Keep the fingerprint of a file."""
        self.sources[path] = hashlib.sha256(raw).hexdigest()

    def read(
        self, level: CellSpec | ArmSpec, keys: Sequence[str] = ()
    ) -> tuple[Robot, Srdf | None]:
        """Read the URDF or xacro file, and the SRDF if any, of a level that stands at `keys`."""
        path = self.find(level.urdf or "", (*keys, "urdf"))
        raw = read_bytes(path)
        self.note(path, raw)
        if path.suffix == ".xacro":
            from dualarm_pin.robot.xacro import expand_xacro

            raw = expand_xacro(path, level.xacro, self.package_dirs)
        robot, srdf = parse_urdf(raw, path), None
        self._warn(robot)
        if level.srdf is not None:
            path = self.find(level.srdf, (*keys, "srdf"))
            srdf = read_srdf(path, robot)
            self.note(path, read_bytes(path))
            self._warn(srdf)
        return robot, srdf

    def _warn(self, what: Robot | Srdf) -> None:
        self.warnings += [w for w in what.warnings if w not in self.warnings]


def read_robots(loader: Loader) -> tuple[dict[str, Chains], dict[str, Srdf]]:
    """Return the chains and the SRDF of each URDF: of `both` arms, or of `arm1` and `arm2`.

    Raises:
        MissingFileError: A file does not exist.
        InputError: A file, a tip or a key is wrong.
    """
    loader.warnings += [
        f"package_dirs: {folder} is no folder"
        for folder in loader.package_dirs
        if not is_folder(folder)
    ]
    return _read_each(loader) if loader.spec.urdf is None else _read_both(loader)


def _read_both(loader: Loader) -> tuple[dict[str, Chains], dict[str, Srdf]]:
    """Read one URDF that holds both arms."""
    for arm in ARMS:
        loader.refuse(
            getattr(loader.spec.arms, arm),
            ("urdf", "srdf", "base", "xacro"),
            ("arms", arm),
            "the URDF at the top of the file holds both arms already: remove `{}` "
            "here, or give each arm its own `urdf`",
        )
    robot, srdf = loader.read(loader.spec)
    first, second = (_tip(loader, robot, srdf, arm) for arm in ARMS)
    try:
        chains = twin_chains(robot, (first, second))
    except InputError as error:
        raise _placed(error, loader.blame, ("arms",)) from error
    return {"both": chains}, {} if srdf is None else {"both": srdf}


def _read_each(loader: Loader) -> tuple[dict[str, Chains], dict[str, Srdf]]:
    """Read a URDF for each arm; an arm without one is a frame that stands still."""
    belongs = "`{}` belongs to a `urdf` beside it; or give it to each arm"
    loader.refuse(loader.spec, ("srdf", "xacro"), (), belongs)
    chains: dict[str, Chains] = {}
    srdfs: dict[str, Srdf] = {}
    for arm in ARMS:
        own = getattr(loader.spec.arms, arm)
        if own.urdf is None:
            loader.refuse(
                own,
                ("tip", "group", "srdf", "xacro"),
                ("arms", arm),
                "`{}` needs a robot: give `urdf` for this arm, or one `urdf` at the "
                "top for both (an arm without a robot has `base` and `tool` only)",
            )
            continue
        robot, srdf = loader.read(own, ("arms", arm))
        if srdf is not None:
            srdfs[arm] = srdf
        chains[arm] = single_chain(robot, arm, _tip(loader, robot, srdf, arm))
    if not chains:
        message = "no robot: give `urdf` for each arm, or one `urdf` at the top for both"
        raise loader.blame(message, ("arms",))
    return chains, srdfs


def _tip(loader: Loader, robot: Robot, srdf: Srdf | None, arm: str) -> str:
    own = getattr(loader.spec.arms, arm)
    keys = ("arms", arm, "group" if own.group is not None else "tip")
    if own.tip is not None and own.group is not None:
        raise loader.blame("`tip` and `group` say the same thing: give one of them", keys)
    try:
        if own.group is not None:
            if srdf is None:
                raise loader.blame("`group` needs an `srdf`", keys)
            return srdf.tip(own.group)
        if own.tip is None:
            ends = ", ".join(robot.leaves()[:8])
            raise loader.blame(f"give the link that carries the tool; at the ends: {ends}", keys)
        return find_tip(robot, own.tip)
    except InputError as error:
        raise _placed(error, loader.blame, keys) from error


def _placed(error: InputError, blame: Blame, keys: Sequence[str]) -> InputError:
    """Return an error with the keys at fault, unless it names its own place."""
    if error.file is not None or error.field is not None:
        return error
    place = blame(error.message, keys)
    return type(error)(place.message, file=place.file, line=place.line, field=place.field)
