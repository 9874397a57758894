#!/bin/sh
# Puts small bugs into the sources, all in one build, and runs the tests that reach each:
#   sh tools/mutate.sh [--rest | --resume] [--count N] [--workers N] [room ...]
# Rooms are the folders of src, and app and python; without one, all. doc/develop/tests.md has more.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
cd "$root" || exit
# Of the package only what builds it and what its tests load is needed; mutants are in a build of their own.
"$venv/bin/python" -c 'import mesonbuild, numpy, matplotlib, pytest' 2>/dev/null || build_package || exit
exec "$venv/bin/python" "$root/tools/mutation/mutate.py" "$@"
