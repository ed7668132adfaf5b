// What the builders are compiled for.
#ifndef HALFSPACE_DISPATCH_FIT_INSTANTIATE_H_
#define HALFSPACE_DISPATCH_FIT_INSTANTIATE_H_

#define HALFSPACE_FOR_ALL_DIMS(macro) \
  macro(2);                           \
  macro(3);                           \
  macro(4)
#define HALFSPACE_FOR_ALL_SHAPES(macro) \
  macro(2, float);                      \
  macro(3, float);                      \
  macro(4, float);                      \
  macro(2, double);                     \
  macro(3, double);                     \
  macro(4, double)

#endif  // HALFSPACE_DISPATCH_FIT_INSTANTIATE_H_
