// What the builders report about shapes that could not be bounded.
#ifndef HALFSPACE_FIT_STATUS_H_
#define HALFSPACE_FIT_STATUS_H_

#include <cstddef>

namespace halfspace {

// Counts the results, and those that could not be bounded, of all calls that it
// is passed to. A call for one bound counts one result, a call for many counts
// each.
struct FitStatus {
  std::size_t results = 0;           // counted so far
  std::size_t everything = 0;        // how many of them became Everything()
  std::size_t first_everything = 0;  // the first such result, counted from 0;
                                     // meaningful if everything > 0
};

}  // namespace halfspace

#endif  // HALFSPACE_FIT_STATUS_H_
