// Offends on purpose: images must not know glTF.
#include "io/gltf/gltf_loader.h"
