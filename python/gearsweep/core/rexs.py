"""A case from a file in the exchange format REXS of the FVA: geometry and load of a spur or helical stage."""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator, Mapping
from typing import Any

from .case import Case
from .files import content
from .library import Error

#: Attributes of a gear and of what belongs to it: the key and, as REXS fixes the units of its attributes, the factor to the key's unit.
_OF_GEAR = {'tip_diameter': ('tip_diameter_mm', 1.0), 'inner_diameter': ('bore_mm', 1.0)}
_OF_FLANK = {'addendum_modification_coefficient': ('profile_shift', 1.0), 'addendum_coefficient_basic_profile': ('addendum', 1.0)}
#: The addendum of the tool cuts the dedendum of the gear. The radius has another name from version 2.0 on.
_OF_TOOL = {
    'addendum_coefficient_reference_profile': ('dedendum', 1.0),
    'tip_radius_factor': ('rack_tip_radius', 1.0),
    'tip_corner_radius_factor_reference_profile': ('rack_tip_radius', 1.0),
}
_OF_MATERIAL = {'elastic_modulus': ('young_gpa', 1e-3), 'poisson_ratio': ('poisson', 1.0), 'density': ('density_kgm3', 1e3)}
#: Keys that state the load.
_TORQUES = {'torque_nm', 'torques_nm', 'normal_force_n', 'line_load_n_mm'}
_FACTORS = ('application_factor_iso_6336_2019', 'application_factor_iso_6336_2006')


class _Model:
    """Components of a file by their ids, and the relations between them."""

    def __init__(self, path: str):
        self.path = path
        text = content(path)
        if not text.lstrip(b'\xef\xbb\xbf \t\r\n').startswith(b'<'):
            raise Error(f'{path}: is not XML; of REXS, gearsweep reads files .rexs, but not .rexsj and .rexsz')
        try:
            model = ElementTree.fromstring(text)
        except ElementTree.ParseError as error:
            raise Error(f'{path}: is not XML: {error}') from None
        for node in model.iter():
            node.tag = node.tag.rpartition('}')[2]  # without a namespace
        if model.tag != 'model':
            raise Error(f'{path}: begins with {model.tag}, not with model, as a REXS file does')
        self.components = {node.get('id', ''): node for node in model.findall('components/component')}
        self.relations = [
            (node.get('type'), {ref.get('role', ''): ref.get('id', '') for ref in node.findall('ref')})
            for node in model.findall('relations/relation')
        ]
        self.cases = {node.get('id', ''): node for node in model.findall('load_spectrum/load_case')}
        self.case: dict[str, ElementTree.Element] = {}

    def values(self, load_case: str) -> dict[str, ElementTree.Element]:
        """What a load case states of components, by their ids."""
        return {node.get('id', ''): node for node in self.cases[load_case].findall('component')}

    def related(self, kind: str, role: str, other: str, component: str) -> list[str]:
        """Components with the role `other` in the relations of a kind in which this component has the role `role`."""
        return [refs[other] for type_, refs in self.relations if type_ == kind and refs.get(role) == component and other in refs]

    def kind(self, component: str) -> str:
        node = self.components.get(component)
        return '' if node is None else node.get('type', '')

    def named(self, component: str) -> str:
        return f'{self.kind(component)} {component}'

    def text(self, component: str, attribute: str) -> str | None:
        """The value of an attribute: that in the load case, else that of the component."""
        for node in (self.case.get(component), self.components.get(component)):
            for one in () if node is None else node.findall('attribute'):
                if one.get('id') == attribute and (one.text or '').strip():
                    return (one.text or '').strip()
        return None

    def number(self, component: str, attribute: str) -> float | None:
        text = self.text(component, attribute)
        try:
            return None if text is None else float(text)
        except ValueError:
            raise Error(f'{self.path}: {self.named(component)}: {attribute} = {text}: must be a number') from None

    def common(self, components: list[str], attribute: str) -> float | None:
        """The value of an attribute in the components that state it, which must agree."""
        values = {component: value for component in components if (value := self.number(component, attribute)) is not None}
        if len(set(values.values())) > 1:
            said = ', '.join(f'{value:g} of {self.named(component)}' for component, value in values.items())
            raise Error(f'{self.path}: {attribute} must be the same, not {said}')
        return next(iter(values.values()), None)


