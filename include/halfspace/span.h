// Where an array of the caller's begins, and how many elements it has: what the
// calls take lists and outputs as.
//
// It is C++20's std::span with a length known at run time, for callers in C++17
// too; the calls are the same functions for both. Whatever has its elements one
// after another becomes a Span by itself: C arrays, std::array, std::vector,
// another Span, std::span, any class with data() and size() alike. Or name the
// pointer and the count: {pointer, count}.
//   Span<const T>  reads; takes const lists, and temporaries too
//   Span<T>        is written; takes what is not const
// A Span becomes a std::span wherever one is expected.
//
// It owns nothing: the elements must outlive it. An index is not checked.
//
// Thread safety: a value; none needed.
#ifndef HALFSPACE_SPAN_H_
#define HALFSPACE_SPAN_H_

#include <cstddef>
#include <iterator>
#include <type_traits>
#include <utility>

#if __has_include(<version>)
#include <version>
#endif
#if defined(__cpp_lib_span)
#include <span>
#endif

namespace halfspace {

namespace detail {

// A type only if List has pointers to T, or to T without const, at its data();
// a class derived from T may be of another size.
template <typename T, typename List>
using IfListOf = std::enable_if_t<
    std::is_convertible_v<
        std::remove_pointer_t<decltype(std::data(std::declval<List&>()))> (*)[],
        T (*)[]>,
    decltype(std::size(std::declval<List&>()))>;

}  // namespace detail

template <typename T>
class Span {
 public:
  using element_type = T;
  using value_type = std::remove_cv_t<T>;

  constexpr Span() noexcept = default;
  constexpr Span(T* data, std::size_t size) noexcept
      : data_(data), size_(size) {}

  // Of what is const, and of a temporary, std::data() is const too, unless it
  // points to somebody else's elements.
  template <typename List, typename = detail::IfListOf<T, List>>
  // NOLINTNEXTLINE(google-explicit-constructor): lists become spans, as said.
  constexpr Span(List& list) noexcept
      : data_(std::data(list)),
        size_(static_cast<std::size_t>(std::size(list))) {}
  template <typename List, typename = detail::IfListOf<T, const List>>
  // NOLINTNEXTLINE(google-explicit-constructor): as above.
  constexpr Span(const List& list) noexcept
      : data_(std::data(list)),
        size_(static_cast<std::size_t>(std::size(list))) {}

  constexpr T* data() const noexcept { return data_; }
  constexpr std::size_t size() const noexcept { return size_; }
  constexpr bool empty() const noexcept { return size_ == 0; }
  constexpr T* begin() const noexcept { return data_; }
  constexpr T* end() const noexcept { return data_ + size_; }
  constexpr T& operator[](std::size_t i) const { return data_[i]; }
  constexpr T& front() const { return data_[0]; }
  constexpr T& back() const { return data_[size_ - 1]; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace halfspace

#if defined(__cpp_lib_span)
// The elements outlive it, so that a temporary may become a std::span.
template <typename T>
inline constexpr bool std::ranges::enable_borrowed_range<halfspace::Span<T>> =
    true;
template <typename T>
inline constexpr bool std::ranges::enable_view<halfspace::Span<T>> = true;
#endif

#endif  // HALFSPACE_SPAN_H_
