// The rows of flat_cases.h, for every kind of world.
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <vector>

#include "tests/library/support/flat_cases.h"

namespace halfspace::testing {
namespace {

template <typename Case>
FlatCase RowOf() {
  using Stored = typename Case::Stored;
  using Scalar = ScalarOf<Stored>;
  return {NameOf(Case()),
          detail::kLayoutOf<typename Stored::Bound>,
          detail::kLayoutOf<typename Case::View::Bound>,
          std::is_same_v<Scalar, double>,
          [](const PlanePointers& planes, std::size_t size) {
            Stored stored;
            for (std::size_t p = 0; p < kPlanes<Stored>; ++p) {
              PlaneOf(stored, p) = static_cast<const Scalar*>(planes[p]);
            }
            stored.size = size;
            return AnyWorld(Case::Seen(stored));
          },
          [](const void* stored, void* seen) {
            const auto query =
                Case::Seen(*static_cast<const typename Stored::Query*>(stored));
            std::memcpy(seen, &query, sizeof(query));
          }};
}

template <typename... Cases>
std::vector<FlatCase> RowsOf(const ::testing::Types<Cases...>&) {
  return {RowOf<Cases>()...};
}

}  // namespace

std::vector<FlatCase> AllFlatRows() { return RowsOf(AllCases()); }

}  // namespace halfspace::testing
