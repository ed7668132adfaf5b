// Output that is whole or not there.
#ifndef HALFSPACE_BENCH_BASE_WRITE_WHOLE_H_
#define HALFSPACE_BENCH_BASE_WRITE_WHOLE_H_

#include <ostream>
#include <sstream>

namespace halfspace::bench {

// What `write` writes into a stream, to `out`; nothing of it if it throws.
// Streams swallow std::bad_alloc and go on, unless they are told not to.
template <typename Write>
void WriteWhole(std::ostream& out, const Write& write) {
  std::ostringstream text;
  text.exceptions(std::ios::badbit);
  write(text);
  out << text.str() << std::flush;
}

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASE_WRITE_WHOLE_H_
