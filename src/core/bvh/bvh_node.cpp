#include "core/bvh/bvh_node.h"

#include <bit>
#include <cassert>
#include <cmath>

namespace phat {
namespace {

constexpr int kExponentBias = 127;
/// Units are no smaller than a float that is not denormal, since GPUs may take those for 0.
constexpr int kMinExponent = -100;

// The least power of two of which 255 reach from `low` to `high`.
int exponentFor(float low, float high) {
    const double extent = double(high) - double(low);
    int exponent = kMinExponent;
    if (extent > 0) exponent = std::max(exponent, std::ilogb(extent / 255.0));
    while (255.0 * std::ldexp(1.0, exponent) < extent) ++exponent;
    return exponent;
}

uint32_t byteOf(double units) {
    return uint32_t(std::clamp(units, 0.0, 255.0));
}

}  // namespace

BvhNode packNode(const NodeChildren& children) {
    assert(children.firstInner < 1u << kBvhIndexBits);
    BvhNode node = emptyNode();
    Bounds bounds;
    for (int child = 0; child < children.count; ++child) {
        bounds.add(children.boxes[size_t(child)].low);
        bounds.add(children.boxes[size_t(child)].high);
    }
    if (children.count == 0) bounds.add(glm::vec3(0));
    node.words[3] = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int exponent = exponentFor(bounds.low[axis], bounds.high[axis]);
        const double unit = std::ldexp(1.0, exponent), origin = bounds.low[axis];
        node.words[size_t(axis)] = std::bit_cast<uint32_t>(bounds.low[axis]);
        node.words[3] |= uint32_t(exponent + kExponentBias) << (8 * axis);
        for (int child = 0; child < children.count; ++child) {
            const Bounds& box = children.boxes[size_t(child)];
            const uint32_t low = byteOf(std::floor((box.low[axis] - origin) / unit));
            const uint32_t high = byteOf(std::ceil((box.high[axis] - origin) / unit));
            const uint32_t others = ~(255u << (8 * child));
            uint32_t &lows = node.words[size_t(4 + axis)], &highs = node.words[size_t(7 + axis)];
            lows = (lows & others) | low << (8 * child);
            highs = (highs & others) | high << (8 * child);
        }
    }
    node.words[10] = children.firstInner << 8;
    for (int child = 0; child < children.count; ++child) {
        const uint32_t triangles = children.leafTriangles[size_t(child)];
        assert(triangles <= kMaxLeafTriangles);
        if (triangles == 0)
            node.words[3] += 1u << 24;
        else
            node.words[10] |= (triangles - 1) << (2 * child);
    }
    node.words[11] = children.firstTriangle;
    return node;
}

NodeChildren unpackNode(const BvhNode& node) {
    NodeChildren children;
    const int innerCount = int(node.words[3] >> 24);
    for (int child = 0; child < kBvhWidth; ++child) {
        Bounds& box = children.boxes[size_t(child)];
        bool isThere = true;
        for (int axis = 0; axis < 3; ++axis) {
            const float origin = std::bit_cast<float>(node.words[size_t(axis)]);
            const int exponent = int(node.words[3] >> (8 * axis) & 255) - kExponentBias;
            const uint32_t low = node.words[size_t(4 + axis)] >> (8 * child) & 255;
            const uint32_t high = node.words[size_t(7 + axis)] >> (8 * child) & 255;
            isThere &= low <= high;
            box.low[axis] = origin + std::ldexp(float(low), exponent);
            box.high[axis] = origin + std::ldexp(float(high), exponent);
        }
        if (!isThere) continue;
        if (child >= innerCount)
            children.leafTriangles[size_t(child)] = 1 + (node.words[10] >> (2 * child) & 3);
        children.count = child + 1;
    }
    children.firstInner = node.words[10] >> 8;
    children.firstTriangle = node.words[11];
    return children;
}

BvhNode emptyNode() {
    BvhNode node;
    node.words[3] = uint32_t(kExponentBias) * 0x010101u;
    for (size_t axis = 0; axis < 3; ++axis) node.words[4 + axis] = ~0u;
    return node;
}

BvhInstance BvhInstance::of(const BvhNode& node) {
    return {node.words[0], node.words[2], node.words[1] != 0};
}

BvhNode packInstance(const BvhInstance& instance) {
    BvhNode node;
    node.words[0] = instance.root;
    node.words[1] = instance.mirrored ? 1 : 0;
    node.words[2] = instance.matrixNode;
    node.words[3] = kInstance << 24;
    return node;
}

BvhNode packMatrix(const glm::mat4& m) {
    BvhNode node;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            node.words[size_t(4 * row + column)] = std::bit_cast<uint32_t>(m[column][row]);
    return node;
}

}  // namespace phat
