#!/bin/sh
# Builds the wheel for other machines and looks whether it has all that it needs: sh test/cases/test_wheel.sh
# The last line is `N passed, N failed`.
# Belongs to --all of test/run.sh.
# Takes about 30 s.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
need ldd

unpack() { "$venv/bin/python" -m zipfile -e "$work"/*manylinux*.whl "$work/unpacked"; }
# What the libraries find elsewhere than beside them is what every Linux has.
nothing_else() {
  find "$work/unpacked" -name '*.so*' -exec ldd {} + >"$work/needed" || return
  grep -q "$work/unpacked/.*openblas" "$work/needed" && grep -q "$work/unpacked/.*gfortran" "$work/needed" &&
    ! grep '=>' "$work/needed" | grep -v "=> .*$work/unpacked/" |
      grep -Ev '^\s(libc|libm|libmvec|libgcc_s|libpthread|libdl|librt|libz)\.so'
}
# factors PATH: by the package that lies there, or for none by that in .venv.
factors() {
  cd "$work" && PYTHONPATH=$1 "$venv/bin/python" - "$root/data/case1.nml" <<'END'
import sys
import gearsweep
case = gearsweep.Case.read(sys.argv[1]).changed(sweep={'rpm_step': 2000})
print(gearsweep.run(case, 'sweep').sweep.dynamic_factor.tobytes().hex())
print(gearsweep.__file__, file=sys.stderr)
END
}
same_bits() {
  factors "$work/unpacked" >"$work/ours" 2>"$work/where" && factors '' >"$work/theirs" || return
  grep -q "^$work/unpacked" "$work/where" && cmp "$work/ours" "$work/theirs"
}

check 'the wheel is built' sh "$root/app/wheel.sh" "$work"
check 'it is for many systems, and unpacks' unpack
check 'it needs nothing else' nothing_else
check 'it has the licences of what it contains' sh -c "ls '$work'/unpacked/gearsweep-*.dist-info/licenses/NOTICE"
check 'the same bits as the package' same_bits
is_usage() { sh "$root/app/wheel.sh" "$@"; [ $? = 2 ]; }
check 'the wheel wants a folder' is_usage
check 'the wheel refuses options' is_usage --folder
finish
