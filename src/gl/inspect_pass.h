#pragma once
// The stored data as pictures: inspect.frag.

#include "gl/phatexture_upload.h"
#include "gl/relight_pass.h"
#include "gl/renderer.h"
#include "gl/shader_loader.h"

namespace phat {

/// Points `program` (inspect.frag) at the data that `inspection` asks for; the caller draws its opaque
/// surfaces.
void bindInspection(const ShaderProgram& program, const GpuAtlas& atlas, const RelightPass& relit,
                    const Inspection& inspection);

}  // namespace phat
