// Checksums and hashes that other programs compute, too.
#include <vector>

#include <gtest/gtest.h>

#include "time_io/crc32c.h"
#include "time_io/murmur_hash.h"

namespace kairos {
namespace {

// The specification's examples.
TEST(Cryptomatte, HashesNames) {
  EXPECT_EQ(murmur3_32("torus"), 4053562365u);
  EXPECT_EQ(murmur3_32("равнина"), 2518896926u);
  EXPECT_EQ(cryptomatte_id("torus"), -1.54943624832e+30f);
  EXPECT_EQ(cryptomatte_id("равнина"), -1.31926312124e-25f);
}

// RFC 3720, appendix B.4.
TEST(Crc32c, IsTheStandardsOwn) {
  const std::vector<uint8_t> zeros(32, 0), ones(32, 0xff);
  std::vector<uint8_t> ascending(32);
  for (size_t i = 0; i < ascending.size(); ++i) ascending[i] = static_cast<uint8_t>(i);
  for (uint32_t (*const sum)(const void*, size_t, uint32_t) : {&crc32c, &crc32c_of_tables}) {
    EXPECT_EQ(sum(zeros.data(), 32, 0), 0x8a9136aau);
    EXPECT_EQ(sum(ones.data(), 32, 0), 0x62a8ab43u);
    EXPECT_EQ(sum(ascending.data(), 32, 0), 0x46dd794eu);
    EXPECT_EQ(sum("123456789", 9, 0), 0xe3069283u);
    EXPECT_EQ(sum(ascending.data() + 13, 19, sum(ascending.data(), 13, 0)), 0x46dd794eu);
  }
}

}  // namespace
}  // namespace kairos
