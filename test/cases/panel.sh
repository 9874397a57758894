#!/bin/sh
# Tests of the front panel in a browser: sh test/run.sh --panel, or sh test/cases/panel.sh [pytest options]
# Belongs to --all of test/run.sh, which hands over the program.
# Installs Chromium (Debian) and Playwright where they are missing. With GEARSWEEP_SHOTS=FOLDER, pictures of every state go there.
# The last line is `N passed, N failed`, as pytest counts.
# Takes about 2 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
build_package && install_browser || exit

[ "${1-}" != "$run_dir/gearsweep" ] || shift
run_pytest "$root/test/cases/panel" "$@"