def read_rexs(path: str | os.PathLike, stage: str | None = None, load_case: str | None = None, **groups: Mapping[str, Any]) -> Case:
    """Reads a spur or helical stage from a REXS file (XML, versions 1.0 to 2.0) into a case.

    Reads geometry and load, but no modifications, tolerances or results. `gear_1` of the stage becomes the pinion, which drives. The first
    line of the case names what belongs to the gears but is not read.

    Parameters
    ----------
    path : path
        The file `.rexs`.
    stage : str, optional
        The id of the `cylindrical_stage`, where the file has several.
    load_case : str, optional
        The id of the load case, where the file has several and a task needs the torque.
    **groups : mappings
        Keys as for `Case.changed`: the tasks (otherwise `geometry`), what the file lacks, and what replaces its values.

    Raises
    ------
    Error
        The file is no REXS file, has no such stage or load case, or lacks a number, which is named with the key that states it instead;
        a group, key or value that no case can have.
        A value that no case can have is reported when the case is used.
    """
    Case.build(**groups)  # refuses what no case can have
    model = _Model(os.fspath(path))
    stage = _chosen(model.path, 'stage', [one for one in model.components if model.kind(one) == 'cylindrical_stage'], stage, model)
    pairs = [refs for kind, refs in model.relations if kind == 'stage' and refs.get('stage') == stage]
    gears = [pairs[0].get(role, '') for role in ('gear_1', 'gear_2')] if pairs else []
    if [model.kind(gear) for gear in gears] != ['cylindrical_gear'] * 2:
        raise Error(f'{model.path}: stage {stage} must have external gears, two of cylindrical_gear')
    given = {group.lower(): dict(keys) for group, keys in groups.items()}
    tasks = given.get('case', {}).get('tasks', 'geometry')
    tasks = [tasks] if isinstance(tasks, str) else list(tasks)
    read: dict[str, dict[str, Any]] = {'case': {'tasks': tasks}, **_geometry(model, stage, gears, given)}
    if set(tasks) != {'geometry'}:
        if load_case is not None or (model.cases and not _TORQUES & given.get('load', {}).keys()):
            model.case = model.values(_chosen(model.path, 'load_case', list(model.cases), load_case))
        for group, values in (*_material(model, gears).items(), ('load', _load(model, stage, gears, given))):
            read.setdefault(group, {}).update(values)
        if 'rating' in tasks and (rpm := _speed(model, gears[0])):
            read['rating'] = {'rpm': rpm}
    case = Case.build(**{group: read.get(group, {}) | given.get(group, {}) for group in {**read, **given}})
    rest = sorted(set(_not_read(model, gears)))
    note = f'! Stage {stage} of {os.path.basename(model.path)}' + (f'; not read: {", ".join(rest)}' if rest else '') + '\n'
    return Case(note + case.text)


def _chosen(path: str, what: str, ids: list[str], wanted: str | None, model: _Model | None = None) -> str:
    """The stated id, which must be among the ids, or the only one."""
    listed = ', '.join(f'{one} ({model.components[one].get("name")})' if model else one for one in ids)
    if wanted is None and len(ids) == 1:
        return ids[0]
    if wanted is None or str(wanted) not in ids:
        named = what.replace('_', ' ')
        said = f'no {named} {wanted}' if wanted is not None else f'{len(ids)} {named}s: state one as {what}=' if ids else f'no {named}'
        raise Error(f'{path}: has {said}' + (f'; there are {listed}' if ids else ''))
    return str(wanted)


def _flanks(model: _Model, gear: str) -> list[str]:
    return [flank for side in ('right', 'left') for flank in model.related('flank', 'gear', side, gear)]


