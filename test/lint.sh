#!/bin/sh
# What can be said of the sources without running them: sh test/lint.sh
# ruff and mypy over Python, fortitude over Fortran; pyproject.toml has the rules, and why others are left out.
# Then test/cases/imports.py: the rooms of the Python package, and no circles in it. Then doc/architecture.py: rooms use the fronts of those
# below them, modules are named after their paths, and the page has every room.
# The last line is `N passed, N failed`; a check is one tool over one folder.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/test/checks.sh"
install_lint && find_python || exit
cd "$root" || exit

for folder in app python validation bench test tools doc examples; do
  check "ruff: $folder" "$venv/bin/ruff" check --quiet --no-cache --output-format concise "$folder"
done
# One after the other, as files in two folders have the same name.
# The package's folders go together.
check 'mypy: python' "$venv/bin/mypy" --no-error-summary --cache-dir "$run_dir/mypy" python/gearsweep
check 'mypy: python/tests' "$venv/bin/mypy" --no-error-summary --cache-dir "$run_dir/mypy" python/tests/*.py python/tests/*/*.py
for folder in app python/tools validation bench tools/mutation test/cases/panel tools/reference doc doc/site; do
  check "mypy: $folder" "$venv/bin/mypy" --no-error-summary --cache-dir "$run_dir/mypy" "$folder"/*.py
done
for folder in src app test examples; do
  check "fortitude: $folder" "$venv/bin/fortitude" check --quiet --output-format concise "$folder"
done
# Rooms below study speak of quantities; src/study/case/key_names.f90 has their keys.
for room in base gear elastic mesh face motion rating; do
  check "no message of src/$room names a key" sh -c "! grep -rn \"'&\" src/$room"
done
check 'no word stands anywhere that the table of CONTRIBUTING.md has in bold' "$python" test/cases/words.py
printf 'A lower rung. A root run of one member yields.\n' >"$work/words.md"
check 'the check of words finds them' sh -c \
  "! '$python' test/cases/words.py '$work/words.md' >'$work/found' && [ \$(grep -c 'words.md:1: .*: say ' '$work/found') = 4 ]"
check 'mutants that are chosen when a program starts do as those compiled one at a time' "$python" tools/mutation/test_instrument.py
check 'rooms: each uses the fronts of those below it only, module = path, at most 800 lines' "$python" doc/architecture.py --rooms
check 'Python: no circles of imports, and each room imports those below it only' "$python" test/cases/imports.py
mkdir -p "$work/pair/core" "$work/pair/plots" && : >"$work/pair/__init__.py" && printf 'from . import b\n' >"$work/pair/core/a.py" &&
  printf 'def late():\n    from ..plots import c\n' >"$work/pair/core/b.py" && printf 'from ..core import a\n' >"$work/pair/plots/c.py"
check 'the check of imports finds a circle and an import of a higher room' sh -c \
  "! '$python' test/cases/imports.py '$work/pair' >'$work/found' && grep -q 'plots is above core' '$work/found' && grep -q 'core.a -> core.b -> plots.c -> core.a' '$work/found'"
check 'doc/develop/architecture.md has every room, and each file says what it is for' "$python" doc/architecture.py --stale
check 'links between the pages lead somewhere' "$python" doc/site/stage.py "$work/pages"
check 'one version stands everywhere, with one date' "$python" app/version.py
# In a copy of the files that have it: a bump renames what is unreleased, and begins a part above what is released.
bump() {
  for file in fpm.toml src/base/version.f90 CITATION.cff CHANGELOG.md README.md doc/linking.md validation/claims.csv app/version.py; do
    mkdir -p "$work/bump/$(dirname "$file")" && cp "$file" "$work/bump/$file" || return
  done
  cd "$work/bump" || return
  headings() { sed -n 's/^## //p' CHANGELOG.md | head -n "$1" | tr '\n' ';'; }
  "$python" app/version.py 8.1.0 && [ "$(headings 1)" = '8.1.0 - unreleased;' ] || return
  before=$(grep -c '^## ' CHANGELOG.md)
  "$python" app/version.py 8.1.0 2030-12-31 &&
    [ "$(headings 1)" = '8.1.0 - 2030-12-31;' ] && [ "$(grep -c '^## ' CHANGELOG.md)" = "$before" ] && "$python" app/version.py 8.2.0 &&
    [ "$(headings 2)" = '8.2.0 - unreleased;8.1.0 - 2030-12-31;' ] && grep -qx 'date-released: 2030-12-31' CITATION.cff &&
    grep -q '(gearsweep 8.2 REQUIRED)' doc/linking.md && grep -qx 'gearsweep 8.2.0' README.md || return
  sed -i 's/8\.2\.0/8.2.1/' CITATION.cff && ! "$python" app/version.py && ! "$python" app/version.py 8
}
check 'a new version is set everywhere, and a wrong one is found' bump
cd "$root" || exit
finish
