// JSON from files: the same values as the library's own parser gives, in linear time, and limits.
#include "scene_io/json_text.h"

#include <random>

#include <gtest/gtest.h>

#include "error_matchers.h"
#include "seed.h"

namespace kairos {
namespace {

using nlohmann::json;

json random_value(std::mt19937& random, int depth) {
  switch (random() % (depth > 0 ? 8 : 6)) {
    case 0:
      return nullptr;
    case 1:
      return random() % 2 == 0;
    case 2:
      return -static_cast<int>(random() % 1000);
    case 3:
      return random();
    case 4:
      return static_cast<double>(random()) / 7;
    case 5:
      return "text \"" + std::to_string(random()) + "\" \n ü";
    case 6: {
      json list = json::array();
      for (unsigned i = random() % 5; i > 0; --i) list.push_back(random_value(random, depth - 1));
      return list;
    }
    default: {
      json object = json::object();
      for (unsigned i = random() % 5; i > 0; --i)
        object[std::to_string(random() % 100)] = random_value(random, depth - 1);
      return object;
    }
  }
}

TEST(JsonText, SaysWhatTheLibrarysOwnParserSays) {
  std::mt19937 random(test::seed());
  for (int round = 0; round < 300; ++round) {
    const json value = random_value(random, 5);
    EXPECT_EQ(JsonText(value.dump(round % 3), "test").root(), value);
  }
}

TEST(JsonText, AMillionObjectsInAnArrayTakeNoLongerThanTheyAreLong) {
  std::string text = "[{}";
  for (int i = 1; i < 1000000; ++i) text += ",{}";
  EXPECT_EQ(JsonText(text + "]", "test").root().size(), 1000000u) << "in hours, were each to look through those before";
}

TEST(JsonText, NestsSixtyFourDeepAndNoDeeper) {
  EXPECT_EQ(JsonText(std::string(64, '[') + std::string(64, ']'), "test").root().size(), 1u);
  expect_error([] { JsonText(std::string(65, '['), "deep.json"); }, {"deep.json", "64 levels"});
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  expect_error([&] { JsonText(objects, "deep.json"); }, {"deep.json", "64 levels"});
}

TEST(JsonText, AFieldThatComesTwice) {
  expect_error([] { JsonText(R"({"a": 1, "b": {"a": 2}, "a": 3})", "x.json"); }, {"x.json", "'a' twice"});
  const JsonText last(R"({"a": [1, 2], "a": {"b": 3}, "c": [4, {}]})", "x", JsonText::Repeated::last_counts);
  EXPECT_EQ(last.root(), json::parse(R"({"a": {"b": 3}, "c": [4, {}]})"));
}

TEST(JsonText, WhatIsNoneIsOneLineWithItsPlace) {
  for (const char* text : {"", "[1, 2", "{\"a\" 1}", "[1] 2", "{a: 1}", "[01]", "[\"\x80\"]", "nul", "[1e999]"})
    expect_error([&] { JsonText(text, "x.json"); }, {"x.json", "is not valid JSON"});
  expect_error([] { JsonText("[1,\n 2,\n x]", "x.json"); }, {"line 3"});
}

}  // namespace
}  // namespace kairos
