// Files of events: what is written is read again, and what is none gets one line.
#include <array>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include <kairos/event_file.h>
#include <kairos/event_page.h>

#include "base/little_endian.h"
#include "error_matchers.h"
#include "event_io/ecf.h"
#include "seed.h"
#include "temp_folder.h"

namespace kairos {
namespace {

constexpr int kWidth = 346, kHeight = 260;

/// Bursts with silence in between, longer than the counters of EVT3, and rows in which many fire at once.
std::vector<Event> some_events(std::mt19937& random, size_t count) {
  std::vector<Event> events;
  int64_t time = 0;
  for (size_t i = 0; i < count; ++i) {
    time += static_cast<int64_t>(random() % 5 == 0 ? random() % 40000000 : random() % 3000);
    if (i == count / 2) time += 30000000000;
    events.push_back({time, static_cast<uint16_t>(random() % kWidth), static_cast<uint16_t>(random() % kHeight),
                      static_cast<int8_t>(random() % 2 == 0 ? 1 : -1), EventKind::signal});
  }
  for (size_t row = 0; row < count / 100; ++row) {
    const Event one = events[random() % count];
    for (uint16_t x = 0; x < kWidth; ++x)
      if (random() % 3 == 0) events.push_back({one.time, x, one.y, one.polarity, EventKind::signal});
  }
  std::sort(events.begin(), events.end());
  events.erase(
      std::unique(events.begin(), events.end(), [](const Event& a, const Event& b) { return !(a < b) && !(b < a); }),
      events.end());
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
      {"b.raw", with([](auto& o) { o.evt = EventFileOptions::Evt::evt2; })},
      {"c.raw", with([](auto& o) { o.evt = EventFileOptions::Evt::evt21; })},
      {"a.h5", with([](auto& o) { o.duration = 40000000000; }), false, false},
      {"a.hdf5", {}},
      {"a.aedat4", {}},
      {"a.dat", {}},
  };
  for (const Case& one : cases) {
    const std::string path = folder.path(one.name);
    write(path, events, one.options);
    EventList collector;
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

/// Whichever way a camera's software chooses, its own bytes: hand-made chunks of ECF.
TEST(EventFiles, EcfIsReadInAllOfItsForms) {
  const auto chunk = [](std::vector<uint8_t> rest) {
    std::vector<uint8_t> bytes;
    put_little(bytes, uint32_t{6} << 2 | rest[0]);
    put_little(bytes, uint64_t{1000});
    // Three events at 1000 + 2, one after 300 more, two after 1 more.
    for (const int byte : {0x23, 0xfc, 0xf2, 0xf1, 0x01, 0x12}) bytes.push_back(static_cast<uint8_t>(byte));
    bytes.insert(bytes.end(), rest.begin() + 1, rest.end());
    return bytes;
  };
  const std::vector<int64_t> times{1002, 1002, 1002, 1302, 1303, 1303};
  const std::vector<int> xs{10, 11, 13, 1279, 0, 5}, ys{7, 7, 7, 7, 700, 700}, ps{1, 1, 1, 1, 0, 0};
  const auto expect = [&](const std::vector<uint8_t>& bytes, const std::string& name) {
    const auto events = ecf::decode(bytes, "chunk");
    ASSERT_EQ(events.size(), times.size()) << name;
    for (size_t i = 0; i < times.size(); ++i) {
      EXPECT_EQ(events[i].time, times[i]) << name << i;
      EXPECT_EQ(events[i].x, xs[i]) << name << i;
      EXPECT_EQ(events[i].y, ys[i]) << name << i;
      EXPECT_EQ(events[i].polarity, ps[i]) << name << i;
    }
  };
  const auto words = [](std::vector<uint8_t> begin, const std::vector<uint16_t>& more,
                        const std::vector<uint8_t>& end) {
    for (const uint16_t word : more) put_little(begin, word);
    begin.insert(begin.end(), end.begin(), end.end());
    return begin;
  };
  // Rows 4 x 7, 2 x 700; places with masks of five neighbours (11 and 13; none; 5); polarities 4 x 1, 2 x 0.
  expect(chunk(words({0}, {7 << 5 | 4, 700 << 5 | 2, 10 << 5 | 0b10100, 1279 << 5, 0 << 5 | 0b00001}, {0x84, 0x02})),
         "masks");
  // Rows the same; four events in three words: 12 bits each, x and polarity.
  const auto v = [&](size_t i) { return static_cast<uint16_t>(xs[i] << 1 | ps[i]); };
  const auto three = [](uint16_t a, uint16_t b, uint16_t c, uint16_t d) {
    return std::vector<uint16_t>{static_cast<uint16_t>(a << 4 | (b & 15)),
                                 static_cast<uint16_t>(b >> 4 << 8 | (c & 255)),
                                 static_cast<uint16_t>(c >> 8 << 12 | d)};
  };
  std::vector<uint16_t> packed{7 << 5 | 4, 700 << 5 | 2};
  for (const auto& triple : {three(v(0), v(1), v(2), v(3)), three(v(4), v(5), 0, 0)})
    packed.insert(packed.end(), triple.begin(), triple.end());
  expect(chunk(words({1}, packed, {})), "packed x");
  std::vector<ecf::CdEvent> all;
  for (size_t i = 0; i < times.size(); ++i)
    all.push_back({static_cast<uint16_t>(xs[i]), static_cast<uint16_t>(ys[i]), static_cast<int16_t>(ps[i]), times[i]});
  expect(ecf::encode(all), "our own");
  std::vector<uint8_t> cut = ecf::encode(all);
  while (!cut.empty()) {
    cut.pop_back();
    EXPECT_THROW(ecf::decode(cut, "chunk"), Error) << cut.size();
  }
}

/// EVT3 tells of neighbours in four words where four or more of 32 fire, EVT2.1 of 32 in one.
TEST(EventFiles, RowsThatFireAtOnceAreShort) {
  const TempFolder folder;
  std::vector<Event> row;
  for (uint16_t x = 5; x < 5 + 64; ++x) row.push_back({1000, x, 3, 1, EventKind::signal});
  const auto size = [&](EventFileOptions::Evt evt) {
    EventFileOptions options;
    options.evt = evt;
    write(folder.path("a.raw"), row, options);
    const std::string bytes = bytes_of(folder.path("a.raw"));
    return bytes.size() - bytes.find("% end\n") - 6;
  };
  EXPECT_EQ(size(EventFileOptions::Evt::evt3), 2 * (1 + 2 + 2 * 4u)) << "time twice, row, two vectors";
  EXPECT_EQ(size(EventFileOptions::Evt::evt21), 8 * (1 + 3u)) << "time, and places from 0, 32 and 64";
  EXPECT_EQ(size(EventFileOptions::Evt::evt2), 4 * (1 + 64u));
}

TEST(EventFiles, SensorsAreReadFromWhatStandsBesideARecording) {
  const TempFolder folder;
  EventOptions options;
  options.sensor = *event_sensor("v2e-noisy");
  options.sensor.refractory_mode = Refractory::resample;
  options.sensor.bayer = "RGGB";
  options.sensor.random_level = true;
  write_event_notes(folder.path("a.json"), options, {}, "");
  EXPECT_EQ(read_event_sensor(folder.path("a.json")), options.sensor);
  const auto read = [&](const std::string& text) { return read_event_sensor(folder.write("b.json", text)); };
  EventSensor expected;
  expected.on = 0.25;
  expected.refractory_mode = Refractory::drop;
  EXPECT_EQ(read(R"({"on": 0.25, "refractory_mode": "drop"})"), expected);
  expect_error([&] { read(R"({"sensor": {"contrast": 0.25}})"); }, {"b.json", "sensor.contrast", "is no parameter"});
  expect_error([&] { read(R"({"refractory_mode": "wait"})"); }, {"refractory_mode", "'wait'", "resample"});
  expect_error([&] { read("[]"); }, {"is no sensor"});
}

TEST(EventFiles, SayWhatIsNoise) {
  const TempFolder folder;
  std::vector<Event> events{
      {1000, 1, 2, 1, EventKind::signal}, {2000, 3, 4, -1, EventKind::shot}, {3000, 1, 2, 1, EventKind::leak}};
  EventFileOptions options;
  options.kinds = true;
  write(folder.path("a.npz"), events, options);
  EventList collector;
  read_events(folder.path("a.npz"), collector);
  EXPECT_EQ(collector.events, events);
}

TEST(EventFiles, HoldLabelsBesideEvents) {
  const TempFolder folder;
  const std::vector<Event> events{{1000, 1, 2, 1, EventKind::signal}, {2000, 3, 4, -1, EventKind::shot}};
  const std::vector<EventLabel> labels{{2, 1, 0.5f, {1, -2}, true}, {0xffffffffu, 7, 3, {0, 4}, false}};
  EventFileOptions options;
  options.labels = options.kinds = true;
  for (const std::string ending : {".npz", ".npy", ".h5", ".hdf5"}) {
    const std::string path = folder.path("a" + ending);
    EventFileWriter writer(path, kWidth, kHeight, options);
    writer.add_labelled(std::span(events).first(1), std::span(labels).first(1));
    writer.add_labelled(std::span(events).subspan(1), std::span(labels).subspan(1));
    writer.finish();
    EXPECT_TRUE(holds_labels(path));
    EventList read;
    read_events(path, read);
    EXPECT_EQ(read.events, events) << ending;
    EXPECT_EQ(read.labels, labels) << ending;
  }
  const std::string bytes = bytes_of(folder.path("a.npz"));
  // An array begins behind the member's name, 20 bytes of sizes and a header of 128.
  const auto holds = [&](const std::string& name, auto first, auto second) {
    const std::array<decltype(first), 2> expected{first, second};
    const size_t at = bytes.find(name + ".npy") + name.size() + 4 + 20 + 128;
    ASSERT_LE(at + sizeof(expected), bytes.size()) << name;
    EXPECT_EQ(std::memcmp(&bytes[at], expected.data(), sizeof(expected)), 0) << name;
  };
  holds("surface", 2u, 0xffffffffu);
  holds("behind", 1u, 7u);
  holds("depth", 0.5f, 3.0f);
  holds("flow_x", 1.0f, 0.0f);
  holds("flow_y", -2.0f, 4.0f);
  holds("edge", true, false);
  expect_error([&] { EventFileWriter(folder.path("a.raw"), kWidth, kHeight, options); }, {"npz"}, ErrorCode::bad_usage);
  // Labels of other events than those beside which they lie.
  write(folder.path("a.npy"), {events[0]});
  EventList other;
  expect_error([&] { read_events(folder.path("a.npy"), other); }, {"a.labels.npy", "(1)"});
}

TEST(EventFiles, AreNotThereUntilTheyAreFinished) {
  const TempFolder folder;
  std::mt19937 random(1);
  for (const std::string ending : {"npz", "txt", "raw", "h5", "hdf5", "aedat4"}) {
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
      EventList collector;
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
  EventList collector;
  expect_error([&] { read_events(folder.write("a.txt", "0.5 1 2 1\n0.6 1 x 1\n"), collector); }, {"a.txt:2", "'x'"});
  expect_error([&] { read_events(folder.write("b.txt", std::string(40, '9') + " 1 2 1\n"), collector); }, {"no time"});
  expect_error([&] { read_events(folder.write("a.npz", "PK"), collector); }, {"archive"});
}

}  // namespace
}  // namespace kairos
