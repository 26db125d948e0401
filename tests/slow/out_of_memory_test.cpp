// With less memory than it takes, whatever the limit: one line, exit status 75, no file left; never an abort.
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

TEST_F(OutOfMemory, AnyLimitIsOneLineAndAStatusThatSaysTryAgain) {
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
      EXPECT_EQ(result.status, 75) << arguments << " with " << kilobytes << " kB: " << result.err;
      EXPECT_TRUE(result.one_line_error()) << arguments << " with " << kilobytes << " kB: " << result.err;
      EXPECT_LE(files(), before) << arguments << " with " << kilobytes << " kB";
    }
    std::filesystem::remove(path("a.exr"));
  }
}

TEST_F(OutOfMemory, NoPictureIsLeftOutForIt) {
  // 8000 x 8000 black texels of a TGA, which take more than all else.
  write("large.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\x40\x1f\x40\x1f\x18\0", 18));
  std::filesystem::resize_file(path("large.tga"), 18 + 3 * 8000 * 8000);
  write("quad.mtl", "newmtl wall\nmap_Kd large.tga\n");
  write("quad.obj", "mtllib quad.mtl\nusemtl wall\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  int failed = 0;
  for (const size_t kilobytes : {400'000, 450'000, 500'000, 600'000, 4'000'000}) {
    const CliResult result =
        run("render quad.obj -o a.exr --size 16x16 --spp 1 --integrator qmc --shading flat", limit(kilobytes));
    if (result.status != 0) ++failed;
    EXPECT_EQ(result.err.find("left out"), std::string::npos) << kilobytes << " kB: " << result.err;
  }
  EXPECT_GE(failed, 1);
  EXPECT_LE(failed, 4);
}

}  // namespace
}  // namespace kairos
