#!/bin/sh
# The short form of test/sanitize.sh, as a part of the tests.
# Takes about 2 min.
exec sh "$(dirname -- "$0")/sanitize.sh" --short
