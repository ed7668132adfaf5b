// Bounds of bounds, against exact arithmetic.
#include <gtest/gtest.h>

#include "halfspace/bounds.h"
#include "tests/fuzz/bytes.h"
#include "tests/fuzz/moved_vertices.h"
#include "tests/fuzz/other_transforms.h"
#include "tests/fuzz/plane_by_plane.h"
#include "tests/fuzz/run_input.h"
#include "tests/fuzz/transform_ops.h"

namespace halfspace::testing {
namespace {

template <typename... Lists>
struct Joined;
template <typename... Inputs>
struct Joined<::testing::Types<Inputs...>> {
  using type = ::testing::Types<Inputs...>;
};
template <typename... As, typename... Bs, typename... Lists>
struct Joined<::testing::Types<As...>, ::testing::Types<Bs...>, Lists...>
    : Joined<::testing::Types<As..., Bs...>, Lists...> {};

template <typename Bound>
using InputsOf = ::testing::Types<
    MergeInput<Bound>, PlaneByPlane<InflateOp, Bound>,
    PlaneByPlane<InflateByBoxOp, Bound>, PlaneByPlane<TranslateOp, Bound>,
    PlaneByPlane<SweepOp, Bound>, PlaneByPlane<ScaleOp, Bound>>;

template <int kDims>
using Inputs = typename Joined<
    InputsOf<UpSimplex<kDims>>, InputsOf<DownSimplex<kDims>>,
    InputsOf<Aabb<kDims>>, InputsOf<Aabo<kDims>>,
    ::testing::Types<CircumscribeInput<UpSimplex<kDims>, DownSimplex<kDims>>,
                     CircumscribeInput<DownSimplex<kDims>, UpSimplex<kDims>>,
                     MovedVertices<Aabb<kDims>>,
                     MovedVertices<Aabo<kDims>>>>::type;

}  // namespace

void RunInput(Bytes& bytes) { RunOneOfAllDims<Inputs>(bytes); }

}  // namespace halfspace::testing
