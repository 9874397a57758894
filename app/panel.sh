#!/bin/sh
# Opens the front panel in the browser: sh app/panel.sh [CASE.nml | FOLDER] [options]
# Sets up and builds first where needed. Paths are relative to the caller's folder.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
build_package || exit 125
exec "$venv/bin/python" -m gearsweep panel "$@"
