// Lobes so sharp that the pixel's own ray is all that shows them: its neighbours' show other things, and a light sample
// seldom falls into them.
// twin: src/core/render/reflection_pool.h, with the numbers' reasons.
const float kMinPooledAlpha = 0.005;
const float kMirrorPart = 0.9;
