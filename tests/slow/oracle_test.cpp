// The tracer against exact answers: what rays meet and see, and when, in rational arithmetic.
#include "oracle.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <kairos/tracer.h>

#include "temp_folder.h"

namespace kairos {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// The `v` and `f` lines of an OBJ file whose faces are triangles.
void read_key(const fs::path& path, Mesh& mesh) {
  std::ifstream file(path);
  mesh.positions.emplace_back();
  mesh.triangles.clear();
  std::string word;
  while (file >> word) {
    if (word == "v") {
      Vec3f p;
      file >> p.x >> p.y >> p.z;
      mesh.positions.back().push_back(p);
    } else if (word == "f") {
      Triangle triangle;
      file >> triangle[0] >> triangle[1] >> triangle[2];
      for (uint32_t& v : triangle) --v;
      mesh.triangles.push_back(triangle);
    }
  }
}

struct Family {
  std::string name;
  Mesh mesh;
  std::vector<Ray> rays;
  std::vector<Json> answers;  // [ray]
};

Family read_family(const fs::path& folder) {
  Family family;
  family.name = folder.filename();
  family.mesh.name = family.name;
  family.mesh.key_times = {0, 1};
  read_key(folder / "open.obj", family.mesh);
  read_key(folder / "close.obj", family.mesh);
  std::ifstream rays(folder / "rays.txt");
  for (Ray r; rays >> r.origin.x >> r.origin.y >> r.origin.z >> r.direction.x >> r.direction.y >> r.direction.z;)
    family.rays.push_back(r);
  std::ifstream answers(folder / "hits.jsonl");
  for (std::string line; std::getline(answers, line);) family.answers.push_back(Json::parse(line));
  return family;
}

/// Bounds on what may differ from the exact answer.
struct Bounds {
  double time, dist;  ///< of the shutter; relative
};
constexpr Bounds kExact{1e-4, 1e-3};
// Floats resolve a soup of extent 10 to 1e-6; the roots of a quadratic with a discriminant of that relative size are
// off by its root.
constexpr Bounds kFast{1e-3, 1e-2};

bool agrees(const Segment& segment, const Json& hit, const Bounds& bounds) {
  const auto dist_near = [&](double dist, double truth) { return std::abs(dist - truth) <= bounds.dist * truth; };
  return segment.triangle == hit["prim"] && segment.front == hit["front"] &&
         std::abs(segment.begin - hit["begin"].get<double>()) <= bounds.time &&
         std::abs(segment.end - hit["end"].get<double>()) <= bounds.time &&
         dist_near(segment.dist_begin, hit["dist_begin"]) && dist_near(segment.dist_end, hit["dist_end"]);
}

std::string text_of(std::span<const Segment> segments) {
  std::ostringstream out;
  out.precision(9);
  for (const Segment& s : segments)
    out << "  prim " << s.triangle << " [" << s.begin << ", " << s.end << ") dist " << s.dist_begin << " to "
        << s.dist_end << (s.front ? " front\n" : " back\n");
  return out.str();
}

/// Whether everything that a ray meets is as it should be.
::testing::AssertionResult same_hits(std::span<const Segment> segments, const Json& hits, const Bounds& bounds) {
  std::vector<Segment> sorted(segments.begin(), segments.end());
  std::sort(sorted.begin(), sorted.end(), [](const Segment& a, const Segment& b) {
    return std::pair(a.triangle, a.begin) < std::pair(b.triangle, b.begin);
  });
  bool same = sorted.size() == hits.size();
  for (size_t i = 0; same && i < sorted.size(); ++i) same = agrees(sorted[i], hits[i], bounds);
  if (same) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "\n" << text_of(sorted) << " but exactly:\n" << hits.dump(1);
}

int64_t triangle_at(std::span<const Segment> segments, double time) {
  for (const Segment& s : segments)
    if (s.begin <= time && time < s.end) return s.triangle;
  return -1;
}

/// Adds the rays that have a well-conditioned answer, and were compared with it, to `checked`.
void check_family(const Family& family, const TracerOptions& options, const Bounds& bounds, size_t& checked) {
  SCOPED_TRACE(family.name + " " + std::string(to_string(*options.instruction_set)));
  ASSERT_FALSE(family.rays.empty());
  ASSERT_EQ(family.rays.size(), family.answers.size());
  const std::vector<Mesh> meshes{family.mesh};
  const Tracer tracer(meshes, options);
  Tracer::Workspace workspace;
  size_t instants = 0, right = 0;
  for (size_t r = 0; r < family.rays.size(); ++r) {
    const Json& answer = family.answers[r];
    if (answer["ill"].get<bool>()) continue;
    ++checked;
    EXPECT_TRUE(same_hits(tracer.trace(family.rays[r], Visibility::all, workspace), answer["hits"], bounds))
        << "ray " << r;
    const auto visible = tracer.trace(family.rays[r], Visibility::visible, workspace);
    for (size_t k = 0; k < 256; ++k) {
      ++instants;
      right += triangle_at(visible, (2 * static_cast<double>(k) + 1) / 512) == answer["visible"][k];
    }
  }
  EXPECT_GE(static_cast<double>(right), 0.995 * static_cast<double>(instants));
}

/// Every family below `folder`, with every instruction set and both precisions.
void check_folder(const fs::path& folder) {
  size_t families = 0, rays = 0, checked = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const Family family = read_family(entry.path());
    ++families;
    for (InstructionSet set : supported_instruction_sets()) {
      rays += 2 * family.rays.size();
      check_family(family, {Precision::exact, set}, kExact, checked);
      check_family(family, {Precision::fast, set}, kFast, checked);
    }
  }
  EXPECT_EQ(families, 8u);
  EXPECT_GT(checked, rays / 2);
}

TEST(Oracle, HitsAndWhatIsVisible) {
  const TempFolder folder;
  const uint32_t first = test::seed();
  for (uint32_t seed = first; seed < first + 3; ++seed) {
    SCOPED_TRACE(seed);
    const std::string answers = folder.path(std::to_string(seed));
    test::ask_oracle("moving_triangles.py", answers, seed, "--triangles 30 --rays 30");
    check_folder(answers);
  }
}

}  // namespace
}  // namespace kairos
