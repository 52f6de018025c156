// Reads that a pixel's indirect light costs are counted by the variants with COUNT_READS.
#ifdef COUNT_READS
int readCount = 0;
#define READ(value) (++readCount, value)
#else
#define READ(value) value
#endif
