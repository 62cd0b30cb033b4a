#pragma once
// Which faces look towards a light: what every silhouette starts from. One arithmetic in several widths, of which the
// widest that the processor has is taken; all give the same answers, bit by bit, whatever the planes hold.
//
//     sum = ((x * light.x + y * light.y) + z * light.z) + w * light.w      facing if sum > 0
#include <cstdint>
#include <span>

#include <glm/vec4.hpp>

#include "runtime/scene/topology.hpp"

namespace gnomon {

/// scalar: face by face, compiled without vectorisation: what the others are held against, and what serves on
/// processors that have none of them.
enum class FacingWidth : std::uint8_t { scalar, sse2, avx2 };
inline constexpr FacingWidth kFacingWidths[] = {FacingWidth::scalar, FacingWidth::sse2, FacingWidth::avx2};

const char* nameOf(FacingWidth width) noexcept;
/// Whether this build has it and this processor runs it.
bool runsHere(FacingWidth width) noexcept;
FacingWidth widestFacing() noexcept;

/// facing[i] = 1 if face first + i looks towards the light, else 0. @param light lightInObjectSpace().at
void findFacing(FacingWidth width, const FacePlanes& planes, const glm::vec4& light, std::uint32_t first,
                std::span<std::uint8_t> facing);

} // namespace gnomon
