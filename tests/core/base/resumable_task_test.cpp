#include "core/base/resumable_task.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace phat {
namespace {

ResumableTask countTo(int end, int& count) {
    for (count = 1; count < end; ++count) co_yield uint64_t(count);
}

ResumableTask failing() {
    co_yield 1;
    throw std::runtime_error("as meant");
}

TEST(ResumableTask, StopsAfterEverySlice) {
    int count = 0;
    ResumableTask task = countTo(3, count);
    EXPECT_EQ(count, 0);
    EXPECT_TRUE(task.next());
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(task.next());
    EXPECT_EQ(task.work(), 2u);
    EXPECT_FALSE(task.next());
    EXPECT_EQ(count, 3);
}

TEST(ResumableTask, PastItsEndNothingIsRun) {
    int count = 0;
    ResumableTask task = countTo(1, count);
    EXPECT_FALSE(task.next());
    EXPECT_FALSE(task.next());
    ResumableTask failed = failing();
    EXPECT_TRUE(failed.next());
    EXPECT_THROW(failed.next(), std::runtime_error);
    EXPECT_FALSE(failed.next());
}

}  // namespace
}  // namespace phat
