#!/bin/sh
# in_c_by_cc.sh CC PKG_CONFIG FOLDER: builds the program in C by the lines of the README,
# for a static or a shared library, and runs it. FOLDER has the .pc file.
set -eu
source=$(dirname "$0")/in_c.c
export PKG_CONFIG_PATH="$3"
# shellcheck disable=SC2046
"$1" -o in_c_by_cc "$source" $("$2" --cflags --libs halfspace) \
  -Wl,-rpath,"$("$2" --variable=libdir halfspace)"
./in_c_by_cc
