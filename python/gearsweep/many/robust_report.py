"""What is printed of robust reliefs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray

    from .robust import Robust


def report(found: Robust) -> str:
    """The table and what follows from it, in plain words."""
    table, of = found.table, found.table.attrs
    names = [str(name) for name in table.coords if name != 'candidate']
    sure = f'{100 * of["confidence"]:g} % sure'
    loads = f', {of["loads"]} loads' if of['loads'] > 1 else ''
    rows = [[*(name.partition('.')[2] for name in names), 'nominal', 'median', f'{100 * of["quantile"]:g} %', sure, 'above the best', sure, 'best in']]
    for at in range(table.sizes['candidate']):
        row = table.isel(candidate=at)
        value = {str(name): float(row[name]) for name in table.data_vars}
        rows.append([*(_said(row[name]) for name in names), *(f'{value[name]:.4f}' for name in ('nominal', 'median', 'value')),
                     _range(value, '', '.4f'), f'{value["worse"]:+.4f}', _range(value, 'worse_', '+.4f'), f'{100 * value["best_share"]:.0f} %'])  # fmt: skip
    wide = [max(map(len, column)) for column in zip(*rows)]
    lines = ['  '.join(cell.rjust(size) for cell, size in zip(row, wide)) for row in rows]
    best, nominal = found.best, found.nominal
    gap = {str(name): float(nominal[name]) for name in table.data_vars}
    others = [_name(found.alike.isel(candidate=at), names) for at in range(found.alike.sizes['candidate'])]
    others.remove(_name(best, names))
    left = f'; left out: {of["draws_left_out"]} draws, {of["candidates_left_out"]} candidates' if of['draws_left_out'] or of['candidates_left_out'] else ''
    return '\n'.join([
        f'Largest dynamic factor over the speeds; pairs of gears: {of["draws"]}, assemblies of each: {of["assemblies"]}{loads}{left}',
        *lines,
        f'Best as built: {_name(best, names)}: {float(best["value"]):.4f}',
        f'Best nominal: {_name(nominal, names)}: {gap["nominal"]:.4f}, as built {gap["value"]:.4f}',
        f'Not told from the best by these draws: {"; ".join(others) or "none"}',
    ])  # fmt: skip


def _range(value: Mapping[str, float], prefix: str, digits: str) -> str:
    return ' to '.join('?' if np.isnan(value[f'{prefix}{end}']) else f'{value[f"{prefix}{end}"]:{digits}}' for end in ('lower', 'upper'))


def _said(value: Any) -> str:
    one = value.item()
    return one if isinstance(one, str) else f'{one:g}'


def _name(row: xarray.Dataset, names: Sequence[str]) -> str:
    """A candidate by its keys."""
    return ', '.join(f'{name.partition(".")[2]} {_said(row[name])}' for name in names)
