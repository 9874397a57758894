#!/bin/sh
# Makes the site with its notebook, and reads it in a browser without a network: sh test/cases/test_site.sh [PROGRAM]
# The last line is `N passed, N failed`, as pytest counts.
# Belongs to --all of test/run.sh.
# Takes about 3 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
build_package && install_browser || exit
sh "$root/doc/site.sh" || { echo '0 passed, 1 failed'; exit 1; }
run_pytest "$root/test/cases/site"
