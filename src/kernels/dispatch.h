// One traversal, compiled for several instruction sets, chosen at run time.
#pragma once

#include <span>

#include <kairos/tracer.h>

#include "accel/layout.h"
#include "kernels/packet.h"
#include "kernels/ray_state.h"

namespace kairos {

/// Puts what a traceable ray meets into state.hits, between state.begin_ray and state.end_ray.
using CollectHits = void (*)(const Accel& accel, const Ray& ray, RayState& state);

/// The same for the rays of a packet; states: one per ray.
using CollectPacketHits = void (*)(const Accel& accel, const RayPacket& packet, std::span<RayState> states);

/// Children of a node that a ray meets.
struct alignas(64) NodeHits {
  float dist[kWidth];                ///< lower bound of the distance
  float begin[kWidth], end[kWidth];  ///< bounds of the time; moving nodes only
  uint32_t mask;                     ///< bit per child
};

/// Triangles of a block that a ray meets, at most once each: lanes in `hit`. Lanes in `rare` may be met more than once
/// and are not answered; lanes in `bent` have a distance that is far from linear in time.
template <class Real>
struct alignas(64) BlockHits {
  Real begin[kWidth], end[kWidth];  ///< the key span's own time
  Real dist_begin[kWidth], dist_end[kWidth];
  uint32_t hit, front, bent, rare;
  uint32_t solved;  ///< lanes whose roots were computed
};

/// What is compiled for an instruction set. The tests of single nodes and blocks are for tests and benchmarks; the
/// traversal has its own copies inlined.
struct Kernels {
  CollectHits collect_fast, collect_exact;
  CollectPacketHits collect_packet;  ///< null: rays are to be traced one by one
  void (*test_node)(const Node<kMovingKeys>& node, const Ray& ray, NodeHits& hits);
  void (*test_block)(const BlockKey& begin, const BlockKey& end, const Ray& ray, BlockHits<float>& hits);
};

/// Null where this machine cannot run the instruction set. The scalar kernels compute in double, whatever is asked for,
/// and have no tests of single nodes and blocks.
const Kernels* find_kernels(InstructionSet set);

void collect_hits_scalar(const Accel& accel, const Ray& ray, RayState& state);

}  // namespace kairos
