"""`call: module:function` in a file: code of the user's own, run only where that is allowed.

The shape is the same wherever a file takes an index, a row, a path, a solver or a planner of the
user's own: a mapping with `call`, whose other keys are keyword arguments of the function.

    index: {call: "my_index:along", weight: 2}      # along(weight=2) returns an Index

A module is found beside the file, in a folder of `module_dirs` in that file, or wherever Python
finds modules. Nothing is imported unless `allow_code` says so: a file from a stranger runs nothing.
"""

from __future__ import annotations

import importlib
import inspect
import re
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import ConfigDict, Field

from dualarm_pin.errors import DualArmError, InputError, nearest
from dualarm_pin.files.read import is_file
from dualarm_pin.files.source import Key, Source, Spec

T = TypeVar("T")
Place = tuple[Key, ...]
_PATTERN = r"^[\w.]+:\w+$"
ModuleAndFunction = Annotated[str, Field(pattern=_PATTERN)]


class CallSpec(Spec):
    """A function of the user's own, and its keyword arguments beside it.

    Attributes:
        call: Module and function, such as `my_planner:plan`.
    """

    model_config = ConfigDict(extra="allow")

    call: ModuleAndFunction

    @property
    def arguments(self) -> dict[str, Any]:
        """The keyword arguments by name."""
        return dict(self.model_extra or {})


@dataclass(frozen=True)
class OwnFunction:
    """A function that a file names: its mistakes name the file, the line and the field.

    Attributes:
        function: The function, or an instance of a class that can be called.
        named: `module:function` as a message, with the file, line and field that name it.
        arguments: Keyword arguments of every call.
        folder: Where its module was found; None if Python finds it anyway.
    """

    function: Callable[..., Any]
    named: InputError
    arguments: Mapping[str, Any]
    folder: Path | None = None

    @property
    def name(self) -> str:
        """What it is called in results: `module:function`."""
        return self.named.message

    def __call__(self, *given: Any, **more: Any) -> Any:
        """Call it; what it raises is an error of the file, unless it names its own place."""
        try:
            return self.function(*given, **more, **self.arguments)
        except InputError as error:
            raise self.error(str(error)) from error
        except DualArmError:
            raise
        except Exception as error:
            raise self.error(_raised(error)) from error

    def __getattr__(self, name: str) -> Any:
        """Return a method of an instance, such as `solve_many` of a solver, guarded as this is."""
        if name.startswith("__"):
            raise AttributeError(name)
        value = getattr(self.function, name)
        return replace(self, function=value, arguments={}) if callable(value) else value

    def instance(self) -> OwnFunction:
        """Return this, with an instance in the place of a class.

        Raises:
            InputError: It cannot be made, or called.
        """
        if not isinstance(self.function, type):
            return self
        made = self()
        if not callable(made):
            raise self.error("an instance of this class cannot be called: give it `__call__`")
        return replace(self, function=made, arguments={})

    def result(self, kind: type[T], *given: Any, **more: Any) -> T:
        """Call it and insist on what it returns.

        Raises:
            InputError: It raises, or returns anything else.
        """
        value = self(*given, **more)
        if not isinstance(value, kind):
            raise self.error(f"a {kind.__name__} is expected; it returned {value!r:.80}")
        return value

    def error(self, message: str) -> InputError:
        """Return an error about this function."""
        where = self.named
        return InputError(
            f"{self.name}: {message}", file=where.file, line=where.line, field=where.field
        )


def refuse_calls(source: Source, *, allow_code: bool) -> None:
    """Refuse a file that names code of its own, unless that is allowed; nothing is imported.

    Raises:
        InputError: It does: names file, line, field, what it would import and how to allow it.
    """
    named = None if allow_code else next(iter(calls_of(source)), None)
    if named is None:
        return
    keys, text = named
    module, _, function = text.partition(":")
    file = module_file(source, module)
    where = f"from {file}" if file else "from wherever Python finds it"
    raise source.error(
        f"it would import the module {module!r} {where} and call {function!r}. A file runs no code "
        "unless you say so: read that code, then give --allow-code, or allow_code=True in Python",
        keys,
    )


def own_functions(
    source: Source, calls: Mapping[Place, CallSpec], *, allow_code: bool
) -> dict[Place, OwnFunction]:
    """Import every function that a file calls, in one pass, if it was allowed to run code.

    Args:
        source: The file.
        calls: Where each stands: the keys of the mapping with `call`.
        allow_code: Whether it may.

    Raises:
        InputError: It may not; or there is no such module or function, or it does not take these
            arguments.
    """
    refuse_calls(source, allow_code=allow_code)
    return {place: _imported(source, place, spec) for place, spec in calls.items()}


