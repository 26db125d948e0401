// With less memory than it takes, whatever the limit: one line, exit status 1, no file left; never an abort.
#include <random>

#include "cli.h"
#include "seed.h"

namespace kairos {
namespace {

class OutOfMemory : public CliTest {
 protected:
  OutOfMemory() {
    std::string nodes;
    for (int i = 0; i < 50000; ++i) nodes += R"(,{"name":"x","translation":[0,0,0]})";
    write("nodes.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}], "nodes": [{"mesh": 0})" +
                            nodes + "]}");
  }

  /// The least address space in kilobytes, to within 1 %, with which it succeeds.
  size_t enough_for(const std::string& arguments) {
    size_t low = 1 << 12, high = 1 << 22;
    while (high - low > high / 100) {
      const size_t middle = (low + high) / 2;
      (run(arguments, limit(middle)).status == 0 ? high : low) = middle;
    }
    return high;
  }
  static std::string limit(size_t kilobytes) { return "ulimit -v " + std::to_string(kilobytes) + "; "; }
};

TEST_F(OutOfMemory, AnyLimitIsOneLineAndStatusOne) {
  std::mt19937 random(test::seed());
  for (const std::string arguments :
       {"info nodes.gltf", "render scene.json -o a.exr --size 200x200 --spp 4 --quiet --threads 2",
        "render scene.json -o a.exr --size 64x64 --integrator qmc --spp 4 --quiet"}) {
    const size_t starts = enough_for("--version"), enough = enough_for(arguments);
    ASSERT_LT(starts, enough);
    for (int i = 0; i < 40; ++i) {
      const size_t kilobytes = starts + random() % (enough - starts);
      const size_t before = files();
      const CliResult result = run(arguments, limit(kilobytes));
      if (result.status == 0) continue;  // what is enough differs from run to run
      EXPECT_EQ(result.status, 1) << arguments << " with " << kilobytes << " kB: " << result.err;
      EXPECT_TRUE(result.one_line_error()) << arguments << " with " << kilobytes << " kB: " << result.err;
      EXPECT_LE(files(), before) << arguments << " with " << kilobytes << " kB";
    }
    std::filesystem::remove(path("a.exr"));
  }
}

}  // namespace
}  // namespace kairos
