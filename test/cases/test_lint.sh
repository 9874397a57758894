#!/bin/sh
# The linters, as one part of the tests: sh test/cases/test_lint.sh
# Takes about 20 s.
exec sh "$(dirname -- "$0")/../lint.sh"
