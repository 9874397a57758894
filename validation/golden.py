"""Pins of our own earlier output; the functions that golden.csv names."""

from .cases import result
from .dogan2021 import peak_factor, peak_rpm  # noqa: F401 (for the ledger)
from .quantities import mode, root_tension  # noqa: F401


def best_relief(name):
    """Relief of the least worst DF, um."""
    return result('optimum', name).best_um
