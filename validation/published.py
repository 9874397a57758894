"""data/hassan2009.csv: the rows of the ledger that the program itself can compute, in the form it reads."""

import re

from . import ledger
from .cases import DATA

PATH = DATA / 'hassan2009.csv'
HEAD = '''# Hassan, Thanigaiyarasu, Ramamurti 2009: printed values that the case hassan.nml computes.
# Made from validation/hassan2009.csv by python -m validation --pages: change that one.
# status: stated (follows from the stated inputs), inferred (needs an input that is not
# stated), fitted (an input was found from this very value, so that agreement shows
# nothing), not reproducible (the stated inputs do not give it).
quantity,place,printed,unit,status,reason
'''
# What the program computes, src/study/case/published.f90, as far as the ledger has it from the same inputs
# (it has the stresses of the beam from another face width and length).
KNOWN = r'contact_ratio|(tangential|radial)_force_n|(beam|rayleigh)_frequency_rad_s|mode_\d_hz|step_\d_sigma_[xy]_mpa'


def text():
    """What the file should hold."""
    lines = [','.join((row.id, row.place.split(',')[0], row.printed, row.unit, row.inputs, row.reason))
             for row in ledger.read('hassan2009') if re.fullmatch(KNOWN, row.id)]
    return HEAD + '\n'.join(lines) + '\n'


def update():
    PATH.write_text(text(), encoding='utf-8')
