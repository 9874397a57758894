"""The results of the tasks: frozen, with their case, units and version."""

from __future__ import annotations

import dataclasses
import enum
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from . import _answers, _border
from .case import Case

if TYPE_CHECKING:
    import pandas
    import xarray

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]


class Status(enum.IntEnum):
    """What is known of an operating point. From `UNSTABLE` on there is no dynamic factor."""

    OK = 0  #: stable and periodic with the mesh
    MARGINAL = 1  #: periodic, but transients do not die out
    SUBHARMONIC = 2  #: stable, but repeats only after several mesh periods
    INEXACT = 3  #: the estimated error exceeds the tolerance
    UNSTABLE = 4  #: the periodic motion repels, and no steady motion was reached
    APERIODIC = 5  #: no periodic motion was found
    UNRESOLVED = 6  #: the speed is too low for the steps given or allowed
    CHATTER = 7  #: contact changes without end
    CHAOTIC = 8  #: no periodic motion was found, and disturbances keep growing
    STOPPED = 9  #: not computed: the run was interrupted before


class Contact(enum.IntEnum):
    """Whether the flanks stay together at an operating point."""

    FULL = 0  #: all pairs carry load at all times
    PARTIAL = 1  #: some pair was apart for a while
    LOST = 2  #: all flanks were apart for a while
    COAST = 3  #: the coast sides touched


def _words(kind: type[enum.IntEnum]) -> NDArray[np.str_]:
    """The names as the tables have them, by value."""
    return np.array([one.name.lower() for one in kind])


def _field(unit: str, *dims: str) -> Any:
    """A number or an array with its unit ('' for none) and the names of its dimensions."""
    return dataclasses.field(metadata={'unit': unit, 'dims': dims})


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """What a task answers. Arrays cannot be written to.

    Attributes
    ----------
    case : Case
        The case that was run.
    version : str
        Of the library that ran it.
    """

    case: Case
    version: str

    #: Names of what lies along a dimension, where it has names.
    labels: ClassVar[dict[str, list]] = {}
    #: Dimensions of the rows of `to_pandas`.
    rows: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self):
        for name in self.units:
            value = getattr(self, name)
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    @property
    def units(self) -> dict[str, str]:
        """The unit of each quantity; empty for plain numbers."""
        return {f.name: f.metadata['unit'] for f in dataclasses.fields(self) if 'unit' in f.metadata}

    @property
    def dims(self) -> dict[str, tuple[str, ...]]:
        """The dimensions of each quantity."""
        return {f.name: f.metadata['dims'] for f in dataclasses.fields(self) if 'dims' in f.metadata}

    def __repr__(self) -> str:
        return f'<gearsweep.{type(self).__name__}: {_answers.text(self)}>'

    def _repr_html_(self) -> str:
        return _answers.table(self)

    def save(self, path: str | os.PathLike) -> None:
        """Writes the result to a file that `gearsweep.read` reads: NumPy's npz format, bit by bit, no pickle."""
        from .store import save

        save(self, path)

    def to_pandas(self) -> pandas.DataFrame:
        """The rows as a table, first dimension outermost; single numbers and units are in its `attrs`."""
        from .tables import to_pandas

        return to_pandas(self)

    def to_xarray(self) -> xarray.Dataset:
        """All arrays with named dimensions and units; single numbers are in its `attrs`."""
        from .tables import to_xarray

        return to_xarray(self)


