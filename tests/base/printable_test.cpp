// What of a file's text reaches a terminal.
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include <kairos/error.h>
#include <kairos/printable.h>

#include "seed.h"

namespace kairos {
namespace {

using namespace std::string_literals;

TEST(Printable, LettersOfAllLanguagesStay) {
  for (const std::string& text : {"plain text, 'quoted'"s, "Größe"s, "日本語"s, "\U0001F600"s, ""s})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, WhatATerminalObeysDoesNot) {
  EXPECT_EQ(printable("a\x1b[31mb"), "a?[31mb");
  EXPECT_EQ(printable("a\r\nb\tc\0d\x7f"s), "a??b?c?d?");
  EXPECT_EQ(printable("\xc2\x9b"
                      "31m"),
            "?31m")
      << "the control U+009B, as UTF-8";
  EXPECT_EQ(printable("\x9b"
                      "31m"),
            "?31m")
      << "and as a byte";
  EXPECT_EQ(printable("abc\u202ecba\u2028"), "abc?cba?") << "turns the direction of writing; ends the line";
  EXPECT_EQ(printable("\xc0\x9b\xe0\x82\x9b\xed\xa0\x80\xf4\x90\x80\x80\xff"), std::string(13, '?'))
      << "forms that are none: too long, halves, beyond the last";
}

TEST(Printable, IsCutBetweenCharacters) {
  EXPECT_EQ(printable("abcdef", 4), "abcd...");
  EXPECT_EQ(printable("abcdef", 6), "abcdef");
  EXPECT_EQ(printable("aéé", 2), "a...");
}

TEST(Printable, AnyBytesBecomeOneLineAndStaySo) {
  std::mt19937 random(test::seed());
  for (int round = 0; round < 1000; ++round) {
    std::string text(random() % 40, '\0');
    for (char& c : text) c = static_cast<char>(random());
    const std::string shown = printable(text);
    EXPECT_EQ(printable(shown), shown);
    EXPECT_LE(shown.size(), text.size());
    for (const char c : shown) EXPECT_FALSE(static_cast<unsigned char>(c) < ' ' || c == 0x7f);
  }
}

TEST(Printable, ErrorsAreOneLineWhateverTheyQuote) {
  EXPECT_STREQ(Error(ErrorCode::bad_input, "a\nb", "q\0x\x1b[2J"s).what(), "a?b: q?x?[2J");
}

}  // namespace
}  // namespace kairos
