#!/bin/sh
# Makes the documentation as pages for a browser, with a search that needs no server: sh doc/site.sh
# They lie in build/site; open build/site/index.html.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
cd "$root" && build_package && install_site || exit 125
rm -rf build/reference build/site build/site-sources
cp -R src build/site-sources || exit
# FORD splits the length of a character at each comma, but in its older form.
find build/site-sources -name '*.f90' -exec sed -i -E 's/^( *)character\((.*merge\(.*)\) ::/\1character*(\2) ::/' {} + || exit
quietly "reading the sources, about 30 s" "$venv/bin/python" -m ford --quiet doc/site/ford.md &&
  quietly "running the tutorial, about 30 s" "$venv/bin/python" doc/notebook.py doc/from_a_drawing.md build/from_a_drawing.ipynb &&
  "$venv/bin/python" doc/site/stage.py build/site-pages build/from_a_drawing.ipynb build/reference &&
  quietly "making the pages, about 20 s" "$venv/bin/python" -m mkdocs build --quiet --strict -f doc/site/mkdocs.yml || exit
say "open $root/build/site/index.html"
