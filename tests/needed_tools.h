// What tests use that is no part of Kairos: a tool, a folder of models.
#pragma once

#include <cstdlib>

#include <gtest/gtest.h>

/// Ends a test unless `is_there`: as skipped, or as failed where KAIROS_NEED_TOOLS says that everything has been
/// installed, as ./check does.
#define KAIROS_NEEDS(is_there, what)                                               \
  if (!(is_there)) {                                                               \
    ASSERT_EQ(std::getenv("KAIROS_NEED_TOOLS"), nullptr) << what << " is missing"; \
    GTEST_SKIP() << what << " is missing";                                         \
  }
