// How samples of area lights are weighted, by the fraction of the solid angle that area lights fill (tileLight's a).

// Below: small lights, the expected weight. Above: a surrounding, the samples' own weight. A light seldom fills a
// tenth of the hemisphere; furnace-glossy.glb is smoother with .1 to .4 than with .25 to .75, and .05 to .2 gains
// nothing more. The smooth step keeps neighbouring tiles alike.
const float kMinLitFraction = 0.1;
const float kMaxLitFraction = 0.4;
// From this weight on, samples are counted by expectation instead of by what was found.
const float kCountsExpected = 0.5;
