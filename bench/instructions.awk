# Finds the loop of a flat kernel in a disassembly. Variables: function_name, a
# part of its demangled name; planes of the shape and lanes of a vector, from
# which the compares of a loop tell how many objects it tests; loop, a file for
# its code as assembly. Prints the instructions for 64 objects, and how often the
# loop runs for them.

/>:$/ { inside = index($0, function_name) != 0 }

inside && /^ *[0-9a-f]+:\t/ {
  split($0, parts, "\t")
  address = parts[1]
  gsub(/[ :]/, "", address)
  text = parts[2]
  sub(/ *#.*/, "", text)
  sub(/ *<.*/, "", text)
  ++count
  place[function_number() "/" address] = count
  code[count] = text
  owner[count] = functions
}

/>:$/ && inside { ++functions }

function function_number() { return functions }

function compares(from, to,    i, sum) {
  for (i = from; i <= to; ++i) if (code[i] ~ /^v?cmp[a-z_]*ps /) ++sum
  return sum
}

END {
  # Every backward jump is a loop. Of those that test whole words or a quarter
  # or half of one, the shortest with the most objects.
  for (i = 1; i <= count; ++i) {
    if (code[i] !~ /^j/) continue
    split(code[i], words, " +")
    start = place[owner[i] "/" words[2]]
    if (start == 0 || start > i) continue
    ++loops
    first[loops] = start
    last[loops] = i
    objects = compares(start, i) * lanes / planes
    if (objects != 16 && objects != 32 && objects != 64) continue
    if (objects > best || (objects == best && i - start < last[chosen] - first[chosen])) {
      best = objects
      chosen = loops
    }
  }
  if (!chosen) { print "- 0"; exit }
  length_of = last[chosen] - first[chosen] + 1
  times = 64 / best
  instructions = length_of * times
  if (times > 1) {
    # The loop over words around it.
    around = 0
    for (l = 1; l <= loops; ++l) {
      if (first[l] < first[chosen] && last[l] > last[chosen] &&
          (!around || last[l] - first[l] < last[around] - first[around]))
        around = l
    }
    if (around)
      instructions += last[around] - first[around] + 1 - length_of
  }
  print ".Lloop:" > loop
  for (i = first[chosen]; i < last[chosen]; ++i) print code[i] > loop
  split(code[last[chosen]], words, " +")
  print words[1] " .Lloop" > loop
  print instructions, times
}
