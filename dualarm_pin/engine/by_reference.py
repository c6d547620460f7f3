"""Named tuples of arrays that compiled functions take as one pointer.

numba passes a named tuple by value, field by field: with sixty arrays every call would move five
hundred numbers and every function would take seconds to compile. A class decorated here is read
from Python once, at the entry; inside, it is an address. It is read-only there (its arrays are
not) and cannot be built or returned by compiled code.
"""

# mypy: disable-error-code="no-untyped-call, untyped-decorator, override"

from __future__ import annotations

from typing import Any, TypeVar

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

C = TypeVar("C", bound=type)


class Reference(types.Type):
    """The compiled type: a pointer to a named tuple.

    Attributes:
        dtype: The numba type of the named tuple.
    """

    def __init__(self, dtype: Any) -> None:
        self.dtype = dtype
        super().__init__(name=f"Reference({dtype})")


register_model(Reference)(models.PointerModel)


def by_reference(cls: C) -> C:
    """Make compiled functions take this NamedTuple class as one pointer."""

    def type_of(value: Any, context: Any) -> Reference:
        fields = tuple(typeof_impl(field, context) for field in value)
        return Reference(types.NamedTuple(fields, cls))

    typeof_impl.register(cls)(type_of)
    return cls


@unbox(Reference)
def _unbox(reference: Any, value: Any, context: Any) -> Any:
    """Read the fields into the frame of the entry's wrapper, which outlives the call."""
    inner = context.unbox(reference.dtype, value)
    place = cgutils.alloca_once_value(context.builder, inner.value)
    return NativeValue(place, is_error=inner.is_error, cleanup=inner.cleanup)


@infer_getattr
class _Attributes(AttributeTemplate):
    key = Reference

    def generic_resolve(self, reference: Any, name: str) -> Any:
        fields = reference.dtype.fields
        return reference.dtype.types[fields.index(name)] if name in fields else None


@lower_getattr_generic(Reference)
def _load(context: Any, builder: Any, reference: Any, place: Any, name: str) -> Any:
    """Load one field."""
    at = reference.dtype.fields.index(name)
    field = reference.dtype.types[at]
    pointer = cgutils.gep_inbounds(builder, place, 0, at)
    loaded = context.data_model_manager[field].load_from_data_pointer(builder, pointer)
    return impl_ret_borrowed(context, builder, field, loaded)
