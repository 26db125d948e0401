// Files of events: what is written is read again, and what is none gets one line.
#include <array>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include <kairos/event_file.h>
#include <kairos/event_page.h>

#include "error_matchers.h"
#include "seed.h"
#include "temp_folder.h"

namespace kairos {
namespace {

class Collector : public EventSink {
 public:
  void add(std::span<const Event> more) override { events.insert(events.end(), more.begin(), more.end()); }
  std::vector<Event> events;
};

constexpr int kWidth = 346, kHeight = 260;

/// Bursts with silence in between, longer than the counters of EVT3.
std::vector<Event> some_events(std::mt19937& random, size_t count) {
  std::vector<Event> events;
  int64_t time = 0;
  for (size_t i = 0; i < count; ++i) {
    time += static_cast<int64_t>(random() % 5 == 0 ? random() % 40000000 : random() % 3000);
    if (i == count / 2) time += 30000000000;
    events.push_back({time, static_cast<uint16_t>(random() % kWidth), static_cast<uint16_t>(random() % kHeight),
                      static_cast<int8_t>(random() % 2 == 0 ? 1 : -1), EventKind::signal});
  }
  std::sort(events.begin(), events.end());
  return events;
}

void write(const std::string& path, const std::vector<Event>& events, const EventFileOptions& options = {}) {
  EventFileWriter writer(path, kWidth, kHeight, options);
  const size_t half = events.size() / 3;
  writer.add(std::span(events).first(half));
  writer.add(std::span(events).subspan(half));
  writer.finish();
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(EventFiles, OfAllKindsHoldWhatWasWrittenToTheMicrosecond) {
  const TempFolder folder;
  std::mt19937 random(test::seed());
  const auto events = some_events(random, 20000);
  struct Case {
    std::string name;
    EventFileOptions options;
    bool exact = false, has_size = true;
  };
  const auto with = [](auto change) {
    EventFileOptions options;
    change(options);
    return options;
  };
  const std::vector<Case> cases{
      {"a.npz", {}},
      {"b.npz", with([](auto& o) { o.time = EventFileOptions::Time::nanoseconds; }), true},
      {"a.npy", {}, false, false},
      {"a.txt", {}, true, false},
      {"b.txt", with([](auto& o) {
         o.time = EventFileOptions::Time::microseconds;
         o.polarity = EventFileOptions::Polarity::signs;
         o.header = EventFileOptions::Header::e2vid;
       })},
      {"c.txt", with([](auto& o) { o.header = EventFileOptions::Header::v2e; }), true, false},
      {"d.txt", with([](auto& o) { o.time = EventFileOptions::Time::nanoseconds; }), true, false},
      {"a.raw", {}},
      {"b.raw", with([](auto& o) { o.evt = 2; })},
      {"a.h5", with([](auto& o) { o.duration = 40000000000; }), false, false},
      {"a.aedat4", {}},
      {"a.dat", {}},
  };
  for (const Case& one : cases) {
    const std::string path = folder.path(one.name);
    write(path, events, one.options);
    Collector collector;
    const EventFileFacts facts = read_events(path, collector);
    EXPECT_EQ(facts.width, one.has_size ? kWidth : 0) << one.name;
    EXPECT_EQ(facts.height, one.has_size ? kHeight : 0) << one.name;
    ASSERT_EQ(collector.events.size(), events.size()) << one.name;
    for (size_t i = 0; i < events.size(); ++i) {
      Event expected = events[i];
      if (!one.exact) expected.time = expected.time / 1000 * 1000;
      ASSERT_EQ(collector.events[i], expected) << one.name << " event " << i;
    }
  }
}

TEST(EventFiles, SayWhatIsNoise) {
  const TempFolder folder;
  std::vector<Event> events{
      {1000, 1, 2, 1, EventKind::signal}, {2000, 3, 4, -1, EventKind::shot}, {3000, 1, 2, 1, EventKind::leak}};
  EventFileOptions options;
  options.kinds = true;
  write(folder.path("a.npz"), events, options);
  Collector collector;
  read_events(folder.path("a.npz"), collector);
  EXPECT_EQ(collector.events, events);
}

TEST(EventFiles, HoldLabelsBesideEvents) {
  const TempFolder folder;
  const std::vector<Event> events{{1000, 1, 2, 1, EventKind::signal}, {2000, 3, 4, -1, EventKind::signal}};
  const std::vector<EventLabel> labels{{2, 1, 0.5f, {1, -2}, true}, {7, 7, 3, {0, 4}, false}};
  EventFileOptions options;
  options.labels = true;
  EventFileWriter writer(folder.path("a.npz"), kWidth, kHeight, options);
  writer.add_labelled(std::span(events).first(1), std::span(labels).first(1));
  writer.add_labelled(std::span(events).subspan(1), std::span(labels).subspan(1));
  writer.finish();
  Collector collector;
  read_events(folder.path("a.npz"), collector);
  EXPECT_EQ(collector.events, events);
  const std::string bytes = bytes_of(folder.path("a.npz"));
  // An array begins behind the member's name, 20 bytes of sizes and a header of 128.
  const auto holds = [&](const std::string& name, auto first, auto second) {
    const std::array<decltype(first), 2> expected{first, second};
    const size_t at = bytes.find(name + ".npy") + name.size() + 4 + 20 + 128;
    ASSERT_LE(at + sizeof(expected), bytes.size()) << name;
    EXPECT_EQ(std::memcmp(&bytes[at], expected.data(), sizeof(expected)), 0) << name;
  };
  holds("surface", 2u, 7u);
  holds("behind", 1u, 7u);
  holds("depth", 0.5f, 3.0f);
  holds("flow_x", 1.0f, 0.0f);
  holds("flow_y", -2.0f, 4.0f);
  holds("edge", true, false);
  expect_error([&] { EventFileWriter(folder.path("a.raw"), kWidth, kHeight, options); }, {"npz"}, ErrorCode::bad_usage);
}

TEST(EventFiles, AreNotThereUntilTheyAreFinished) {
  const TempFolder folder;
  std::mt19937 random(1);
  for (const std::string ending : {"npz", "txt", "raw", "h5", "aedat4"}) {
    { EventFileWriter(folder.path("a." + ending), kWidth, kHeight).add(some_events(random, 100)); }
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path("")));
}

/// Cut off anywhere, or with a byte that is another: an error of one line, or other events, and no more than that.
TEST(EventFiles, ThatAreBrokenDoNoHarm) {
  const TempFolder folder;
  std::mt19937 random(test::seed());
  const auto events = some_events(random, 40);
  // What a library reads (HDF5) is that library's affair.
  for (const std::string ending : {"npz", "npy", "txt", "raw", "aedat4", "dat"}) {
    write(folder.path("a." + ending), events);
    const std::string whole = bytes_of(folder.path("a." + ending));
    for (int i = 0; i < 40; ++i) {
      std::string broken = whole;
      if (i % 2 == 0)
        broken.resize(random() % whole.size());
      else
        for (int k = 0; k < 3; ++k)
          broken[random() % std::min<size_t>(whole.size(), 4000)] = static_cast<char>(random());
      const std::string path = folder.write("broken." + ending, broken);
      Collector collector;
      try {
        read_events(path, collector);
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
  }
}

TEST(EventPage, HoldsItsEventsAndPictures) {
  const std::vector<Event> events{{2000000, 1, 2, 1, EventKind::signal}, {2003999, 258, 3, -1, EventKind::signal}};
  const std::vector<EventPagePicture> pictures{{0.5, {1, 2, 3}}};
  const std::string page = event_page(events, 346, 260, "</script>", pictures);
  // Microseconds after the first, x, and y with the polarity: 0 1 0x8002; 3 258 3.
  EXPECT_NE(page.find("AAAAAAEAAoADAAAAAgEDAA=="), std::string::npos);
  EXPECT_NE(page.find("\"AQID\""), std::string::npos);
  EXPECT_EQ(page.find("\"</script>"), std::string::npos);
  expect_error([&] { event_page({}, 346, 260, "a.npz"); }, {"a.npz", "no events"}, ErrorCode::bad_usage);
}

TEST(EventFiles, WhatCannotBeIsRefused) {
  const TempFolder folder;
  const auto writer = [&](const std::string& name, int width, int height, EventFileOptions options = {}) {
    return [=, &folder] { EventFileWriter(folder.path(name), width, height, options); };
  };
  expect_error(writer("a.mp4", 10, 10), {".npz", ".aedat4"}, ErrorCode::bad_usage);
  expect_error(writer("a.raw", 4096, 10), {"2048"}, ErrorCode::bad_usage);
  expect_error(writer("a.aedat", 300, 200), {"346x260"}, ErrorCode::bad_usage);
  EventFileOptions options;
  options.time = EventFileOptions::Time::nanoseconds;
  expect_error(writer("a.raw", 10, 10, options), {"seconds"}, ErrorCode::bad_usage);
  options.header = EventFileOptions::Header::e2vid;
  expect_error(writer("a.txt", 10, 10, options), {"first line"}, ErrorCode::bad_usage);
  Collector collector;
  expect_error([&] { read_events(folder.write("a.txt", "0.5 1 2 1\n0.6 1 x 1\n"), collector); }, {"a.txt:2", "'x'"});
  expect_error([&] { read_events(folder.write("b.txt", std::string(40, '9') + " 1 2 1\n"), collector); }, {"no time"});
  expect_error([&] { read_events(folder.write("a.npz", "PK"), collector); }, {"archive"});
}

}  // namespace
}  // namespace kairos
