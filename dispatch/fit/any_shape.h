// From AnyShape (fit.h) to the type of the shape.
#ifndef HALFSPACE_DISPATCH_FIT_ANY_SHAPE_H_
#define HALFSPACE_DISPATCH_FIT_ANY_SHAPE_H_

#include <new>

#include "dispatch/fit/bounding.h"
#include "halfspace/fit.h"

namespace halfspace::dispatch {

// Returns function<kDims>().
template <typename Function>
auto WithDims(int dims, const Function& function) {
  switch (dims) {
    case 2:
      return function.template operator()<2>();
    case 3:
      return function.template operator()<3>();
    default:
      return function.template operator()<4>();
  }
}

// Calls function(shape), where `shape` is a Shape<kDims, Scalar>.
template <template <int, typename> class Shape, typename Function>
void WithShape(const detail::AnyShape& any, const Function& function) {
  WithDims(any.dims, [&]<int kDims>() {
    if (any.is_double) {
      function(*static_cast<const Shape<kDims, double>*>(any.shape));
    } else {
      function(*static_cast<const Shape<kDims, float>*>(any.shape));
    }
  });
}

// Sets the bound of a shape to what try_bound(shape) returns. try_bound() is
// called in the default mode, and may return nothing.
template <template <int, typename> class Shape, typename TryBound>
void BoundAny(const detail::AnyShape& any, FitStatus* status,
              const TryBound& try_bound) {
  WithShape<Shape>(
      any, [&]<int kDims, typename Scalar>(const Shape<kDims, Scalar>& shape) {
        new (any.bound)
            Aabo<kDims>(Build(status, [&] { return try_bound(shape); }));
      });
}

}  // namespace halfspace::dispatch

#endif  // HALFSPACE_DISPATCH_FIT_ANY_SHAPE_H_
