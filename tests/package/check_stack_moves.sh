#!/bin/sh
# usage: check_stack_moves.sh OBJDUMP BINARY
#
# Fails if a move of a vector of 256 or 512 bits needs aligned memory: gcc for Windows
# does not align the stack to such vectors (its bug 54412). Also fails if the binary moves
# no such vector to or from the stack, because then the check looks at the wrong code.
set -eu
"$1" -d --no-show-raw-insn "$2" | awk '
  !/\tvmov.*[yz]mm/ { next }
  /vmov(aps|apd|dqa)/ && /\(/ { if (++aligned <= 5) print }
  /\(%r[sb]p/ { ++on_stack }
  END {
    print on_stack + 0 " moves to or from the stack, " aligned + 0 " that need aligned memory"
    exit aligned > 0 || on_stack == 0
  }'
