# Reads `objdump -d -C --no-show-raw-insn`; see scan_baseline.sh.

BEGIN {
  # tzcnt is missing on purpose: compilers write it for bsf, as which it runs on
  # a machine that does not know it.
  above = "^(v[a-z]" \
    "|addsub|hadd|hsub|lddqu|mov(d|sh|sl)dup" \
    "|pabs|palignr|phadd|phsub|pmaddubs|pmulhrs|pshufb|psign" \
    "|blend|pblend|dpp[sd]|extractps|insertps|movntdqa|mpsadbw|packusdw" \
    "|pcmp(eqq|gtq|[ei]str)|pextr[bdq]|pinsr[bdq]|phminpos" \
    "|pmaxs[bd]|pmaxu[dw]|pmins[bd]|pminu[dw]|pmov[sz]x|pmuldq|pmulld|ptest" \
    "|round[ps][sd]|crc32|popcnt|lzcnt|movbe|aes|pclmul|sha1|sha256|gf2p8" \
    "|andn[lq]?$|bextr|bls(i|r|msk)|bzhi|mulx|pdep|pext|rorx|sarx|shlx|shrx" \
    "|k(mov|ortest|test|and|or|xor|xnor|not|shift|unpck|add))"
  # Legacy names the patterns above would catch.
  baseline = "^(pextrw|pinsrw)"
}

/^[0-9a-f]+ <.*>:$/ {
  name = $0
  sub(/^[0-9a-f]+ </, "", name)
  sub(/>:$/, "", name)
  per_target = name ~ /(^|[^A-Za-z0-9_])N_[A-Z0-9_]+::/
  ++functions[per_target]
  next
}

# GNU's objdump, and LLVM's.
/^ *[0-9a-f]+:[ \t]/ {
  ++instructions[per_target]
  if (per_target && !everything) next
  instruction = $0
  sub(/^ *[0-9a-f]+:[ \t]+/, "", instruction)
  sub(/^((lock|rep|repz|repnz|bnd|notrack|data16|cs|ds|es) )+/, "", instruction)
  mnemonic = instruction
  sub(/[ \t].*/, "", mnemonic)
  if ((mnemonic ~ above && mnemonic !~ baseline) ||
      instruction ~ /%([yz]mm|k[0-7])/) {
    if (!(name in first)) {
      first[name] = instruction
      ++bad
    }
  }
}

END {
  for (name in first)
    print name ": \"" first[name] "\" is above the baseline"
  if (bad) {
    print bad " functions; move them into the per-target namespace, or keep " \
          "them out of the per-target passes"
    exit 1
  }
  if (!instructions[0] || !instructions[1]) {
    print "found " instructions[0] + 0 " common and " instructions[1] + 0 \
          " per-target instructions: this is not the library"
    exit 1
  }
  print functions[0] " functions (" instructions[0] " instructions) outside " \
        "per-target code stay at the baseline"
}
