#!/bin/sh
# Runs a case: sh app/run.sh data/case1.nml [options]
# Sets up and builds first where needed. Paths are relative to the caller's folder.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
build_program || exit 125
exec "$run_dir/gearsweep" "$@"
