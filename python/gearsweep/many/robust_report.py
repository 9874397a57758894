"""What is printed of robust reliefs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from .clusters import enough
from .judged import QUANTITIES, Quantity

if TYPE_CHECKING:
    import xarray

    from .robust import Robust


def report(found: Robust) -> str:
    """The table and what follows from it, in plain words."""
    table, of = found.table, found.table.attrs
    judged = QUANTITIES[of['judged']]
    digits, unit = judged.digits, judged.unit and f' {judged.unit}'
    names = [str(name) for name in table.coords if name != 'candidate']
    each = [table.isel(candidate=at) for at in range(table.sizes['candidate'])]
    rows = [_heading(names, of), *(_row(one, names, digits) for one in each)]
    wide = [max(map(len, column)) for column in zip(*rows)]
    best = found.best
    others = [_name(one, names) for one in each if not float(one['worse_lower']) > 0 and int(one['candidate']) != int(best['candidate'])]
    lines = [_counts(of, judged), *('  '.join(cell.rjust(size) for cell, size in zip(row, wide)) for row in rows)]
    lines.append(f'Best as built: {_name(best, names)}: {float(best["value"]):.{digits}f}{unit}')
    if not np.isnan(table['nominal']).all():
        one = found.nominal
        lines.append(f'Best nominal: {_name(one, names)}: {float(one["nominal"]):.{digits}f}{unit}, as built {float(one["value"]):.{digits}f}{unit}')
    lines.append(f'Not told from the best by these draws: {"; ".join(others) or "none"}')
    if np.isnan([float(one[end]) for one in each for end in ('lower', 'upper')]).any():
        lines.append(f'?: too few draws for this quantile and confidence; {enough(of["quantile"], of["confidence"])} are enough')
    return '\n'.join(lines)


def _counts(of: Mapping[Any, Any], judged: Quantity) -> str:
    said = f'{judged.words}{judged.unit and f", {judged.unit}"}; pairs of gears: {of["draws"]}, assemblies of each: {of["assemblies"]}'
    if of['loads'] > 1:
        said += f', loads: {of["loads"]}'
    if of['draws_left_out'] or of['candidates_left_out']:
        said += f'; left out: {of["draws_left_out"]} draws, {of["candidates_left_out"]} candidates'
    return said


def _heading(names: Sequence[str], of: Mapping[Any, Any]) -> list[str]:
    sure = f'{100 * of["confidence"]:g} % sure'
    keys = [name.partition('.')[2] for name in names]
    return [*keys, 'nominal', 'median', f'{100 * of["quantile"]:g} %', sure, 'above the best', sure, 'best in']


def _row(one: xarray.Dataset, names: Sequence[str], digits: int) -> list[str]:
    value = {str(name): float(one[name]) for name in one.data_vars}
    share = value['best_share']
    numbers = [f'{value[name]:.{digits}f}' for name in ('nominal', 'median', 'value')]
    return [*(_said(one[name]) for name in names), *numbers, _range(value, '', f'.{digits}f'), f'{value["worse"]:+.{digits}f}',
            _range(value, 'worse_', f'+.{digits}f'), '?' if np.isnan(share) else f'{100 * share:.0f} %']  # fmt: skip


def _range(value: Mapping[str, float], prefix: str, digits: str) -> str:
    return ' to '.join('?' if np.isnan(value[f'{prefix}{end}']) else f'{value[f"{prefix}{end}"]:{digits}}' for end in ('lower', 'upper'))


def _said(value: Any) -> str:
    one = value.item()
    return one if isinstance(one, str) else f'{one:g}'


def _name(row: xarray.Dataset, names: Sequence[str]) -> str:
    """A candidate by its keys."""
    return ', '.join(f'{name.partition(".")[2]} {_said(row[name])}' for name in names)
