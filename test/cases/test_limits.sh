#!/bin/sh
# test/properties/extreme/table.md against what the command that makes it says now: sh test/cases/test_limits.sh
# The last line is `N passed, N failed`.
# Takes about 20 s.
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd) || exit
. "$root/test/checks.sh"
need python3
build_check_release || exit
cd "$root" || exit
title='test/properties/extreme/table.md is what sh test/properties/extreme/table.sh makes'
if "$run_dir/check-release" limits >"$work/table" && python3 test/properties/extreme/compare.py test/properties/extreme/table.md test/properties/extreme/introduction.md "$work/table"
then pass; else fails "$title"; fi
finish
