"""Which of OpenBLAS's kernels the library computes with: bits depend on it."""

from __future__ import annotations

import ctypes
import functools

from .. import _flat


@functools.cache
def kernel() -> str:
    """The processor type whose kernel OpenBLAS chose, or that `OPENBLAS_CORETYPE` named; 'unknown' of another BLAS."""
    try:
        name = ctypes.CDLL(_flat.__file__).openblas_get_corename
    except (OSError, AttributeError):
        return 'unknown'
    name.restype = ctypes.c_char_p
    return (name() or b'unknown').decode()
