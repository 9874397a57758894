#!/bin/sh
# test/extreme/table.md against what the command that makes it says now: sh test/test_limits.sh
# The last line is `N passed, N failed`.
# Takes about 20 s.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/test/checks.sh"
need python3
build_check_release || exit
cd "$root" || exit
title='test/extreme/table.md is what sh test/extreme/table.sh makes'
if "$run_dir/check-release" limits >"$work/table" && python3 test/extreme/compare.py test/extreme/table.md test/extreme/introduction.md "$work/table"
then pass; else fails "$title"; fi
finish
