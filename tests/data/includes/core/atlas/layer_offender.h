// Offends on purpose: the atlas must not know the photons.
#include "core/transport/photon_map.h"
