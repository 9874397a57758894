"""The packages that `gearsweep.many` needs; they are loaded where they are used, which is not in the processes that compute."""

from __future__ import annotations

import importlib.util


def check() -> None:
    """Raises a `ModuleNotFoundError` that says how to install what is missing."""
    for package in ('scipy', 'xarray', 'zarr'):
        if importlib.util.find_spec(package) is None:
            raise ModuleNotFoundError(f"gearsweep.many needs {package}, which is not installed: pip install 'gearsweep[many]'", name=package)