@dataclass(frozen=True, eq=False, repr=False)
class Geometry(Result):
    """Radii, path of contact and outlines of the pair.

    Attributes
    ----------
    radius_mm : array (circle, member)
        Tip, reference, drive base, coast base and root circle, and start of the drive involute.
    point : array (place)
        Start of contact A, B, pitch point P, D and end E along the path of contact, base pitches.
    point_radius_mm : array (place, member)
        Radius at which each member touches there.
    distance_mm : float
        Centre distance.
    working_angle_deg : array (side)
        Working pressure angle of the drive and coast flanks.
    contact_ratio, base_pitch_mm : float
        Transverse contact ratio; base pitch of the drive flanks.
    backlash_um : float
        Along the line of action.
    pinion_outline_mm, gear_outline_mm : array (pinion_point or gear_point, axis)
        Points x, y on the outline, clockwise about the gear's centre, its first tooth's axis along y; the
        last joins the first. One tooth of a gear with more than 500.
    """

    radius_mm: Reals = _field('mm', 'circle', 'member')
    point: Reals = _field('base pitch', 'place')
    point_radius_mm: Reals = _field('mm', 'place', 'member')
    distance_mm: float = _field('mm')
    working_angle_deg: Reals = _field('deg', 'side')
    contact_ratio: float = _field('')
    base_pitch_mm: float = _field('mm')
    backlash_um: float = _field('um')
    pinion_outline_mm: Reals = _field('mm', 'pinion_point', 'axis')
    gear_outline_mm: Reals = _field('mm', 'gear_point', 'axis')

    labels = {
        'circle': ['tip', 'reference', 'drive base', 'coast base', 'root', 'form'],
        'member': ['pinion', 'gear'],
        'place': ['A', 'B', 'P', 'D', 'E'],
        'side': ['drive', 'coast'],
        'axis': ['x', 'y'],
    }
    rows = ('place', 'member')


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Result):
    """What drives the motion.

    Attributes
    ----------
    load_n : float
        Static load on the line of action.
    mass_kg : array (member)
        Effective masses on it.
    stiffness_n_um : float
        Mean mesh stiffness, whole width.
    frequency_hz : float
        Natural frequency.
    turn_um, shared_um : float
        What whole gears turn about their bores under the load, which the motion leaves out, and what neighbouring
        teeth share beyond that: of a stiffness by finite elements, else 0.
    """

    load_n: float = _field('N')
    mass_kg: Reals = _field('kg', 'member')
    stiffness_n_um: float = _field('N/um')
    frequency_hz: float = _field('Hz')
    turn_um: float = _field('um')
    shared_um: float = _field('um')

    labels = {'member': ['pinion', 'gear']}
    rows = ('member',)


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(Result):
    """One pair along the path of contact, static; the rows of all reliefs after each other.

    Attributes
    ----------
    relief_um, s : array (row)
        Relief; path coordinate from A in base pitches, ascending. Where a pair enters or a relief begins,
        both sides have a row.
    pair_n_um, mesh_n_um : array (row)
        Stiffness of this pair; of all that carry and, of whole gears, their discs. Whole width.
    error_um : array (row)
        Profile error.
    share : array (row)
        Load on this pair over the static load.
    ste_um : array (row)
        Static transmission error.
    """

    relief_um: Reals = _field('um', 'row')
    s: Reals = _field('base pitch', 'row')
    pair_n_um: Reals = _field('N/um', 'row')
    mesh_n_um: Reals = _field('N/um', 'row')
    error_um: Reals = _field('um', 'row')
    share: Reals = _field('', 'row')
    ste_um: Reals = _field('um', 'row')

    rows = ('row',)


@dataclass(frozen=True, eq=False, repr=False)
class Harmonics(Result):
    """Static transmission error over one mesh period, as Fourier series.

    Over the phase tau, 0 where a pair enters at A, it is the mean + the sum of
    amplitude cos(2 pi harmonic tau + phase).

    Attributes
    ----------
    harmonic : array (harmonic)
        1, 2 ...; the mesh frequency is the first.
    relief_um : array (relief_um)
        As in the case.
    mean_um, rms_um, peak_to_peak_um : array (relief_um)
        Mean; root of the mean square of the deviation from it; largest less least value.
    amplitude_um, phase_deg : array (harmonic, relief_um)
        Of each harmonic.
    estimate_um : array (relief_um)
        Estimated error of mean and amplitudes.
    """

    harmonic: Integers = _field('', 'harmonic')
    relief_um: Reals = _field('um', 'relief_um')
    mean_um: Reals = _field('um', 'relief_um')
    rms_um: Reals = _field('um', 'relief_um')
    peak_to_peak_um: Reals = _field('um', 'relief_um')
    amplitude_um: Reals = _field('um', 'harmonic', 'relief_um')
    phase_deg: Reals = _field('deg', 'harmonic', 'relief_um')
    estimate_um: Reals = _field('um', 'relief_um')

    rows = ('relief_um', 'harmonic')


