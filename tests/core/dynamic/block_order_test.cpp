// The order in which blocks get new light.

#include "core/dynamic/block_order.h"

#include <gtest/gtest.h>

#include <map>

#include "support/scene_builder.h"

namespace phat::test {
namespace {

struct Room {
    Room() {
        addRoom(scene, lambert(0.5f), {4, 4, 4});
        AtlasSettings settings;
        settings.texelBudget = 40'000;
        SilentProgress progress;
        atlas = buildAtlas(scene, {}, settings, progress);
        points = buildTexelPoints(scene, atlas);
    }
    Scene scene;
    Atlas atlas;
    TexelPoints points;
};

// Stands in the middle and looks along -z.
Camera middle() {
    Camera camera;
    camera.worldFromCamera[3] = {2, 2, 2, 1};
    camera.yfovRadians = 0.8f;
    camera.aspect = 1;
    return camera;
}

/// All checks among `turns` find so much.
void note(BlockOrder& order, const std::vector<BlockTurn>& turns, float change) {
    for (const BlockTurn& turn : turns)
        if (turn.work == BlockWork::check) order.noteCheck(turn.block, change);
}

TEST(BlockOrder, MakesChangedBlocksUntilTheyAreSettled) {
    const Room room;
    BlockOrder order(room.atlas, room.points);
    ASSERT_GT(order.size(), 20u);
    std::map<uint32_t, uint32_t> rounds, phatexels;
    size_t calls = 0;
    while (!order.settled()) {
        const std::vector<BlockTurn> turns = order.next(7, middle());
        ASSERT_FALSE(turns.empty());
        for (const BlockTurn& turn : turns) {
            EXPECT_EQ(turn.rounds, rounds[turn.block]++);
            EXPECT_EQ(turn.work == BlockWork::check, turn.rounds == 0);
            phatexels[turn.block] += turn.work == BlockWork::all;
        }
        note(order, turns, 0.5f);
        ASSERT_LT(++calls, 100'000u);
    }
    EXPECT_EQ(rounds.size(), order.size());
    for (const auto& [block, count] : rounds) EXPECT_EQ(count, BlockOrder::kSettledRounds);
    // After 2, 8 and 32 rounds, and in the last.
    for (const auto& [block, count] : phatexels) EXPECT_EQ(count, 4u);
    EXPECT_TRUE(order.next(7, middle()).empty());
    order.noteChange();
    EXPECT_FALSE(order.settled());
    EXPECT_EQ(order.next(1, middle()).front().rounds, 0u);
}

TEST(BlockOrder, BlocksThatAgreeRestButForChecks) {
    const Room room;
    BlockOrder order(room.atlas, room.points);
    std::map<uint32_t, uint32_t> turnsOf;
    while (!order.settled()) {
        const std::vector<BlockTurn> turns = order.next(7, middle());
        for (const BlockTurn& turn : turns) {
            ++turnsOf[turn.block];
            EXPECT_TRUE(turn.work == BlockWork::check || turn.block == 3);
            if (turn.work == BlockWork::check) order.noteCheck(turn.block, turn.block == 3 ? 0.1f : 0.002f);
        }
    }
    for (const auto& [block, count] : turnsOf)
        EXPECT_EQ(count, block == 3 ? BlockOrder::kSettledRounds : BlockOrder::kChecks);
}

// Small changes add up; and the more has changed, the less of what was there counts.
TEST(BlockOrder, ChangesAddUp) {
    const Room room;
    BlockOrder order(room.atlas, room.points);
    uint32_t made = 0, kept = 0;
    while (!order.settled()) {
        const std::vector<BlockTurn> turns = order.next(order.size(), middle());
        for (const BlockTurn& turn : turns) {
            made += turn.work != BlockWork::check;
            if (turn.work == BlockWork::check) order.noteCheck(turn.block, turn.block == 0 ? 0.2f : 0.004f);
            if (turn.block == 0 && turn.work != BlockWork::check) {
                EXPECT_LT(turn.kept, 4u);
            }
            if (turn.block == 1 && turn.work != BlockWork::check) kept = turn.kept;
        }
    }
    EXPECT_EQ(made, order.size() * (BlockOrder::kSettledRounds - 1));
    EXPECT_GT(kept, 50u);
}

// A small change, and a large one before the light has followed: what was there before either does not count.
TEST(BlockOrder, ALaterChangeIsFoundAsLargeAsItIs) {
    const Room room;
    BlockOrder order(room.atlas, room.points);
    note(order, order.next(order.size(), middle()), 0.02f);
    for (int round = 0; round < 3; ++round)
        for (const BlockTurn& turn : order.next(order.size(), middle())) EXPECT_EQ(turn.kept, 64u);
    order.noteChange();
    std::vector<uint32_t> kept(order.size());
    while (!order.settled()) {
        const std::vector<BlockTurn> turns = order.next(order.size(), middle());
        note(order, turns, 0.5f);
        for (const BlockTurn& turn : turns)
            if (turn.work != BlockWork::check) kept[turn.block] = turn.kept;
    }
    for (const uint32_t samples : kept) EXPECT_EQ(samples, 1u);
}

// Steps of a hundredth, which the light follows between them.
TEST(BlockOrder, WhatTheLightHasFollowedIsNoChangeAnyMore) {
    const Room room;
    BlockOrder order(room.atlas, room.points);
    uint32_t least = 64, lit = 0, checked = 0;
    for (int frame = 0; frame < 400; ++frame) {
        const std::vector<BlockTurn> turns = order.next(order.size(), middle());
        note(order, turns, 0.015f);
        for (const BlockTurn& turn : turns) {
            (turn.work == BlockWork::check ? checked : lit) += 1;
            if (turn.work != BlockWork::check) least = std::min(least, turn.kept);
        }
        order.noteChange();
    }
    // Where a step c leaves the share k / (k + 1) of what was off, it is off by c (k + 1) in the long run,
    // which is as much as k samples are for k = (0.3 / (0.015 (k + 1)))^2: 6.7.
    EXPECT_GE(least, 6u);
    EXPECT_LE(least, 7u);
    EXPECT_NEAR(double(checked) / double(lit), 1, 0.02);
}

// Something that moves in every frame leaves no block without its turn.
TEST(BlockOrder, NoBlockWaitsForTheEndOfAMotion) {
    const Room room;
    BlockOrder order(room.atlas, room.points);
    std::map<uint32_t, uint32_t> turnsOf, lit;
    for (size_t frame = 0; frame < 8 * order.size(); ++frame) {
        order.noteChange();
        const std::vector<BlockTurn> turns = order.next(5, middle());
        for (const BlockTurn& turn : turns) {
            ++turnsOf[turn.block];
            lit[turn.block] += turn.work != BlockWork::check;
        }
        note(order, turns, 0.3f);
    }
    EXPECT_EQ(turnsOf.size(), order.size());
    for (const auto& [block, count] : lit) EXPECT_GT(count, 4u) << block;
}

TEST(BlockOrder, WhatIsSeenHasFourTimesAsManyRounds) {
    const Room room;
    BlockOrder order(room.atlas, room.points);
    std::map<uint32_t, uint32_t> rounds;
    for (size_t made = 0; made < 40 * order.size();) {
        const std::vector<BlockTurn> turns = order.next(5, middle());
        made += turns.size();
        note(order, turns, 0.5f);
        for (const BlockTurn turn : turns) ++rounds[turn.block];
    }
    uint32_t most = 0, least = ~0u;
    for (const auto& [block, count] : rounds) {
        most = std::max(most, count);
        least = std::min(least, count);
    }
    EXPECT_NEAR(double(most) / double(least), 4, 0.4);
    EXPECT_EQ(rounds.size(), order.size());
    // The wall in front is seen, that behind is not.
    const std::vector<BlockRect> rects = blockRects(room.atlas);
    for (const auto& [block, count] : rounds) {
        const glm::uvec2 middleTexel = rects[block].origin + rects[block].size / 2u;
        const size_t texel = size_t(middleTexel.y) * room.atlas.sizeTexels.x + middleTexel.x;
        if (!room.points.valid(texel)) continue;
        const glm::vec3 at = room.points.position[texel];
        if (at.z < 0.1f && std::abs(at.x - 2) < 0.5f && std::abs(at.y - 2) < 0.5f) {
            EXPECT_GT(count, 2 * least);
        }
        if (at.z > 3.9f) {
            EXPECT_LT(2 * count, most);
        }
    }
}

}  // namespace
}  // namespace phat::test
