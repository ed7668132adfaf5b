#!/bin/sh
# usage: man_page.sh PAGE COMMAND...
#
# The manual PAGE has the options that COMMAND --help lists, and no others; groff,
# where it is installed, has nothing to say of it. --help fits 80 columns, and does not
# repeat what each option excludes.
set -eu

page=$1
shift
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$@" --help >"$scratch/text"
if grep -E '.{81}|Excludes' "$scratch/text"; then
  echo "these lines of --help are too long, or repeat what an option excludes"
  exit 1
fi
grep -oE '^  [^ ]+' "$scratch/text" | grep -oE -e '--[a-z-]+' | sort -u >"$scratch/help"
# The line after .TP is the head of a paragraph.
sed 's/\\-/-/g' "$page" |
  awk 'is_head && /--/ { print } { is_head = /^[.]TP/ }' |
  grep -oE -e '--[a-z-]+' | sort -u >"$scratch/page"
if ! diff -u "$scratch/help" "$scratch/page"; then
  echo "options of --help, with -, and of $page, with +, differ"
  exit 1
fi
if ! [ -s "$scratch/help" ]; then
  echo "--help lists no options"
  exit 1
fi
if command -v groff >/dev/null; then
  groff -man -Tutf8 -ww "$page" 2>&1 >/dev/null | tee "$scratch/warnings"
  [ ! -s "$scratch/warnings" ]
fi
