#!/bin/sh
# The short form of test/cases/sanitize.sh, as a part of the tests.
# Belongs to --all of test/run.sh.
# Takes about 3 min.
exec sh "$(dirname -- "$0")/sanitize.sh" --short
