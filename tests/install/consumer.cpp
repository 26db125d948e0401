// What is seen along a ray while a triangle flies through it, and from when to when. Also in docs/embedding.md.
#include <cstdio>

#include <kairos/tracer.h>

int main() {
  kairos::Mesh mesh;
  mesh.triangles = {{0, 1, 2}};
  mesh.key_times = {0, 1};
  mesh.positions = {{{-5, -1, 0}, {-3, -1, 0}, {-4, 1, 0}}, {{3, -1, 0}, {5, -1, 0}, {4, 1, 0}}};
  const kairos::Tracer tracer({&mesh, 1});
  kairos::Tracer::Workspace workspace;
  for (const kairos::Segment& seen : tracer.trace({{0, 0, 2}, {0, 0, -1}}, kairos::Visibility::visible, workspace))
    std::printf("triangle %u from %.4f to %.4f at distance %.2f\n", seen.triangle, seen.begin, seen.end,
                seen.dist_begin);
}
