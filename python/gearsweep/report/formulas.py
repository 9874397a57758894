"""Formulas of a standard with the numbers of a study inserted, for a check of the calculation by hand."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from ..core.study import Study
from ..core.table import Table


@dataclass(frozen=True)
class Formula:
    """`symbol = expression`, with names of `values` in it; `result` is the library's value."""

    clause: str
    symbol: str
    expression: str
    values: Mapping[str, float]
    result: float
    unit: str = ''

    @property
    def numbers(self) -> str:
        """Returns the expression with numbers for all names."""
        return re.sub(r'[A-Za-z]\w*', lambda name: f'{self.values[name[0]]:.8g}' if name[0] in self.values else name[0], self.expression)


def formulas(study: Study) -> Iterator[tuple[str, list[Formula]]]:
    """Returns headings, each with its formulas; at present those of the task `rating`."""
    if 'rating' not in study:
        return
    yield 'Both gears', _common(study)
    for gear in ('pinion', 'gear'):
        yield from _of(study, gear)


def _common(study: Study) -> list[Formula]:
    factors, geometry = study.rating_factors.at(gear='pinion'), study.geometry
    values = _short(factors) | {
        'd_1': study.gears.at(gear='pinion').reference_diameter_mm,
        'b': geometry.face_width_mm,
        'u': study.case.get('gear', 'teeth') / study.case.get('pinion', 'teeth'),
        'z_1': study.case.get('pinion', 'teeth'),
        'eps_alpha': geometry.contact_ratio,
    }
    return [
        Formula('ISO 6336-2, clause 5', 'sigma_H0', 'Z_H * Z_E * Z_eps * sqrt(F_t / (d_1 * b) * (u + 1) / u)', values,
                factors.nominal_contact_mpa, 'MPa'),
        Formula('ISO 6336-1, clause 9', 'c_gamma_alpha', 'cprime * (0.75 * eps_alpha + 0.25)', values,
                factors.mesh_stiffness_n_mm_um, 'N/(mm µm)'),
        Formula('ISO 6336-1, 6.5.3', 'n_E1', '30000 / (pi * z_1) * sqrt(c_gamma_alpha / m_red)', values,
                factors.resonance_rpm, '1/min'),
    ]  # fmt: skip


def _of(study: Study, gear: str) -> Iterator[tuple[str, list[Formula]]]:
    """Returns the formulas of one gear at the two operating points of largest contact and root stress."""
    factors, rating = study.rating_factors.at(gear=gear), study.rating.at(gear=gear)
    for kind, clause, letter, expressions in STRESSES:
        stress = rating[f'{kind}_stress_mpa']
        if not np.isfinite(stress).any():
            continue
        relief, speed = np.unravel_index(np.nanargmax(stress), stress.shape)
        where = {'relief_um': float(rating.relief_um[relief]), 'rpm': float(rating.rpm[speed])}
        point = rating.at(**where)
        values = _short(factors) | {'b': study.geometry.face_width_mm, 'm': study.geometry.module_mm,
                                    'K_v': point.internal_dynamic_factor,
                                    f'sigma_{letter}': point[f'{kind}_stress_mpa']}  # fmt: skip
        found = [Formula(clause, symbol, text.replace('Z_B', 'Z_D') if gear == 'gear' else text, values, values[symbol], 'MPa')
                 for symbol, text in expressions.items()]  # fmt: skip
        if np.isfinite(safety := point[f'{kind}_safety']):
            values[f'sigma_{letter}G'] = factors[f'{kind}_limit_mpa']
            found.append(Formula(clause, f'S_{letter}', f'sigma_{letter}G / sigma_{letter}', values, safety))
        yield f'{gear.capitalize()}, {kind} stress where it is largest: {where["rpm"]:g} 1/min, relief {where["relief_um"]:g} µm', found


#: Stress, clause, its letter, and its factors.
STRESSES = (
    ('contact', 'ISO 6336-2, clause 5', 'H', {'sigma_H': 'Z_B * sigma_H0 * sqrt(K_A * K_v * K_H_beta * K_H_alpha)'}),
    ('root', 'ISO 6336-3, clause 5', 'F',
     {'sigma_F0': 'F_t / (b * m) * Y_F * Y_S * Y_B * Y_DT', 'sigma_F': 'sigma_F0 * K_A * K_v * K_F_beta * K_F_alpha'}),
)  # fmt: skip

#: Symbols of the standard for the columns of the table `rating_factors`.
SYMBOLS = {
    'F_t': 'tangential_load_n',
    'K_A': 'application_factor',
    'K_H_beta': 'face_load_factor',
    'K_F_beta': 'root_face_load_factor',
    'K_H_alpha': 'transverse_load_factor',
    'K_F_alpha': 'transverse_load_factor',
    'Z_H': 'zone_factor',
    'Z_B': 'single_pair_factor',
    'Z_D': 'single_pair_factor',
    'Z_E': 'elasticity_factor_sqrt_mpa',
    'Z_eps': 'contact_ratio_factor',
    'Y_F': 'form_factor',
    'Y_S': 'stress_correction',
    'Y_B': 'rim_factor',
    'Y_DT': 'deep_tooth_factor',
    'sigma_H0': 'nominal_contact_mpa',
    'sigma_F0': 'nominal_root_mpa',
    'cprime': 'single_stiffness_n_mm_um',
    'c_gamma_alpha': 'mesh_stiffness_n_mm_um',
    'm_red': 'reduced_mass_kg_mm',
}


def _short(factors: Table) -> dict[str, float]:
    return {symbol: factors[column] for symbol, column in SYMBOLS.items()}