@dataclass(frozen=True, eq=False, repr=False)
class Load(Result):
    """Dynamic load of one pair along its path, at the speeds `load_rpm`.

    Attributes
    ----------
    relief_um, rpm : array (row)
        Relief and speed of the pinion.
    s : array (row)
        Path coordinate from A, base pitches.
    pair_load_n : array (row)
        Elastic load on the pair.
    dte_um : array (row)
        Dynamic transmission error.
    status : array (row)
        Of the operating point, see `Status`. One without an answer has a single row, in which the other numbers are NaN.
    periods, pair : array (row)
        Mesh periods until the motion repeats, and so many pairs differ; which of them this is, from 1 (0 without an answer).
    """

    relief_um: Reals = _field('um', 'row')
    rpm: Reals = _field('1/min', 'row')
    s: Reals = _field('base pitch', 'row')
    pair_load_n: Reals = _field('N', 'row')
    dte_um: Reals = _field('um', 'row')
    status: Integers = _field('', 'row')
    periods: Integers = _field('', 'row')
    pair: Integers = _field('', 'row')

    rows = ('row',)

    @property
    def status_name(self) -> NDArray[np.str_]:
        """`status` in words, as in the tables."""
        return _words(Status)[self.status]


@dataclass(frozen=True, eq=False, repr=False)
class Sweep(Result):
    """Dynamic factor over speed and relief.

    Attributes
    ----------
    rpm : array (rpm)
        Speed of the pinion, ascending.
    relief_um : array (relief_um)
        As in the case.
    dynamic_factor, estimate : array (rpm, relief_um)
        Largest pair load over the static load, and its estimated error; NaN without an answer.
    status, contact : array (rpm, relief_um)
        See `Status` and `Contact`.
    floquet_modulus : array (rpm, relief_um)
        What remains of a disturbance after the motion has repeated once.
    residual : array (rpm, relief_um)
        By how much the motion fails to repeat, in static deflections.
    steps, periods : array (rpm, relief_um)
        Steps in a mesh period; mesh periods until the motion repeats.

    Examples
    --------
    >>> import gearsweep
    >>> case = gearsweep.Case('''&pinion teeth = 25 effective_mass_kg = 0.8 / &gear effective_mass_kg = 0.8 /
    ...     &load normal_force_n = 7000 /
    ...     &mesh model = 'polynomial' contact_ratio = 1.6 coefficients = 400, 0, -120 /
    ...     &sweep rpm_first = 8000 rpm_last = 16000 rpm_step = 100 /''')
    >>> sweep = gearsweep.sweep(case)
    >>> sweep
    <gearsweep.Sweep: relief 0 um: worst DF 1.5... at 13700 rpm; resonances 13655 rpm: DF 1.5... at 0 um | 81 rpm, 1 relief_um>
    >>> rpm, factor = sweep.resonances()
    >>> print(rpm.round(-2))
    [13700.]
    >>> sweep.units['rpm'], sweep.is_complete
    ('1/min', True)
    """

    rpm: Reals = _field('1/min', 'rpm')
    relief_um: Reals = _field('um', 'relief_um')
    dynamic_factor: Reals = _field('', 'rpm', 'relief_um')
    estimate: Reals = _field('', 'rpm', 'relief_um')
    status: Integers = _field('', 'rpm', 'relief_um')
    contact: Integers = _field('', 'rpm', 'relief_um')
    floquet_modulus: Reals = _field('', 'rpm', 'relief_um')
    residual: Reals = _field('static deflection', 'rpm', 'relief_um')
    steps: Integers = _field('', 'rpm', 'relief_um')
    periods: Integers = _field('', 'rpm', 'relief_um')

    rows = ('relief_um', 'rpm')

    @property
    def is_complete(self) -> bool:
        """Every operating point has an answer."""
        return bool(np.all(self.status < Status.UNSTABLE))

    @property
    def status_name(self) -> NDArray[np.str_]:
        """`status` in words, as in the tables."""
        return _words(Status)[self.status]

    @property
    def contact_name(self) -> NDArray[np.str_]:
        """`contact` in words, as in the tables."""
        return _words(Contact)[self.contact]

    def resonances(self, relief: int = 0) -> tuple[Reals, Reals]:
        """Speeds (1/min) and dynamic factors of the maxima for one relief, by its index, ascending in speed.

        Maxima that stand out by 0.01 on both sides; of more than five, the five highest.
        """
        return _border.resonances(self.rpm, self.dynamic_factor[:, relief])


