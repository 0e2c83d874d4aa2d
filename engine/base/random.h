#pragma once

#include <cstdint>
#include <initializer_list>

#include <Eigen/Geometry>

namespace graspdb {

/** Derives the seed of an independent stream from a seed and the stream's
 indices (part, grasp, round …), so that the order in which items are worked on
 changes nothing. (SplitMix64 finaliser, Steele et al. 2014.) */
uint64_t DeriveSeed(uint64_t seed, std::initializer_list<uint64_t> indices);

/** A deterministic random stream, the same on every platform: xoshiro256++
 (Blackman and Vigna 2021) with our own distributions, since those of the
 standard library differ between implementations. */
class Random {
 public:
  explicit Random(uint64_t seed);

  /** Uniform over all 64-bit values. */
  uint64_t NextBits();
  /** Uniform in [0, 1). */
  double NextUniform();
  /** Uniform in [low, high). */
  double NextUniform(double low, double high);
  /** Uniform in {0, …, count - 1}. @pre count > 0. */
  int NextIndex(int count);
  /** Standard normal. */
  double NextNormal();
  /** Uniform on the unit sphere. */
  Eigen::Vector3d NextUnitVector();
  /** Uniform in the unit ball. */
  Eigen::Vector3d NextInUnitBall();
  /** Uniform (Haar) over rotations. */
  Eigen::Matrix3d NextRotation();
  /** Rotation about a uniform axis by an angle uniform in [0, max_angle] rad.
   */
  Eigen::Matrix3d NextRotationWithin(double max_angle);

 private:
  uint64_t state_[4];
};

}  // namespace graspdb
