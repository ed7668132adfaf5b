#!/bin/sh
# test.sh PACKAGE DATA WORK: packs the package, installs it in an empty folder, and tests it
# there, in node and, if it is installed, in Chromium. DATA has stored BVHs.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
package=$1 data=$2 work=$3
rm -rf "$work"
mkdir -p "$work"
cd "$work"
npm pack --silent --pack-destination "$work" "$package"
echo '{"private": true}' >package.json
npm install --silent --offline --no-audit --no-fund ./halfspace-*.tgz
cp "$here"/*.mjs .
# The example of the README, as it stands.
sed -n '/^```js$/,/^```$/{/^```/d;p}' "$package/README.md" >example.mjs
HALFSPACE_TEST_DATA=$data node --test test.mjs
