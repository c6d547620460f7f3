"""Records of arrays that compiled functions take as one pointer.

numba passes a record by value, field by field: with sixty arrays every call would move five
hundred numbers and every function would take seconds to compile. A class registered here is read
from Python once, at the entry; inside, it is an address. It is read-only there (its arrays are
not) and cannot be built or returned by compiled code.

A field that is no array, number or registered record, such as a cell, stays in Python.
"""

# mypy: disable-error-code="no-untyped-call, untyped-decorator, override"

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.imputils import impl_ret_borrowed
from numba.core.typing.templates import AttributeTemplate
from numba.extending import (
    NativeValue,
    infer_getattr,
    lower_getattr_generic,
    models,
    register_model,
    typeof_impl,
    unbox,
)

from dualarm_pin.errors import ShapeError


class Reference(types.Type):
    """The compiled type: a pointer to the fields of a record.

    Attributes:
        fields: Names of the fields that compiled code sees.
        members: Their numba types.
    """

    def __init__(self, name: str, fields: tuple[str, ...], members: tuple[Any, ...]) -> None:
        self.fields, self.members = fields, members
        self.dtype = types.Tuple(members)
        super().__init__(name=f"{name}({', '.join(map(str, members))})")


register_model(Reference)(models.PointerModel)


def by_reference(cls: type, fields: tuple[str, ...]) -> None:
    """Let compiled functions take objects of this class as one pointer to these fields.

    Arrays are taken as C-contiguous and writable, whatever their flags say of writing: compiled
    code writes into room only.
    """
    known: dict[tuple[object, ...], Reference] = {}

    def type_of(value: Any, context: Any) -> Reference:
        members = [getattr(value, field) for field in fields]
        shape = tuple(_fingerprint(member) for member in members)
        if shape not in known:
            pairs = zip(fields, members, strict=True)
            found = tuple(_member_type(cls, name, member, context) for name, member in pairs)
            known[shape] = Reference(cls.__name__, fields, found)
        return known[shape]

    typeof_impl.register(cls)(type_of)


def _fingerprint(member: Any) -> object:
    """Return what decides the type of a member, cheaply: this runs at every call."""
    if isinstance(member, np.ndarray):
        return member.ndim, member.dtype.char, member.flags.c_contiguous
    if isinstance(member, float | int):
        return type(member)
    return typeof_impl(member, None)


def _member_type(cls: type, name: str, member: Any, context: Any) -> Any:
    found = typeof_impl(member, context)
    if not isinstance(found, types.Array):
        return found
    if not member.flags.c_contiguous:
        raise ShapeError("must be contiguous", field=f"{cls.__name__}.{name}")
    return types.Array(found.dtype, found.ndim, "C")


@unbox(Reference)
def _unbox(reference: Any, value: Any, context: Any) -> Any:
    """Read the fields into the frame of the entry's wrapper, which outlives the call."""
    builder = context.builder
    place = cgutils.alloca_once(builder, context.context.get_value_type(reference.dtype))
    failed = cgutils.alloca_once_value(builder, cgutils.false_bit)
    release: list[Callable[[], None]] = []
    for at, (name, member) in enumerate(zip(reference.fields, reference.members, strict=True)):
        field = context.pyapi.object_getattr_string(value, name)
        native = context.unbox(member, field)
        context.pyapi.decref(field)  # the record itself keeps it
        with builder.if_then(native.is_error, likely=False):
            builder.store(cgutils.true_bit, failed)
        builder.store(native.value, cgutils.gep_inbounds(builder, place, 0, at))
        release.append(_release(context, member, native))

    def cleanup() -> None:
        for one in reversed(release):
            one()

    return NativeValue(place, is_error=builder.load(failed), cleanup=cleanup)


def _release(context: Any, member: Any, native: Any) -> Callable[[], None]:
    """Return code that gives a member back: without it every call would keep all arrays alive."""

    def give_back() -> None:
        if native.cleanup is not None:
            native.cleanup()
        context.context.nrt.decref(context.builder, member, native.value)

    return give_back


@infer_getattr
class _Attributes(AttributeTemplate):
    key = Reference

    def generic_resolve(self, reference: Any, name: str) -> Any:
        fields = reference.fields
        return reference.members[fields.index(name)] if name in fields else None


@lower_getattr_generic(Reference)
def _load(context: Any, builder: Any, reference: Any, place: Any, name: str) -> Any:
    """Load one field."""
    at = reference.fields.index(name)
    field = reference.members[at]
    pointer = cgutils.gep_inbounds(builder, place, 0, at)
    loaded = context.data_model_manager[field].load_from_data_pointer(builder, pointer)
    return impl_ret_borrowed(context, builder, field, loaded)
