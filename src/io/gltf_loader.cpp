#include "io/gltf_loader.h"
