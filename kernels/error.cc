#include "kernels/error.h"

#include <stdexcept>
#include <string>

namespace halfspace::kernels {

void ThrowInvalid(std::string_view call, std::string_view argument,
                  std::string_view expected, std::string_view given) {
  std::string text = "halfspace: ";
  text.append(call).append(": ").append(argument);
  text.append(": expected ").append(expected);
  text.append(", got ").append(given);
  throw std::invalid_argument(text);
}

}  // namespace halfspace::kernels
