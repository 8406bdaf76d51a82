#include "core/base/status.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "core/base/time.h"

namespace surefoot {
namespace {

TEST(Status, EveryCodeHasItsOwnText) {
  std::set<std::string> texts;
  for (int code = 0; code <= static_cast<int>(Status::kEndOfData); ++code) {
    texts.insert(to_string(static_cast<Status>(code)));
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(Status::kEndOfData) + 1);
  EXPECT_FALSE(texts.contains("unknown status"));
  EXPECT_STREQ(to_string(static_cast<Status>(200)), "unknown status");
}

TEST(Result, CarriesAValueOrAReason) {
  const Result<int> value = 3;
  EXPECT_TRUE(value.ok());
  EXPECT_EQ(value.status(), Status::kOk);
  EXPECT_EQ(value.value(), 3);
  const Result<int> nothing = Status::kTimeout;
  EXPECT_FALSE(nothing.ok());
  EXPECT_EQ(nothing.status(), Status::kTimeout);
}

TEST(ResultDeathTest, AValueThatIsNotThereIsAProgrammersError) {
  const Result<int> nothing = Status::kTimeout;
  EXPECT_DEATH(static_cast<void>(nothing.value()), "ok()");
  EXPECT_DEATH(static_cast<void>(Result<int>(Status::kOk)), "status != Status::kOk");
}

TEST(TimeNs, CountsWithoutRounding) {
  static_assert(milliseconds(3) + microseconds(5) == TimeNs{3'005'000});
  static_assert(milliseconds(2) - milliseconds(5) < TimeNs{0});
  static_assert(microseconds(250) * 4 == milliseconds(1));
  EXPECT_DOUBLE_EQ(milliseconds(1500).seconds(), 1.5);
}

}  // namespace
}  // namespace surefoot
