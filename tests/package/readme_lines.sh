#!/usr/bin/env bash
# readme_lines.sh LANGUAGE SOURCES: prints the lines of the README for an empty Debian.
# LANGUAGE is c++ or python. Fails unless the lines are among the first 40 of the README
# and begin with a line of apt, which may name only packages of scripts/packages.sh.
set -euo pipefail
language=$1
root=$2

# The two groups of indented lines after the sentence about the empty Debian.
group=1
if [ "$language" = python ]; then group=2; fi
lines=$(head -n 40 "$root/README.md" | awk -v wanted="$group" '
  /^In an empty Debian 12/ { found = 1; next }
  !found { next }
  /^    / { if (!inside) ++group; inside = 1; if (group == wanted) print substr($0, 5) }
  !/^    / { inside = 0 }
  /^[^ ]/ { exit }')

first=${lines%%$'\n'*}
if [[ ! $first =~ ^apt\ .*install\ -y\ (.*)$ ]]; then
  echo "The lines for $language in the first 40 lines of README.md do not begin with" \
    "\"apt install -y\": $first" >&2
  exit 1
fi
# shellcheck source=../../scripts/packages.sh
source "$root/scripts/packages.sh"
for package in ${BASH_REMATCH[1]}; do
  # shellcheck disable=SC2154  # they are in packages.sh
  if ! printf '%s\n' "${build_packages[@]}" "${python_packages[@]}" |
    grep -qxF -e "$package"; then
    echo "README.md names the package $package, and scripts/packages.sh does not" >&2
    exit 1
  fi
done
printf '%s\n' "$lines"
