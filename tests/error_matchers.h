// What an error must be: one line, of a code, with these words in it.
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <kairos/error.h>

namespace kairos {

template <class Body>
void expect_error(const Body& body, const std::vector<std::string>& words, ErrorCode code = ErrorCode::bad_input) {
  try {
    body();
    ADD_FAILURE() << "no error; expected one about " << (words.empty() ? "anything" : words[0]);
  } catch (const Error& error) {
    const std::string what = error.what();
    EXPECT_EQ(error.code(), code) << what;
    EXPECT_EQ(what.find('\n'), what.npos) << what;
    for (const std::string& word : words) EXPECT_NE(what.find(word), what.npos) << "'" << word << "' not in: " << what;
  }
}

}  // namespace kairos
