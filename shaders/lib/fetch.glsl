// Reads that a pixel's glossy light costs are counted by the variants with COUNT_READS: [0] for indirect light, [1] for
// area lights.
#ifdef COUNT_READS
int readCount[2] = int[2](0, 0);
int readSource = 0;
#define READ(value) (++readCount[readSource], value)
#define READS_FOR(source) readSource = source
#elif defined(COUNT_ONLY_READS) && defined(COUNT_FETCHES)
#define READ(value) (atomicAdd(fetchCount, 1u), value)
#define READS_FOR(source)
#else
#define READ(value) value
#define READS_FOR(source)
#endif
