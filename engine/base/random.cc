#include "engine/base/random.h"

#include <cmath>
#include <numbers>

#include "engine/base/contract.h"

namespace graspdb {
namespace {

uint64_t SplitMix(uint64_t& state) {
  uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

uint64_t RotateLeft(uint64_t x, int bits) {
  return (x << bits) | (x >> (64 - bits));
}

}  // namespace

uint64_t DeriveSeed(uint64_t seed, std::initializer_list<uint64_t> indices) {
  uint64_t state = seed;
  uint64_t result = SplitMix(state);
  for (const uint64_t index : indices) {
    state = result ^ (index * 0xd1342543de82ef95ULL + 1);
    result = SplitMix(state);
  }
  return result;
}

Random::Random(uint64_t seed) {
  for (uint64_t& word : state_) word = SplitMix(seed);
}

uint64_t Random::NextBits() {
  const uint64_t result = RotateLeft(state_[0] + state_[3], 23) + state_[0];
  const uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = RotateLeft(state_[3], 45);
  return result;
}

double Random::NextUniform() {
  return static_cast<double>(NextBits() >> 11) * 0x1.0p-53;
}

double Random::NextUniform(double low, double high) {
  return low + (high - low) * NextUniform();
}

int Random::NextIndex(int count) {
  GRASPDB_EXPECTS(count > 0);
  return static_cast<int>(NextUniform() * count);
}

double Random::NextNormal() {
  // Box and Muller; 1 - u keeps the logarithm finite.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - NextUniform()));
  return radius * std::cos(2.0 * std::numbers::pi * NextUniform());
}

Eigen::Vector3d Random::NextUnitVector() {
  const double z = NextUniform(-1.0, 1.0);
  const double phi = NextUniform(0.0, 2.0 * std::numbers::pi);
  const double radius = std::sqrt(1.0 - z * z);
  return {radius * std::cos(phi), radius * std::sin(phi), z};
}

Eigen::Vector3d Random::NextInUnitBall() {
  return NextUnitVector() * std::cbrt(NextUniform());
}

Eigen::Matrix3d Random::NextRotation() {
  // Shoemake 1992.
  const double u = NextUniform();
  const double a = NextUniform(0.0, 2.0 * std::numbers::pi);
  const double b = NextUniform(0.0, 2.0 * std::numbers::pi);
  const double s = std::sqrt(1.0 - u);
  const double t = std::sqrt(u);
  return Eigen::Quaterniond(t * std::cos(b), s * std::sin(a), s * std::cos(a),
                            t * std::sin(b))
      .toRotationMatrix();
}

Eigen::Matrix3d Random::NextRotationWithin(double max_angle) {
  const Eigen::Vector3d axis = NextUnitVector();
  return Eigen::AngleAxisd(NextUniform(0.0, max_angle), axis)
      .toRotationMatrix();
}

}  // namespace graspdb
