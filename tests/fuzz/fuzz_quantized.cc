// Histories of owning worlds, of quantized bounds and of quantized worlds:
// quantized bounds alone keep what the floats keep, and refined they give the
// answer of the oracle.
#include <vector>

#include "tests/fuzz/fuzz.h"
#include "tests/library/world/owner_inputs.h"

namespace halfspace::testing {

void Fuzz(Random& random) {
  static const std::vector<OwnerRow> rows = OwnerRows();
  const OwnerRow& row = OneOf(rows, random);
  OwnerInputs(row, random).FollowModel(1 + random() % 12);
}

}  // namespace halfspace::testing
