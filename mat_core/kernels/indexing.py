"""How kernels reach an item of an array: in the few instructions that it takes.

Numba unpacks the whole description of an array at each access, dozens of instructions that the optimiser takes out again. Kernels
know contiguous arrays only, and one whole number for each axis: that needs the address and a length, two fields of it.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, config, types
from numba.core.types.containers import BaseTuple
from numba.core.types.npytypes import Array
from numba.core.types.scalars import Integer
from numba.np.arrayobj import load_item, store_item

_DATA, _SHAPE = 4, 5  # fields of an array's description, see Numba's ArrayModel

Access = Callable[..., Any]


def item_access(context: Any, function: Any, signature: Any) -> Access | None:
    """What reads or writes one item of a contiguous array, called as the compiler calls its own; None for anything else.

    Where indices are to be checked the compiler's own way does it.
    """
    operation = getattr(function, "typing_key", None)
    if operation not in (operator.getitem, operator.setitem) or config.BOUNDSCHECK:
        return None
    array, index, *_ = signature.args
    if not isinstance(array, Array) or array.layout != "C":
        return None
    axes = tuple(index) if isinstance(index, BaseTuple) else (index,)
    if len(axes) != array.ndim or not all(isinstance(axis, Integer) for axis in axes):
        return None

    def read(builder: Any, values: Any, loc: object = None) -> Any:
        return load_item(context, builder, array, _place(context, builder, array, axes, *values))

    def write(builder: Any, values: Any, loc: object = None) -> Any:
        value = context.cast(builder, values[2], signature.args[2], array.dtype)
        store_item(context, builder, array, value, _place(context, builder, array, axes, *values[:2]))

    return read if operation is operator.getitem else write


def _place(context: Any, builder: Any, array: Any, axes: tuple[Any, ...], base: Any, index: Any) -> Any:
    """Pointer to the item: the indices of all axes as one number, in the order of C. Negative ones count from the end."""
    parts = cgutils.unpack_tuple(builder, index) if isinstance(index.type, (ir.ArrayType, ir.LiteralStructType)) else [index]
    place = None
    for axis, (part, kind) in enumerate(zip(parts, axes, strict=True)):
        at = context.cast(builder, part, kind, types.intp)
        length = None
        if kind.signed and not isinstance(at, ir.Constant):
            length = builder.extract_value(base, (_SHAPE, axis))
            at = builder.select(builder.icmp_signed("<", at, at.type(0)), builder.add(at, length), at)
        if place is not None:
            at = builder.add(builder.mul(place, length or builder.extract_value(base, (_SHAPE, axis))), at)
        place = at
    return builder.gep(builder.extract_value(base, _DATA), [place])