def _imported(source: Source, place: Place, spec: CallSpec) -> OwnFunction:
    keys = (*place, "call")
    module_name, _, name = spec.call.partition(":")
    module, folder = _module(source, module_name, keys)
    function = getattr(module, name, None)
    if not callable(function):
        known = [key for key, value in vars(module).items() if callable(value) and key[0] != "_"]
        hint = nearest(name, known)
        raise source.error(f"the module {module_name!r} has no function {name!r}: {hint}", keys)
    _refuse_unknown(source, place, function, spec.arguments)
    return OwnFunction(function, source.error(spec.call, keys), spec.arguments, folder)


def _refuse_unknown(
    source: Source, keys: Sequence[Key], function: Callable[..., Any], given: Mapping[str, Any]
) -> None:
    """Refuse a keyword argument that the function does not take."""
    try:
        parameters = inspect.signature(function).parameters.values()
    except (ValueError, TypeError):  # a function of C
        return
    if any(p.kind is p.VAR_KEYWORD for p in parameters):
        return
    known = [p.name for p in parameters if p.kind in (p.KEYWORD_ONLY, p.POSITIONAL_OR_KEYWORD)]
    for key in given:
        if key not in known:
            raise source.error(f"unknown key: {nearest(key, known)}", [*keys, key])


def _module(source: Source, name: str, place: Place) -> tuple[Any, Path | None]:
    """Return a module, and the folder of the file's own in which it was found."""
    file, folders = module_file(source, name), _folders(source)
    for folder in map(str, folders):
        if file is not None and folder not in sys.path:
            # Last, so that it hides nothing; for good, so that worker processes find it too.
            sys.path.append(folder)
            importlib.invalidate_caches()
    try:
        module = importlib.import_module(name)
    except (Exception, SystemExit) as error:
        missing = getattr(error, "name", None) if isinstance(error, ModuleNotFoundError) else None
        why = _raised(error) if missing is None else str(error)
        message = f"importing {name!r}: {why}"
        if missing is not None and f"{name}.".startswith(f"{missing}."):
            where = ", ".join(map(str, folders))
            message = f"there is no module {name!r} in {where} or where Python finds modules"
        raise source.error(message, place) from error
    loaded = getattr(module, "__file__", None)
    if file is None:
        return module, None
    if loaded is None or Path(loaded).resolve() != file:
        message = f"the module {name!r} is {loaded}, not {file}: two have this name, rename yours"
        raise source.error(message, place)
    return module, file.parents[name.count(".") + (file.name == "__init__.py")]


def module_file(source: Source, module: str) -> Path | None:
    """Return the file of a module in a folder that `source` names, or None; imports nothing."""
    for folder in _folders(source):
        stem = folder.joinpath(*module.split("."))
        for file in (stem.with_suffix(".py"), stem / "__init__.py"):
            if is_file(file):
                return file
    return None


def _folders(source: Source) -> list[Path]:
    """Return where a file's own modules are: in its folder, and in those that it names."""
    here = source.path.parent.resolve()
    named = source.data.get("module_dirs")
    folders = [str(folder) for folder in named] if isinstance(named, list) else []
    return [here, *((here / folder).resolve() for folder in folders)]


def calls_of(source: Source) -> list[tuple[tuple[Key, ...], str]]:
    """Return where a file names code of its own, and which: `module:function`."""
    return list(_calls(source.data, ()))


def _calls(data: Any, keys: tuple[Key, ...]) -> Iterator[tuple[tuple[Key, ...], str]]:
    """Yield every `call` outside the cell, which takes none, and what it names."""
    if isinstance(data, dict):
        if isinstance(data.get("call"), str) and re.match(_PATTERN, data["call"]):
            yield (*keys, "call"), data["call"]
        parts = [(key, value) for key, value in data.items() if (*keys, key) != ("cell",)]
    elif isinstance(data, list):
        parts = list(enumerate(data))
    else:
        return
    for key, value in parts:
        yield from _calls(value, (*keys, key))


def _raised(error: BaseException) -> str:
    frame = traceback.extract_tb(error.__traceback__)[-1]
    what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return f"it raised {what} ({Path(frame.filename).name}:{frame.lineno})"
