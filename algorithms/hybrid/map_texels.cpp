#include "algorithms/hybrid/map_texels.hpp"

#include <algorithm>
#include <cmath>

#include "shaders/shared/cube.h"

namespace gnomon {

namespace {

/// What mapClipOf() and tapOf() of shaders/shared/agreement.glsl give.
struct Found {
    glm::vec4 clip;
    glm::vec2 normalPerTexel;
    std::uint32_t layer = 0;
};

Found findInCube(const gpu::MapLookup& look, glm::vec3 fromLight, glm::vec3 normalWs)
{
    const std::uint32_t face = gpu::cubeFaceOf(fromLight);
    const glm::vec3 local = gpu::inCubeFace(face, fromLight), normal = gpu::inCubeFace(face, normalWs);
    const glm::vec2 texels = (glm::vec2(local) / look.slope + local.z) * (0.5f * look.side);
    return {glm::vec4(texels, look.depthConstant * local.z + look.depthScale, local.z),
            glm::vec2(normal) * (2.0f * look.slope / look.side), face};
}

Found findInPlane(const gpu::MapLookup& look, const Receiver& receiver)
{
    return {look.clipOfEye + receiver.w * (look.clipFromRay * glm::vec4(receiver.viewRay, 0.0f)),
            glm::vec2(glm::dot(receiver.normal, glm::vec3(look.texelDx)),
                      glm::dot(receiver.normal, glm::vec3(look.texelDy)))};
}

} // namespace

MapTexels::MapTexels(const HostMap& map, const gpu::MapConstants& constants, bool cube, const Receiver& receiver)
    : map_(&map)
{
    const gpu::MapLookup& look = constants.map;
    const float w = receiver.w;
    const glm::vec3 fromLight = glm::vec3(look.eyeFromLight) + w * receiver.viewRay;
    const float offset = look.offset.x + w * (look.offset.y + w * look.offset.z);
    const float facing = glm::dot(receiver.normal, fromLight * look.positional + glm::vec3(look.axisWs));
    const Found found = cube ? findInCube(look, fromLight, receiver.normal) : findInPlane(look, receiver);
    const float inverseW = 1.0f / found.clip.w;
    plane_ = gpu::planarDepth(look, gpu::mapDepth(look, found.clip), inverseW, facing, offset, found.normalPerTexel);
    slack_ = gpu::DEPTH_ROUNDING + gpu::SNAP_TEXELS * (std::abs(plane_.perTexel.x) + std::abs(plane_.perTexel.y));
    plane_.at -= slack_;
    layer_ = found.layer;
    at_ = glm::vec2(found.clip) * inverseW;
    // Far outside is as good as outside, and is an integer.
    const glm::vec2 near = glm::clamp(at_, -4.0f, look.side + 4.0f), floored = glm::floor(near);
    own_ = glm::ivec2(floored);
    quadrant_ = {near.x - floored.x < 0.5f ? -1 : 1, near.y - floored.y < 0.5f ? -1 : 1};
}

bool MapTexels::lit(glm::ivec2 texel, float least, float room) const
{
    if (!holds(texel)) return true;
    const glm::vec2 centre = glm::vec2(texel) + 0.5f;
    const float receiver = plane_.at + glm::dot(plane_.perTexel, centre - at_);
    return std::clamp(receiver + room, least, 1.0f) <= map_->depth[layer_][place(texel)];
}

// A texel of depth 0 holds a caster at or before the near end, where a receiver may be on either side of it: it is
// neither lit for anybody nor dark for those there (verdict.glsl).

bool MapTexels::agree(bool expected, TexelBlock block) const
{
    for (int i = 0; i < sizeOf(block); ++i)
        if (lit(own_ + stepOf(i), expected ? gpu::DEPTH_ROUNDING : 0.0f) != expected) return false;
    return true;
}

bool MapTexels::clearlyLit() const
{
    for (int i = 0; i < sizeOf(TexelBlock::four); ++i)
        if (!lit(own_ + stepOf(i), gpu::DEPTH_ROUNDING, 2.0f * slack_)) return false;
    return true;
}

void MapTexels::prefetch(bool depths) const
{
    for (int dy = -1; dy <= 1; ++dy) {
        const glm::ivec2 texel = own_ + glm::ivec2(0, dy);
        if (!holds(texel)) continue;
        prefetchRead(map_->triangle[layer_].data() + place(texel));
        if (depths) prefetchRead(map_->depth[layer_].data() + place(texel));
    }
}

bool MapTexels::foreign() const
{
    return holds(own_) && triangle(own_) == kNone && map_->depth[layer_][place(own_)] < 1.0f;
}

} // namespace gnomon
