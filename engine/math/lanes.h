#pragma once

namespace graspdb {

/** Two, four or eight numbers side by side, for loops that do the same to each:
 a GCC and Clang extension. What is computed does not depend on how many there
 are. */
using Doubles2 [[gnu::vector_size(16)]] = double;
using Floats4 [[gnu::vector_size(16)]] = float;
using Ints4 [[gnu::vector_size(16)]] = int;
using Floats8 [[gnu::vector_size(32)]] = float;
using Ints8 [[gnu::vector_size(32)]] = int;

}  // namespace graspdb
