#!/bin/sh
# The released program beside two other builds of it: sh test/cases/test_matrix.sh
# Belongs to --all of test/run.sh.
# Takes about 1 min.
# (The program that test/run.sh hands over is the released one, which test/cases/matrix.sh builds unless it is current.)
exec sh "$(dirname -- "$0")/matrix.sh" --quick
