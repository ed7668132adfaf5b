#!/usr/bin/env bash
# Checks what cpuinfo-bench has written with another program; exits with 77 where
# that is not installed:
#   page_test.sh browser PAGE.html         no error in headless Chromium
#   page_test.sh tidy PAGE.html            valid HTML
#   page_test.sh schema RUN.json... SCHEMA as its schema says
set -euo pipefail

case $1 in
  browser)
    command -v chromium >/dev/null || exit 77
    profile=$(mktemp -d)
    trap 'rm -rf "$profile"' EXIT
    timeout 120 chromium --headless --no-sandbox --disable-gpu \
      --user-data-dir="$profile" --enable-logging=stderr --dump-dom \
      "file://$(realpath "$2")" >"$profile/dom" 2>"$profile/log"
    if grep CONSOLE "$profile/log"; then exit 1; fi
    # All of it has arrived.
    grep '<h2>All numbers</h2>' "$profile/dom"
    ;;
  tidy)
    command -v tidy >/dev/null || exit 77
    tidy -quiet -errors "$2"
    ;;
  schema)
    python=/usr/bin/python3 # that of the distribution's packages
    $python -c 'import jsonschema' 2>/dev/null || exit 77
    $python - "${@:2}" <<'PYTHON'
import json
import sys

import jsonschema

*runs, schema = (json.load(open(name, encoding="utf-8")) for name in sys.argv[1:])
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)
errors = [error for run in runs for error in validator.iter_errors(run)]
for error in errors:
    print("/".join(map(str, error.absolute_path)) + ":", error.message[:200])
sys.exit(bool(errors))
PYTHON
    ;;
esac
