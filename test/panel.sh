#!/bin/sh
# Tests of the front panel in a browser: sh test/run.sh --panel, or sh test/panel.sh [pytest options]
# Installs Chromium (Debian) and Playwright where they are missing. With GEARSWEEP_SHOTS=FOLDER, pictures of every state go there.
# The last line is `N passed, N failed`, as pytest counts.
# Takes about 2 min.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/test/checks.sh"
build_package && install_browser || exit

cd "$work" || exit
{
  "$venv/bin/python" -m pytest -q -rs --tb=short -p no:cacheprovider "$root/test/panel" "$@"
  echo $? >code
} | tee said
code=$(cat code)
# number WORD: how many of these pytest's last line tells.
number() { tail -n 1 said | grep -Eo "[0-9]+ $1s?\b" | grep -Eo '[0-9]+' || echo 0; }
passed=$(number passed)
failed=$(($(number failed) + $(number error)))
[ "$code" = 0 ] || [ "$code" = 1 ] || failed=$((failed + 1))
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
