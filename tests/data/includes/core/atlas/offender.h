// Offends on purpose: core must not know io.
#include "io/image/image_file.h"