def _geometry(model: _Model, stage: str, gears: list[str], given: Mapping[str, Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """The groups pair, pinion and gear."""
    groups: dict[str, dict[str, Any]] = {}

    def put(group: str, key: str, value: float | None, lacking: str = '') -> None:
        if value is not None:
            groups.setdefault(group, {})[key] = value
        elif lacking and key not in given.get(group, {}):
            raise Error(f'{model.path}: {lacking}: state it as {group}={{{key!r}: ...}}')

    flanks = [_flanks(model, gear) for gear in gears]
    put('pair', 'module_mm', model.common(gears, 'normal_module'), f'stage {stage} has no normal_module')
    widths = [width for gear in gears if (width := model.number(gear, 'face_width')) is not None]
    put('pair', 'face_width_mm', model.number(stage, 'common_face_width') or min(widths, default=None), f'stage {stage} has no face_width')
    angle = model.common([*flanks[0], *flanks[1]], 'normal_pressure_angle')
    put('pair', 'pressure_angle_deg', angle, f'stage {stage} has no normal_pressure_angle')
    put('pair', 'centre_distance_mm', model.number(stage, 'center_distance'))
    helix = [model.number(gear, 'helix_angle_reference_diameter') or 0.0 for gear in gears]
    if helix[0] != -helix[1]:
        raise Error(f'{model.path}: helix_angle_reference_diameter must be opposite, not {helix[0]:g} and {helix[1]:g}')
    if helix[0]:
        groups.setdefault('pair', {}).update(helix_angle_deg=abs(helix[0]), pinion_hand='right' if helix[0] > 0 else 'left')
    for name, gear, own in zip(('pinion', 'gear'), gears, flanks):
        teeth = model.number(gear, 'number_of_teeth')
        put(name, 'teeth', int(teeth) if teeth and teeth.is_integer() else teeth, f'{model.named(gear)} has no number_of_teeth')
        tools = [tool for flank in own for tool in model.related('manufacturing_step', 'workpiece', 'tool', flank)]
        tools = [tool for tool in tools if model.kind(tool) == 'rack_shaped_tool']
        for components, attributes in (([gear], _OF_GEAR), (own, _OF_FLANK), (tools, _OF_TOOL)):
            for attribute, (key, factor) in attributes.items():
                value = model.common(components, attribute)
                lacking = f'{model.named(gear)} has no {attribute}' if key == 'profile_shift' else ''
                put(name, key, None if value is None else value * factor, lacking)
    return groups


def _material(model: _Model, gears: list[str]) -> dict[str, dict[str, float]]:
    """Elastic constants and density of the gears' materials; a gear without a material has that of its shaft."""
    groups: dict[str, dict[str, float]] = {}
    for name, gear in zip(('pinion', 'gear'), gears):
        for origin in (gear, *model.related('assembly', 'part', 'assembly', gear)):
            found = [one for one in model.related('reference', 'origin', 'referenced', origin) if model.kind(one) == 'material']
            if found:
                values = {key: (model.number(found[0], attribute), factor) for attribute, (key, factor) in _OF_MATERIAL.items()}
                groups[name] = {key: value * factor for key, (value, factor) in values.items() if value is not None}
                break
    return groups


def _load(model: _Model, stage: str, gears: list[str], given: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    """The torque on the pinion, without its sign, and the application factor."""
    found: dict[str, float] = {}
    factor = next((value for one in _FACTORS if (value := model.number(stage, one)) is not None), None)
    if factor is not None:
        found['application_factor'] = factor
    if _TORQUES & given.get('load', {}).keys():
        return found
    for gear in gears:
        torque = _torque(model, stage, gear)
        if torque:
            teeth = [model.number(one, 'number_of_teeth') or 1.0 for one in (gears[0], gear)]
            return {'torque_nm': abs(torque) * teeth[0] / teeth[1], **found}
    raise Error(f"{model.path}: stage {stage} has no torque: state it as load={{'torque_nm': ...}}")


def _torque(model: _Model, stage: str, gear: str) -> float | None:
    """The torque of a gear in a stage. Where the stage has none and the gear is in no other stage: that on its shaft, as the gear
    states it or as the sum of the loads on a shaft without another gear."""
    own = [refs.get('stage_gear_data', '') for kind, refs in model.relations
           if kind == 'stage_gear_data' and refs.get('stage') == stage and refs.get('gear') == gear]  # fmt: skip
    if (torque := model.common(own, 'torque')) is not None:
        return torque
    if sum(kind == 'stage' and gear in refs.values() for kind, refs in model.relations) > 1:
        return None
    if (torque := model.number(gear, 'torque_acting_on_shaft_u')) is not None:
        return torque
    for shaft in model.related('assembly', 'part', 'assembly', gear):
        parts = model.related('assembly', 'assembly', 'part', shaft)
        loads = [model.number(part, 'torque_around_u_axis') for part in parts if model.kind(part) == 'external_load']
        if sum(model.kind(part).endswith('_gear') for part in parts) == 1 and any(loads):
            return sum(load for load in loads if load is not None)
    return None


def _speed(model: _Model, gear: str) -> float | None:
    """The speed of the gear or of its shaft in rpm, without its sign."""
    for component in (gear, *model.related('assembly', 'part', 'assembly', gear)):
        if (rpm := model.number(component, 'rotational_speed')) is not None:
            return abs(rpm)
    return None


def _not_read(model: _Model, gears: list[str]) -> Iterator[str]:
    """Types of the components that belong to the gears or their flanks and are not read, such as tip_relief."""
    own = {*gears, *(flank for gear in gears for flank in _flanks(model, gear))}
    for kind, refs in model.relations:
        if kind not in ('assembly', 'stage', 'stage_gear_data', 'flank', 'side') and own & set(refs.values()):
            for component in set(refs.values()) - own:
                if model.kind(component) not in ('rack_shaped_tool', 'material', ''):
                    yield model.kind(component)
