"""Values that plans are told, in Python and in files: those that no case or distribution takes are told with section and key."""

import warnings

import pytest

from gearsweep import Case, Code, Error

many = pytest.importorskip('gearsweep.many')
from scipy import stats  # noqa: E402
from test_many import CASE, TAKE  # noqa: E402

from gearsweep.many import plan_file  # noqa: E402

PLAN = """
case = 'case.nml'
kind = 'random'
n = 4
take = 'sweep_worst.worst_dynamic_factor'
[change.relief]
amount_um = 10
[vary.dynamics]
damping_ratio = [0.1, 0.2]
[vary.load]
normal_force_n = {distribution = 'norm', loc = 7000, scale = 300}
"""
HUGE = '1' + 400 * '0'
SHORT = r'10+\.\.\.0+'


def read(folder, old='', new=''):
    assert old in PLAN
    CASE.write(folder / 'case.nml')
    (folder / 'plan.toml').write_text(PLAN.replace(old, new, 1))
    return plan_file.read(str(folder / 'plan.toml')).plan


@pytest.mark.parametrize(('old', 'new', 'match'), [
    ('um = 10', 'um = 2020-01-01', r'\[change\]: &relief amount_um: a case has no values such as datetime.date\(2020, 1, 1\)'),
    ('um = 10', 'um = {a = 1}', r"\[change\]: &relief amount_um: a case has no values such as {'a': 1}"),
    ('0.2]', '2020-01-01]', r'\[vary.dynamics\]: &dynamics damping_ratio: a case has no values such as datetime.date'),
    ('0.2]', '{a = 1}]', r"\[vary.dynamics\]: &dynamics damping_ratio: a case has no values such as {'a': 1}"),
    ('0.2]', f'{HUGE}]', rf'\[vary.dynamics\]: &dynamics damping_ratio = {SHORT}: its values must be finite'),
    ('7000', HUGE, rf'\[vary.load\] normal_force_n: loc = {SHORT}: is too large'),
    ('300', HUGE, rf'\[vary.load\] normal_force_n: scale = {SHORT}: is too large'),
    ('7000', 'inf', r'\[vary.load\] normal_force_n: norm is not possible with loc = inf, scale = 300'),
    ('300', '0', r'\[vary.load\] normal_force_n: norm is not possible with loc = 7000, scale = 0'),
])  # fmt: skip
def test_values_of_a_file_that_cannot_be_are_reported_with_their_place(tmp_path, old, new, match):
    with warnings.catch_warnings(), pytest.raises(Error, match=match) as caught:
        warnings.simplefilter('error')
        read(tmp_path, old, new)
    assert caught.value.code == Code.INPUT


def test_whole_numbers_that_only_a_real_number_holds_are_taken(tmp_path):
    assert set(read(tmp_path, '0.2', '1' + 30 * '0').rows()[:, 0]) <= {0.1, 1e30}
    assert read(tmp_path, '7000', '1' + 30 * '0').rows()[:, 1] == pytest.approx(1e30, rel=1e-12)


def test_numbers_that_overflow_are_reported_alone():
    plan = many.Plan.random(CASE, 4, load={'normal_force_n': stats.norm(1e308, 1e308)})
    with warnings.catch_warnings(), pytest.raises(Error, match='&load normal_force_n: the distribution has numbers that are not finite'):
        warnings.simplefilter('error')
        plan.rows()


@pytest.mark.parametrize('n', [10**15, 99999999999999999999999])
@pytest.mark.parametrize('kind', ['random', 'lhs'])
def test_more_variants_than_fit_into_memory_are_reported(tmp_path, n, kind):
    """8 PB, above what a process may have an address for."""
    with pytest.raises(Error, match=f'n: {n} variants do not fit into memory') as caught:
        read(tmp_path, "'random'\nn = 4", f"'{kind}'\nn = {n}")
    assert caught.value.code == Code.MEMORY


@pytest.mark.parametrize('kind', ['random', 'lhs', 'sobol', 'saltelli'])
def test_the_group_case_can_be_varied(tmp_path, kind):
    plan = read(tmp_path, "'random'\nn = 4", f"'{kind}'\nn = 16")
    varied = read(tmp_path, PLAN[:PLAN.index('[vary')], PLAN[:PLAN.index('[vary')].replace("'random'\nn = 4", f"'{kind}'\nn = 16")
                  + "[vary.case]\ntitle = ['one', 'other']\n")  # fmt: skip
    assert varied.names == ('case.title', *plan.names)
    assert {varied.case(at).get('case', 'title') for at in range(varied.n)} == {'one', 'other'}


def test_a_grid_over_tasks():
    data = many.run(many.Plan.grid(CASE, case={'tasks': ['sweep', ['sweep', 'mesh']]}), TAKE[0])
    assert data[TAKE[0]][0] == data[TAKE[0]][1]


def test_changed_names_the_key_of_a_value_that_no_case_has():
    with pytest.raises(Error, match=r'&pair module_mm: a case has no values such as 1j'):
        Case('').changed(pair={'module_mm': 1j})