@dataclass(frozen=True, eq=False, repr=False)
class Optimum(Result):
    """The relief whose largest dynamic factor over all speeds is least.

    Attributes
    ----------
    relief_um : array (tried)
        Reliefs that were tried, ascending.
    worst_factor, rpm : array (tried)
        Largest dynamic factor over the speeds, and where that is.
    failed : array (tried)
        Speeds without an answer.
    best_um, best_factor, best_rpm : float
        The least of these; NaN where no relief has an answer.
    within_um : float
        The best lies within so much of the true optimum.
    """

    relief_um: Reals = _field('um', 'tried')
    worst_factor: Reals = _field('', 'tried')
    rpm: Reals = _field('1/min', 'tried')
    failed: Integers = _field('', 'tried')
    best_um: float = _field('um')
    best_factor: float = _field('')
    best_rpm: float = _field('1/min')
    within_um: float = _field('um')

    rows = ('tried',)


@dataclass(frozen=True, eq=False, repr=False)
class Section(Result):
    """Finite-element grid of a section of one member.

    Attributes
    ----------
    x_mm, y_mm : array (node)
        The loaded tooth's axis lies along y, the gear's centre at 0; of an even number of teeth, the
        middle of the space between the loaded tooth and the next one lies along y.
    element : array (element, corner)
        Nodes of each eight-node quadrilateral, counted from 0: corners, then the middles of the sides,
        anticlockwise.
    tooth : array (element)
        0 for the body, 1 for the first tooth from the left.
    """

    x_mm: Reals = _field('mm', 'node')
    y_mm: Reals = _field('mm', 'node')
    element: Integers = _field('', 'element', 'corner')
    tooth: Integers = _field('', 'element')

    rows = ('node',)


@dataclass(frozen=True, eq=False, repr=False)
class Modal(Section):
    """Natural frequencies and mode shapes of the section, which it carries along.

    Attributes
    ----------
    frequency_hz : array (mode)
        Ascending.
    estimate, residual : array (mode)
        Estimated relative error; residual of the eigenvalue problem.
    rim_share : array (mode)
        Share of the body below the teeth in the kinetic energy.
    shape : array (axis, node, mode)
        Displacements for a modal mass of 1 kg.
    """

    frequency_hz: Reals = _field('Hz', 'mode')
    estimate: Reals = _field('', 'mode')
    residual: Reals = _field('', 'mode')
    rim_share: Reals = _field('', 'mode')
    shape: Reals = _field('m/sqrt(kg)', 'axis', 'node', 'mode')

    labels = {'axis': ['x', 'y']}
    rows = ('mode',)


