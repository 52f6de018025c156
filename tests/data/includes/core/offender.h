// Offends on purpose: core must not know io.
#include "io/image_file.h"
