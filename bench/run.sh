#!/bin/sh
# Times the finite elements beside scikit-fem with SciPy and beside CalculiX: sh bench/run.sh
# Sets up first where needed; prints a Markdown table. It takes some minutes.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
mkdir -p "$run_dir" || exit

install_calculix() {
  command -v ccx >/dev/null && return
  as_root=
  [ "$(id -u)" = 0 ] || as_root=sudo
  quietly "looking for packages" $as_root apt-get update -q || say "going on with the old package lists"
  quietly "installing calculix-ccx" $as_root env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends calculix-ccx
}

install_packages && make_venv && install_calculix || exit
quietly "fetching SciPy and scikit-fem" "$venv/bin/python" -m pip install --disable-pip-version-check \
  numpy==2.4.6 scipy==1.17.1 scikit-fem==12.0.2 || exit
quietly "building the benchmark" "$venv/bin/fpm" run elastic --directory "$root/bench" --profile release \
  --runner echo || exit
elastic=$root/bench/$(sed -n 's|^\(build/[^ ]*\) *$|\1|p' "$log" | tail -n 1)

OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 exec "$venv/bin/python" "$root/bench/compare.py" "$elastic"
