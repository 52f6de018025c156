// One of the targets as a program of libFuzzer: PHAT_FUZZ_TARGET, PHAT_FUZZ_MUTATOR.

#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    phat::fuzz::PHAT_FUZZ_TARGET({data, size});
    return 0;
}

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t maxSize);

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t maxSize, unsigned seed) {
    return phat::fuzz::PHAT_FUZZ_MUTATOR(data, size, maxSize, seed);
}

size_t phat::fuzz::mutateBytes(uint8_t* data, size_t size, size_t maxSize, unsigned) {
    return LLVMFuzzerMutate(data, size, maxSize);
}