@dataclass(frozen=True, eq=False, repr=False)
class Stress(Section):
    """Stress all over the section for one position of the load, for pictures.

    Attributes
    ----------
    sigma_mpa : array (part, node)
        In x, in y, and shear (xy); the mean of the elements that meet in a node.
    relief_um, s, radius_mm, share : float
        Relief; where the load acts, and how much of the static load it is.
    """

    relief_um: float = _field('um')
    s: float = _field('base pitch')
    radius_mm: float = _field('mm')
    share: float = _field('')
    sigma_mpa: Reals = _field('MPa', 'part', 'node')

    labels = {'part': ['x', 'y', 'xy']}
    rows = ('node',)


@dataclass(frozen=True, eq=False, repr=False)
class Static(Result):
    """Root stress of one member while the load moves over the path with its real share.

    Attributes
    ----------
    relief_um : array (relief_um)
        As in the case.
    s, radius_mm : array (position)
        Where the load acts: path coordinate in base pitches, radius on this member.
    share : array (position, relief_um)
        Of the static load.
    sigma_mpa : array (side, position, relief_um)
        Stress along the surface at the fillet tangent of the case.
    parts_mpa : array (part, side, position, relief_um)
        Its components across (x) and along (y) the tooth axis, and shear (xy).
    tension_mpa, tension_deg, compression_mpa, compression_deg : array (relief_um)
        Largest over fillets and path, and the angle of the tangent to the tooth axis there.
    estimate : array (relief_um)
        Estimated relative error of the larger.
    iso_mpa, lewis_mpa : float
        ISO 6336-3 nominal stress sigma_F0 and Lewis', whole load at the outer point of single contact.
    """

    relief_um: Reals = _field('um', 'relief_um')
    s: Reals = _field('base pitch', 'position')
    radius_mm: Reals = _field('mm', 'position')
    share: Reals = _field('', 'position', 'relief_um')
    sigma_mpa: Reals = _field('MPa', 'side', 'position', 'relief_um')
    parts_mpa: Reals = _field('MPa', 'part', 'side', 'position', 'relief_um')
    tension_mpa: Reals = _field('MPa', 'relief_um')
    tension_deg: Reals = _field('deg', 'relief_um')
    compression_mpa: Reals = _field('MPa', 'relief_um')
    compression_deg: Reals = _field('deg', 'relief_um')
    estimate: Reals = _field('', 'relief_um')
    iso_mpa: float = _field('MPa')
    lewis_mpa: float = _field('MPa')

    labels = {'side': ['drive', 'coast'], 'part': ['x', 'y', 'xy']}
    rows = ('relief_um', 'position', 'side')


@dataclass(frozen=True, eq=False, repr=False)
class Study:
    """All that a case asks for; None for what it does not.

    Attributes
    ----------
    case : Case
        The case that was run.
    version : str
        Of the library that ran it.
    geometry : Geometry
        Where there are gears, whatever the tasks.
    motion : Motion
        Where a task needs the mesh.
    mesh, static, modal, section, load, sweep, optimum
        The results of the tasks of these names.
    harmonics : Harmonics
        Of the static transmission error, with `mesh`.
    """

    case: Case = dataclasses.field(repr=False)
    version: str
    geometry: Geometry | None = None
    motion: Motion | None = None
    mesh: Mesh | None = None
    harmonics: Harmonics | None = None
    static: Static | None = None
    modal: Modal | None = None
    section: Section | None = None
    load: Load | None = None
    sweep: Sweep | None = None
    optimum: Optimum | None = None

    @property
    def tasks(self) -> tuple[str, ...]:
        """The names of the results that there are."""
        parts = (field.name for field in dataclasses.fields(self))
        return tuple(name for name in parts if isinstance(getattr(self, name), Result))

    def __repr__(self) -> str:
        return f'<{_answers.study_text(self)}>'

    def _repr_html_(self) -> str:
        return _answers.study_table(self)

    def save(self, path: str | os.PathLike) -> None:
        """As `Result.save`, all results in one file."""
        from .store import save

        save(self, path)
