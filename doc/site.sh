#!/bin/sh
# Makes the documentation as pages for a browser, with a search that needs no server: sh doc/site.sh
# They lie in build/site; open build/site/index.html.
root=$(CDPATH= cd -- "$(dirname -- "$0")/.." && pwd) || exit
. "$root/app/setup.sh"
cd "$root" && install_site || exit 125
rm -rf build/reference build/site
quietly "reading the sources, about 30 s" "$venv/bin/python" -m ford --quiet doc/site/ford.md &&
  "$venv/bin/python" doc/site/stage.py build/site-pages build/reference &&
  quietly "making the pages, about 20 s" "$venv/bin/python" -m mkdocs build --quiet --strict -f doc/site/mkdocs.yml || exit
say "open $root/build/site/index.html"
