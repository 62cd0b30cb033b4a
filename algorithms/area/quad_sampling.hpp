#pragma once
// Points of a source chosen by a quadtree, for methods that differ in what a pixel keeps of each point and in which
// squares are divided. Maps are drawn level by level, what pixels see of their points is kept in words, and the host
// divides the squares that a compute pass flags.
#include <array>
#include <cstdint>
#include <span>

#include "algorithms/area/area_maps.hpp"
#include "algorithms/area/source_quads.hpp"
#include "shaders/area/quads.h"

namespace gnomon {

/// Settings that these methods share.
inline constexpr SettingSpec kQuadResolutionSetting = {
    "resolution", "Texels per side of every point's map.", 64, 2048, 512, true};
inline constexpr SettingSpec kQuadLeastSetting = {
    "least", "Every square is divided so often: 4, 9, 25, 81 or 289 points at least.", 0, kQuadLevels, 2};
inline constexpr SettingSpec kQuadReasonsSetting = {
    "reasons", "1: the byte in visibility is the share of the 289 points whose maps were drawn.", 0, 1, 0};

/// What a method keeps of points, by its shaders.
struct QuadMethod {
    const char *words, *look, *test, *resolve; ///< Names of the image, and of the passes.
    VkFormat format;                           ///< Of a pixel's word of 32 points.
    std::span<const std::uint32_t> lookCode, testCode, resolveCode;
};

/// How a task is sampled.
struct QuadRule {
    std::uint32_t resolution = 0, least = 0;
    std::array<std::uint32_t, kQuadLevels> window{}; ///< Pixels between those that are looked at, by level.
    std::uint32_t ramps = 5;  ///< Corners on a ramp from which on a pixel shows no step; 5: none are counted.
    std::uint32_t filter = 1; ///< Texels per side of a look-up.
    float inset = 1.0f;       ///< Points lie within so much of the source's half side.
    bool reasons = false;
};

class QuadSampling {
public:
    QuadSampling(const AlgorithmServices& services, const QuadMethod& method);
    void declare(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule) const;

private:
    struct Tree;
    struct Images;
    Images makeImages(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule) const;
    void declareWord(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule, const Images& images,
                     std::uint32_t word, BufferId after, const Tree* tree) const;
    BufferId declareDivision(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule, const Images& images,
                             std::uint32_t level, Tree* tree) const;
    void declareResolve(PassBuilder& passes, const ShadowTask& task, const QuadRule& rule, const Images& images,
                        BufferId after, const Tree* tree) const;

    QuadMethod method_;
    DepthMapPipelines casters_;
    PointLookups look_;
    PipelineId test_, resolve_;
};

/// AlgorithmEntry::memoryPerLight. @param wordSize bytes of a pixel's word
VkDeviceSize quadMemory(std::uint32_t resolution, VkExtent2D extent, std::uint32_t wordSize);

} // namespace gnomon
