// Before all of a program that counts the texels that it reads: a filtered read is one. For desktop OpenGL alone.
// With COUNT_ONLY_READS those in READ() count, and not what is read of materials.

layout(std430, binding = 0) buffer FetchCount { uint fetchCount; };
#ifndef WRITES_DEPTH
layout(early_fragment_tests) in;  // what is written to a buffer would count of hidden pixels, too
#endif
#ifndef COUNT_ONLY_READS
#define texelFetch(map, at, level) (atomicAdd(fetchCount, 1u), texelFetch(map, at, level))
#define textureLod(map, at, level) (atomicAdd(fetchCount, 1u), textureLod(map, at, level))
#define texture(map, at) (atomicAdd(fetchCount, 1u), texture(map, at))
#endif
