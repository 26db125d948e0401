// The account of what a scene may grow into.
#include "base/memory_budget.h"

#include <limits>

#include <gtest/gtest.h>

#include "base/folder_lock.h"
#include "error_matchers.h"
#include "temp_folder.h"

namespace kairos {
namespace {

TEST(MemoryBudget, GrantsABaseAndMoreForEachByteOfFiles) {
  MemoryBudget budget(100);
  EXPECT_FALSE(budget.take(101));
  EXPECT_TRUE(budget.take(60));
  EXPECT_EQ(budget.left(), 40u);
  budget.add_file(2);
  EXPECT_EQ(budget.left(), 40 + 2 * MemoryBudget::kPerFileByte);
  budget.charge(budget.left(), "x");
  expect_error([&] { budget.charge(5'000'001, "scene.glb: nodes[3]"); },
               {"scene.glb: nodes[3]", "6 MB", "--memory-budget"});
  EXPECT_EQ(budget.left(), 0u);
}

TEST(MemoryBudget, DoesNotOverflow) {
  constexpr uint64_t kMost = std::numeric_limits<uint64_t>::max();
  MemoryBudget budget(kMost - 10);
  budget.add_file(kMost / 2);
  EXPECT_EQ(budget.left(), kMost);
  EXPECT_TRUE(budget.take(kMost));
}

TEST(FolderLock, OneAtATimeHoldsAFolder) {
  const TempFolder folder;
  {
    const FolderLock lock(folder.path(""));
    expect_error([&] { const FolderLock second(folder.path("")); }, {"in use"}, ErrorCode::io);
  }
  const FolderLock again(folder.path(""));
}

}  // namespace
}  // namespace kairos
