// Two lists of events, matched in their order within a window of time.
#include <cmath>

#include <gtest/gtest.h>

#include <kairos/event_compare.h>
#include <kairos/events.h>

namespace kairos {
namespace {

TEST(Events, AreComparedInTheirOrderWithinAWindow) {
  const auto at = [](int64_t microseconds, uint16_t x, int8_t polarity = 1) {
    return Event{microseconds * 1000, x, 0, polarity, EventKind::signal};
  };
  const std::vector<Event> reference{at(100, 1), at(200, 1), at(250, 2, -1), at(300, 1), at(50000, 2)};
  const std::vector<Event> other{at(103, 1), at(207, 1), at(250, 2), at(305, 1), at(50001, 2), at(90000, 1)};
  const EventDifference difference = compare_events(reference, other, 20000);
  EXPECT_EQ(difference.matched, 4u);
  EXPECT_EQ(difference.missing, 1u);  // the one that became darker
  EXPECT_EQ(difference.extra, 2u);
  EXPECT_EQ(difference.median, 3000);  // of 1, 3, 5 and 7 microseconds
  EXPECT_EQ(difference.most, 7000);
  EXPECT_NEAR(difference.rms, std::sqrt(21.0) * 1000, 1e-6);
  // Of 89.9 ms, in pixel 1 one event for 3, 7 and 5 us; in pixel 2 two from 250 us on, but one for 1 us at 50 ms.
  const double span = 89900, second = 2 * (50000 - 250) + 1 + 2 * (90000 - 50001);
  EXPECT_NEAR(difference.brightness_mean, (15 + second) / span / 2, 1e-9);
  const double squares = 4 * (50000 - 250) + 1 + 4 * (90000 - 50001);
  EXPECT_NEAR(difference.brightness_rms, std::sqrt((15 + squares) / span / 2), 1e-9);
  EXPECT_EQ(pillar_share(other), 1);  // all of them, of so few
}

}  // namespace
}  // namespace kairos
