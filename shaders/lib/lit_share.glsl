// Where area lights fill how much of the view (tileLight's a) decides how their samples are weighed.

// Below: lamps, the expected weight. Above: a surrounding, the samples' own weight. A lamp seldom fills a tenth of the
// hemisphere; furnace-glossy.glb is smoother with .1 to .4 than with .25 to .75, and .05 to .2 gains nothing more.
// The smooth step keeps neighbouring tiles alike.
const float kLeastLitShare = 0.1;
const float kMostLitShare = 0.4;
// From this weight on, samples are counted by expectation instead of by what was found.
const float kCountsExpected = 0.5;
