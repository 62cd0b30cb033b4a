#pragma once
// Rows of `gnomon bench`, of one scene: what a method takes and how wrong it is.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "demo/io/csv.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/measure.hpp"
#include "demo/program/setting_choices.hpp"
#include "demo/program/soft_error.hpp"

namespace gnomon::demo {

struct BenchRow {
    std::string scene, method;
    size_t lights = 0;
    VkExtent2D size{};
    uint32_t map = 0; ///< 0: the method has none.
    uint64_t triangles = 0;
    PairTimes times;
    ErrorCount errors;
    double worstLightPercent = 0.0;
    std::string worstLight;
    bool hasErrors = false;
    SoftError soft; ///< Of the lights with a radius.
    uint64_t rays = 0;
    double memoryMib = 0.0;
    std::vector<double> aliasing; ///< m of every pixel counted that looks up a map with a matrix (aliasing.hpp).
    std::vector<PassTime> passes;
};

/// Of the table of rows.
const std::vector<std::string>& benchColumns();
/// The row's cells in the order of benchColumns(); the table's row is left open.
void addCells(CsvWriter& csv, const BenchRow& row, const Device& device);

/// What a frame takes more with shadows than without.
double incrementMs(const BenchRow& row);
/// In a line or two on standard output.
void printRow(const BenchRow& row);

/// What makes a method finer: texels of a map's side, rows of a table. Null: nothing does.
const GnSettingInfo* sizeSetting(const GnMethodInfo& method);
/// Null: the method can be measured.
const char* reasonAgainst(const GnMethodInfo& method, const Scene& scene, bool recorded);

/// One scene with one number of lights at one size: the truth is made once for all rows.
class SceneBench {
public:
    /// All of it outlives the bench.
    SceneBench(Device& device, const Scene& scene, const BenchOptions& options,
               const std::vector<SettingChoice>& choices);

    /// The frame without shadows.
    BenchRow base() const;
    /// \pre The first light is a spot light that is there in all frames that are measured.
    BenchRow bare(uint32_t map);
    /// \param traits of the method; it serves one of the lights at least. \param map empty: as set, or its default.
    BenchRow method(const std::string& name, GnTraits traits, std::optional<uint32_t> map);

private:
    /// Leaves the frame alone: visibility stays constant 1.
    class NoShadows final : public OtherShadows {
    public:
        void record(VkCommandBuffer, const ViewInputs&) override {}
        VkImageView visibility() const override { return VK_NULL_HANDLE; }
    };

    SessionOptions sessionOptions() const;
    BenchRow rowFor(const Session& session, const std::string& method, uint32_t map) const;
    void addErrors(Session& session, BenchRow& row);
    void addAliasing(Session& session, uint32_t light, const std::vector<uint8_t>& counted, BenchRow& row) const;
    void findAmbiguous();

    Device& device_;
    const Scene& scene_;
    const BenchOptions& options_;
    const std::vector<SettingChoice>& choices_;
    VkExtent2D size_{};
    double truthTime_ = 0.0;
    std::optional<Truth> truth_;
    std::vector<std::vector<uint8_t>> ambiguous_; ///< By layer of the truth.
    bool truthTried_ = false;
    mutable NoShadows nothing_;
};

} // namespace gnomon::demo
