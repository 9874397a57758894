#!/bin/sh
# The short form of test/sanitize.sh, as a part of the tests.
exec sh "$(dirname -- "$0")/sanitize.sh" --short
